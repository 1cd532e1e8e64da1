// Trackers on two machines and the fusion on one of them: the far sensor and its tracker are behind a link
// that is cut, that loses a third of what it carries, or is slow. Its targets are back when the link is, and
// none is there twice.
#include <algorithm>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "support/chaos.h"
#include "support/cut_link.h"
#include "support/launch.h"

namespace {

constexpr double kCutFor = 5.0;        // [s]
constexpr double kImpairedFor = 10.0;  // [s]
constexpr double kNoise = 1e-3;        // of the sightings [rad]
CutLink* link_of_machines = nullptr;   // set by main
std::string tcp = "the kernel's";      // how long TCP waits at most before it sends again: likewise

/// A target that only the far sensor sees: its path.
Eigen::Vector2d farTruthAt(ros::Time stamp) {
  return Chaos::truthAt(stamp) + Eigen::Vector2d(0.6, 0.2);
}

/// The far sensor: thirty scans a second of both targets, until it is ended.
int playFarSensor(int argc, char** argv) {
  ros::init(argc, argv, "east_sensor");
  ros::NodeHandle nh;
  ros::Publisher sightings = nh.advertise<sightline::SightingArray>("/sightings/east", 1000);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0.0, kNoise);
  for (ros::WallRate rate(30.0); ros::ok(); rate.sleep()) {
    const ros::Time now = ros::Time::now();
    std::vector<std::pair<double, double>> seen;
    for (const Eigen::Vector2d& truth : {Chaos::truthAt(now), farTruthAt(now)}) {
      const double azimuth = truth.x() + normal(random), elevation = truth.y() + normal(random);
      seen.emplace_back(azimuth, elevation);
    }
    sightline::SightingArray scan = scanOf("east", 0.0, seen, kNoise);
    scan.header.stamp = now;
    sightings.publish(scan);
    ros::spinOnce();
  }
  return 0;
}

class Distributed : public Chaos {
 protected:
  void SetUp() override {
    Chaos::SetUp();
    ASSERT_TRUE(until([this] { return far_only_.holdsSince(now() - ros::Duration(1.0)); }))
        << "the target of the far sensor is not found; " << far_only_.describe();
  }

  /// The near sensor.
  void play() override {
    const ros::WallTime wall = ros::WallTime::now();
    if ((wall - played_).toSec() < kInterval) return;
    played_ = wall;
    west_.publish(scan("west", now()));
  }

  void beginEvent() {
    begin();
    far_only_.begin();
  }

  /// Share of the fusion's messages since the event began that had the far target.
  double farShare() const {
    const auto& seen = far_only_.seen();
    const auto held =
        std::count_if(seen.begin(), seen.end(), [](const auto& message) { return message.id != 0; });
    return static_cast<double>(held) / static_cast<double>(std::max<std::size_t>(1, seen.size()));
  }

  /// Messages since the event began in which the target has more than one track.
  static int doublesOf(const FusionWatch& watch) {
    const auto& seen = watch.seen();
    return static_cast<int>(
        std::count_if(seen.begin(), seen.end(), [](const auto& message) { return message.tracks > 1; }));
  }

  /// The link is as it should be since `end`: both targets are held again, the near one by both trackers,
  /// with one track each in every message.
  void expectRecovered(const std::string& event, ros::WallTime end) {
    ASSERT_EQ(link_of_machines->whyNot(), "");
    const double share = farShare();
    const ros::Time since = now();
    EXPECT_TRUE(until([&] { return far_only_.holdsSince(since); })) << event << ": " << far_only_.describe();
    expectBack(event, end, Id::kept, Loss::none);
    const FusionWatch::Outcome far = far_only_.outcome(end);
    const int near_doubles = doublesOf(*watches_.front()), far_doubles = doublesOf(far_only_);
    std::printf(
        "distributed: %s, TCP waits at most %s: far target back %.2f s, both trackers %.2f s after the link; "
        "meanwhile the far target in %.0f %% of the messages; doubles in %d and %d of %d\n",
        event.c_str(), tcp.c_str(), far.back, watches_.front()->outcome(end).both, 100.0 * share,
        near_doubles, far_doubles, static_cast<int>(far_only_.seen().size()));
    std::fflush(stdout);
    EXPECT_LT(far.sigmas, kMostSigmas);
    EXPECT_EQ(near_doubles + far_doubles, 0) << event << ": a target had two tracks";
    expectNobodyDied();
  }

  FusionWatch far_only_{nh_, "nodes", farTruthAt};
};

TEST(LinkOfMachines, CanBeMade) {
  if (!link_of_machines->whyNot().empty()) GTEST_SKIP() << link_of_machines->whyNot();
}

TEST_F(Distributed, ACutTakesTheFarTargetAwayUntilTheLinkIsBack) {
  beginEvent();
  const ros::WallTime event = ros::WallTime::now();
  const ros::Time cut = now();
  link_of_machines->cut();
  EXPECT_TRUE(until([&] { return !far_only_.holdsSince(cut) && allHoldSince(cut); }))
      << "the link is not cut";
  playFor(kCutFor - (ros::WallTime::now() - event).toSec());
  EXPECT_FALSE(far_only_.holdsSince(now() - ros::Duration(1.0))) << "the link was not cut all the time";
  link_of_machines->join();
  expectRecovered("cut for 5 s", ros::WallTime::now());
}

TEST_F(Distributed, ALossOfThirtyPercentLosesNoTargetForGood) {
  beginEvent();
  link_of_machines->impair(0.3, 0.0);
  playFor(kImpairedFor);
  link_of_machines->join();
  expectRecovered("30 % lost for 10 s", ros::WallTime::now());
}

TEST_F(Distributed, ADelayOfTwoHundredMillisecondsIsBorne) {
  beginEvent();
  link_of_machines->impair(0.0, 0.2);
  playFor(kImpairedFor);
  EXPECT_TRUE(until([this] { return far_only_.holdsSince(now() - ros::Duration(0.4)); }))
      << far_only_.describe();
  link_of_machines->join();
  expectRecovered("200 ms late for 10 s", ros::WallTime::now());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "far_sensor") return playFarSensor(argc, argv);
  CutLink::enter(argv);
  testing::InitGoogleTest(&argc, argv);
  CutLink link;
  link_of_machines = &link;
  if (!link.whyNot().empty()) {
    testing::GTEST_FLAG(filter) = "LinkOfMachines*";
    return RUN_ALL_TESTS();
  }
  const bool keeps_kernel = std::find(argv, argv + argc, std::string("kernel_tcp:=true")) != argv + argc;
  if (!keeps_kernel && link.set("net/ipv4/tcp_rto_max_ms", 1000)) tcp = "1 s";
  CutLink::useMasterOnNear();
  const Launch on_near("chaos_trackers.launch", {"far:=false", "nodelets:=false"});
  const Launch on_far("chaos_trackers.launch", {"near:=false", "nodelets:=false", "--wait"}, link.onFar());
  std::vector<std::string> sensor = link.onFar();
  sensor.insert(sensor.end(), {std::filesystem::read_symlink("/proc/self/exe"), "far_sensor"});
  const CommandUnderWay far_sensor(sensor);
  ros::init(argc, argv, "distributed_test");
  ros::NodeHandle keep_alive;
  keep_alive.setParam("/chaos/nodelets", false);
  return RUN_ALL_TESTS();
}
