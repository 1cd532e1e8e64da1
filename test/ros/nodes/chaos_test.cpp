// Processes that are killed or held up, floods, garbage, clocks that step: two trackers and their fusion keep
// the true target, or find it again, as nodes and as nodelets. Each line "chaos: ..." tells how long that
// took (bench/chaos).
#include <XmlRpc.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <signal.h>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <ros/network.h>
#include <ros/ros.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/sphere.h"

#include "support/scans.h"
#include "support/waiting.h"

namespace {

namespace core = sightline::core;

constexpr double kSigma = 1e-3;  // of the sightings [rad]
constexpr double kNear = 8e-3;   // from the true target, for its track [rad]
constexpr double kFresh = 0.5;   // age of the newest tracks, of a fusion that goes on [s]
constexpr double kInterval = 1.0 / 30.0;
constexpr double kHeldUp = 4.5;  // for which processes are stopped [s]: more than the fusion's patience

Eigen::Vector2d truthAt(double time) {
  return {0.3 + 0.2 * std::sin(0.7 * time), 0.15 * std::cos(0.5 * time)};
}

/// Process of a node; nullopt when nobody answers under its name.
std::optional<pid_t> processOf(const std::string& node) {
  XmlRpc::XmlRpcValue arguments, answer, uri;
  arguments[0] = ros::this_node::getName();
  arguments[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::master::execute("lookupNode", arguments, answer, uri, false)) return std::nullopt;
  if (!ros::network::splitURI(static_cast<std::string&>(uri), host, port)) return std::nullopt;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue name, process;
  name[0] = ros::this_node::getName();
  if (!client.execute("getPid", name, process) || client.isFault() || process.size() != 3)
    return std::nullopt;
  return static_cast<pid_t>(static_cast<int>(process[2]));
}

/// What a fusion says of the target.
class Watch {
 public:
  Watch(ros::NodeHandle& nh, std::string setup)
      : setup_(std::move(setup)),
        subscriber_(nh.subscribe("/" + setup_ + "/fusion/tracks", 1000, &Watch::take, this,
                                 ros::TransportHints().tcpNoDelay())) {}

  /// Whether the newest tracks are of now, and a confirmed one is where the target is.
  bool holds() const {
    return id_ != 0 && (ros::WallTime::now() - came_).toSec() < kFresh &&
           (ros::Time::now() - stamp_).toSec() < kFresh;
  }

  /// Whether it does, and both trackers have a part in it.
  bool holdsByBoth() const { return holds() && sources_ == std::vector<std::string>{"east", "west"}; }

  std::uint32_t id() const { return id_; }
  const std::string& setup() const { return setup_; }

 private:
  void take(const sightline::TrackArray::ConstPtr& tracks) {
    came_ = ros::WallTime::now();
    stamp_ = tracks->header.stamp;
    id_ = 0;
    const Eigen::Vector2d truth = truthAt(stamp_.toSec());
    for (const sightline::Track& track : tracks->tracks) {
      if (track.status != sightline::Track::CONFIRMED) continue;
      const Eigen::Vector2d off = core::angleDifference({track.azimuth, track.elevation}, truth);
      if (off.norm() > kNear) continue;
      id_ = track.id;
      sources_ = track.sources;
      return;
    }
  }

