// The link between two machines is cut for some seconds: the tracker of the far one is out of reach, and its
// backlog comes afterwards. The fusion on the near one keeps the true target and its id all the time.
#include "support/chaos.h"
#include "support/cut_link.h"
#include "support/launch.h"

namespace {

constexpr double kCut = 5.0;  // [s]
CutLink* the_link = nullptr;  // set by main

class ChaosOfLinks : public Chaos {
 protected:
  /// Whether the newest message holds the target without the far tracker, and is stamped since then.
  bool farIsGone(ros::Time since) const {
    return std::all_of(watches_.begin(), watches_.end(), [&](const auto& watch) {
      return watch->holdsSince(since) && !watch->seen().back().both;
    });
  }
};

TEST(LinkOfThisTest, CanBeMade) {
  if (!the_link->whyNot().empty()) GTEST_SKIP() << the_link->whyNot();
}

TEST_F(ChaosOfLinks, ACutKeepsTheTargetAndItsId) {
  begin();
  const ros::WallTime event = ros::WallTime::now();
  const ros::Time cut = now();
  the_link->cut();
  EXPECT_TRUE(until([&] { return farIsGone(cut); })) << "the link is not cut; " << describe();
  playFor(kCut - (ros::WallTime::now() - event).toSec());
  EXPECT_TRUE(farIsGone(cut)) << "the link was not cut all the time; " << describe();
  the_link->join();
  ASSERT_EQ(the_link->whyNot(), "");
  expectBack("link cut for 5 s", ros::WallTime::now(), Id::kept, Loss::none);
  expectNobodyDied();
}

}  // namespace

int main(int argc, char** argv) {
  CutLink::enter(argv);
  testing::InitGoogleTest(&argc, argv);
  CutLink link;
  the_link = &link;
  if (!link.whyNot().empty()) {
    testing::GTEST_FLAG(filter) = "LinkOfThisTest*";
    return RUN_ALL_TESTS();
  }
  CutLink::useMasterOnNear();
  std::vector<std::string> near = {"far:=false"};
  std::vector<std::string> far = {"near:=false", "manager:=far_manager", "--wait"};
  const std::vector<std::string> all_forms = {"nodes", "nodelets"};
  const auto isOff = [&](const std::string& form) {
    return std::find(argv, argv + argc, form + ":=false") != argv + argc;
  };
  for (const std::string& form : all_forms) {
    near.push_back(form + (isOff(form) ? ":=false" : ":=true"));
    far.push_back(near.back());
  }
  const Launch on_near("chaos_trackers.launch", near);
  const Launch on_far("chaos_trackers.launch", far, link.onFar());
  ros::init(argc, argv, "chaos_link_test");
  ros::NodeHandle keep_alive;
  for (const std::string& form : all_forms) keep_alive.setParam("/chaos/" + form, !isOff(form));
  return RUN_ALL_TESTS();
}
