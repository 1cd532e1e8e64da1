// A simulated clock that steps: two trackers and their fusion keep the true target and its id where the step
// is less than what may be late or hidden, and find it again under a new id where time starts again. Each
// line "chaos: ..." tells how long that took (bench/chaos).
#include <set>

#include <rosgraph_msgs/Clock.h>

#include "support/chaos.h"

namespace {

class ChaosOfClocks : public Chaos {
 protected:
  static constexpr double kTick = 0.005;  // of the simulated clock [s]

  void play() override {
    const ros::WallTime wall = ros::WallTime::now();
    if ((wall - ticked_).toSec() >= kTick) {
      ticked_ = wall;
      rosgraph_msgs::Clock message;
      message.clock = time_ = ros::Time((wall - start_).toSec() + offset_);
      clock_.publish(message);
    }
    Chaos::play();
  }

  ros::Time now() const override { return time_; }

  /// The clock steps by that [s], and goes on.
  void stepAndExpectBack(double step, Id id) {
    begin();
    const ros::WallTime event = ros::WallTime::now();
    const ros::Time before = time_;
    offset_ += step;
    if (step < 0.0 && id == Id::kept) {  // until time is past what it was
      EXPECT_TRUE(until([&] { return time_ > before; }));
    }
    EXPECT_TRUE(until([&] {
      return std::all_of(watches_.begin(), watches_.end(), [&](const auto& watch) {
        return !watch->seen().empty() && std::abs((watch->newest() - time_).toSec()) < 0.5 * std::abs(step);
      });
    })) << "no tracks of the new time; "
        << describe();
    char name[64];
    std::snprintf(name, sizeof name, "simulated clock steps %+.1f s", step);
    expectBack(name, event, id);
    for (std::size_t i = 0; i < watches_.size(); ++i) {
      const std::uint32_t id_now = watches_[i]->seen().back().id;
      if (id_now != ids_[i]) {
        EXPECT_EQ(used_[i].count(id_now), 0U) << name << ": an id is used again";
      }
      for (const auto& seen : watches_[i]->seen()) used_[i].insert(seen.id);
      used_[i].insert(ids_[i]);
    }
    expectNobodyDied();
  }

  ros::Publisher clock_ = nh_.advertise<rosgraph_msgs::Clock>("/clock", 1000);
  ros::WallTime start_ = ros::WallTime::now();
  ros::WallTime ticked_;
  ros::Time time_;
  double offset_ = 1000.0;                               // of the simulated time [s]
  std::map<std::size_t, std::set<std::uint32_t>> used_;  // ids, by form
};

TEST_F(ChaosOfClocks, TheTargetIsKeptOrFoundAgainAfterEachStep) {
  stepAndExpectBack(0.5, Id::kept);
  stepAndExpectBack(-0.3, Id::kept);
  stepAndExpectBack(20.0, Id::any);
  stepAndExpectBack(-20.0, Id::any);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "chaos_clock_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