  std::string setup_;
  ros::WallTime came_;
  ros::Time stamp_;
  std::uint32_t id_ = 0;  // of the oldest track that is near; 0 = none
  std::vector<std::string> sources_;
  ros::Subscriber subscriber_;
};

/// Two sensors that see one target, and the two fusions that are told of it.
class Chaos : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* setup : {"nodes", "nodelets"}) watches_.push_back(std::make_unique<Watch>(nh_, setup));
    ASSERT_TRUE(until([this] { return allHoldByBoth(); })) << "the target is not found at all";
  }

  bool allHoldByBoth() const {
    return std::all_of(watches_.begin(), watches_.end(),
                       [](const auto& watch) { return watch->holdsByBoth(); });
  }

  /// Plays the sensors until the condition holds.
  bool until(const std::function<bool()>& condition, double patience = kPatience) {
    return eventually(
        condition, [this] { play(); }, ros::WallDuration(0.002), patience);
  }

  void playFor(double duration) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(duration);
    until([&] { return ros::WallTime::now() >= end; });
  }

  /// Waits until both fusions hold the target by both trackers, and says how long that took from `begin`.
  void expectBack(const std::string& after, ros::WallTime begin, bool with_the_same_id) {
    std::vector<double> back(watches_.size(), -1.0);
    EXPECT_TRUE(until([&] {
      for (std::size_t i = 0; i < watches_.size(); ++i) {
        if (back[i] < 0.0 && watches_[i]->holdsByBoth()) back[i] = (ros::WallTime::now() - begin).toSec();
      }
      return std::all_of(back.begin(), back.end(), [](double time) { return time >= 0.0; });
    })) << after;
    for (std::size_t i = 0; i < watches_.size(); ++i) {
      std::printf("chaos: %-28s %-9s back after %6.2f s, id %u\n", after.c_str(),
                  watches_[i]->setup().c_str(), back[i], watches_[i]->id());
      if (with_the_same_id) EXPECT_EQ(ids_[i], watches_[i]->id()) << after << ", " << watches_[i]->setup();
    }
  }

  void noteIds() {
    ids_.clear();
    for (const auto& watch : watches_) ids_.push_back(watch->id());
  }

  /// Sends the signal to these nodes; returns their processes.
  std::vector<pid_t> send(int signal, const std::vector<std::string>& nodes) {
    std::vector<pid_t> processes;
    for (const std::string& node : nodes) {
      const auto process = processOf(node);
      EXPECT_TRUE(process) << node;
      if (process && kill(*process, signal) == 0) processes.push_back(*process);
    }
    return processes;
  }

  void expectBackFromKill(const std::string& what, const std::vector<std::string>& nodes,
                          bool with_the_same_id) {
    noteIds();
    const ros::WallTime begin = ros::WallTime::now();
    const auto killed = send(SIGKILL, nodes);
    const auto isAnother = [&](std::size_t i) {
      const auto process = processOf(nodes[i]);
      return process && *process != killed[i];
    };
    for (std::size_t i = 0; i < killed.size(); ++i)
      EXPECT_TRUE(until([&] { return isAnother(i); })) << nodes[i];
    expectBack("kill -9 " + what, begin, with_the_same_id);
  }

  void expectBackFromStop(const std::string& what, const std::vector<std::string>& nodes) {
    noteIds();
    const auto stopped = send(SIGSTOP, nodes);
    playFor(kHeldUp);
    const ros::WallTime begin = ros::WallTime::now();
    for (const pid_t process : stopped) kill(process, SIGCONT);
    expectBack("SIGSTOP of " + std::to_string(kHeldUp).substr(0, 3) + " s, " + what, begin, true);
  }

  sightline::SightingArray scan(const std::string& sensor, ros::Time stamp) {
    const Eigen::Vector2d truth = truthAt(stamp.toSec());
    return scanOf(sensor, stamp.toSec(),
                  {{truth.x() + kSigma * normal_(random_), truth.y() + kSigma * normal_(random_)}}, kSigma);
  }

  /// A scan of as many false sightings.
  sightline::SightingArray clutter(const std::string& sensor, int count) {
    std::vector<std::pair<double, double>> angles;
    for (int i = 0; i < count; ++i) angles.emplace_back(2.0 + 0.5 * normal_(random_), 0.3 * normal_(random_));
    return scanOf(sensor, ros::Time::now().toSec(), angles, kSigma);
  }

  void play() {
    const ros::WallTime now = ros::WallTime::now();
    if ((now - played_).toSec() < kInterval) return;
    played_ = now;
    west_.publish(scan("west", ros::Time::now()));
    sightline::SightingArray seen = scan("east", ros::Time::now());
    seen.header.stamp += ros::Duration(east_clock_);
    east_.publish(seen);
  }

  ros::NodeHandle nh_;
  ros::Publisher west_ = nh_.advertise<sightline::SightingArray>("/sightings/west", 10);
  ros::Publisher east_ = nh_.advertise<sightline::SightingArray>("/sightings/east", 10);
  std::vector<std::unique_ptr<Watch>> watches_;
  std::vector<std::uint32_t> ids_;
  ros::WallTime played_;
  double east_clock_ = 0.0;  // by which the stamps of its sightings are off [s]
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};

TEST_F(Chaos, ATrackerThatIsKilledComesBackAndItsFusionKeepsTheId) {
  expectBackFromKill("a tracker", {"/nodes/west/local_tracker", "/nodelets/west/local_tracker"}, true);
}

TEST_F(Chaos, TheFusionThatIsKilledFindsTheTargetAgain) {
  expectBackFromKill("the fusion or the manager", {"/nodes/track_fusion", "/nodelets/manager"}, false);
}

TEST_F(Chaos, ATrackerThatIsHeldUpKeepsItsId) {
  expectBackFromStop("a tracker", {"/nodes/west/local_tracker"});
}

TEST_F(Chaos, AFusionThatIsHeldUpKeepsTheId) {
  expectBackFromStop("the fusion or the manager", {"/nodes/track_fusion", "/nodelets/manager"});
}

TEST_F(Chaos, AFloodOfScansEndsWithIt) {
  noteIds();
  int sent = 0;
  const ros::WallTime start = ros::WallTime::now();
  const auto elapsed = [&] { return (ros::WallTime::now() - start).toSec(); };
  EXPECT_TRUE(eventually([&] { return elapsed() >= 1.0; },
                         [&] {
                           play();
                           for (; sent < 5000.0 * elapsed(); ++sent) west_.publish(clutter("west", 5));
                         }));
  expectBack("5,000 scans in a second", ros::WallTime::now(), true);
}

TEST_F(Chaos, AScanOfAHundredThousandSightingsIsSurvived) {
  noteIds();
  west_.publish(clutter("west", 100000));
  expectBack("100,000 sightings in a scan", ros::WallTime::now(), true);
}

TEST_F(Chaos, GarbageChangesNothing) {
  noteIds();
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  sightline::SightingArray scan = this->scan("west", ros::Time::now());
  scan.sightings[0].azimuth = kNaN;
  west_.publish(scan);
  scan.sightings[0].azimuth = 1e300;
  scan.sightings[0].covariance = {1e300, -1e300, 1e300, kNaN};
  scan.sensor = std::string(100000, 'x');
  west_.publish(scan);
  scan.header.frame_id = "";
  scan.sensor = "";
  west_.publish(scan);
  scan.header.stamp = ros::Time(0, 1);
  west_.publish(scan);

  for (const auto& watch : watches_) {
    ros::Publisher tracks = nh_.advertise<sightline::TrackArray>("/" + watch->setup() + "/west/tracks", 10);
    EXPECT_TRUE(until([&] { return tracks.getNumSubscribers() > 0; }));
    sightline::TrackArray garbage;
    garbage.header.stamp = ros::Time::now();
    garbage.header.frame_id = "platform_enu";
    garbage.tracker = "garbage";
    garbage.tracks.resize(2);
    for (sightline::Track& track : garbage.tracks) {
      track.id = 7;
      track.status = sightline::Track::CONFIRMED;
      track.azimuth_rate = 1e300;
      track.covariance.fill(1e300);
    }
    garbage.tracks[1].status = 200;
    garbage.tracks[1].covariance.fill(kNaN);
    tracks.publish(garbage);
    playFor(0.1);
  }
  expectBack("garbage", ros::WallTime::now(), true);
}

TEST_F(Chaos, AClockThatStepsHarmsNobodyElse) {
  noteIds();
  for (const double step : {30.0, -30.0, 0.5}) {
    east_clock_ = step;
    playFor(0.5);
    EXPECT_TRUE(until([&] {
      return std::all_of(watches_.begin(), watches_.end(), [](const auto& watch) { return watch->holds(); });
    })) << step;
  }
  east_clock_ = 0.0;
  expectBack("a clock that steps", ros::WallTime::now(), true);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "chaos_test");
  return RUN_ALL_TESTS();
}
