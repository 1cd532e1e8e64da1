// One recording of six sensors on three ways: through the classes of the core, through the replay of a bag,
// and through the nodes. Does the same quality come out of each?
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sightline/FusionReport.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>

#include "sightline/core/fusion/track_fusion.h"
#include "sightline/core/simulation/scenario.h"
#include "sightline/core/simulation/sensor_simulator.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/recordings/replay.h"

#include "support/received.h"
#include "support/scratch_folder.h"

namespace {

namespace core = sightline::core;

constexpr double kAmplitude = 0.01;   // of the target's sinusoid [rad]
constexpr double kDuration = 20.0;    // [s]
constexpr double kSettled = 2.0;      // errors count from then on [s]
constexpr int kRuns = 20;             // for the band
constexpr std::uint64_t kPlayed = 1;  // the seed that is played
const core::Time kStart{std::chrono::seconds(1000)};
const char* const kFrame = "platform_enu";
const char* const kEstimator = "noga";  // of every tracker and of the fusion
const std::vector<std::string> kSensors = {"acquisition_1", "acquisition_2", "acquisition_3",
                                           "tracking_1",    "tracking_2",    "tracking_3"};

double sigmaOf(const std::string& sensor) {
  return kAmplitude * (sensor[0] == 'a' ? 0.15 : 0.08);
}

core::Scenario scenarioOf(std::uint64_t seed) {
  core::Scenario scenario;
  scenario.seed = seed;
  scenario.duration = kDuration;
  core::Sinusoid sinusoid;
  sinusoid.amplitude.setConstant(kAmplitude);
  scenario.targets.resize(1);
  scenario.targets[0].trajectory = sinusoid;
  for (const std::string& name : kSensors) {
    core::SimulatedSensor sensor;
    sensor.name = name;
    sensor.ifov = sigmaOf(name);
    sensor.sigma.setConstant(sigmaOf(name));
    scenario.sensors.push_back(sensor);
  }
  return scenario;
}

/// All scans of the scenario in the order in which trackers follow them. The sensors look along the axes of
/// the tracking frame.
std::vector<core::Scan> scansOf(const core::Scenario& scenario) {
  std::vector<core::Scan> scans;
  for (const std::string& name : kSensors) {
    core::SensorSimulator sensor(scenario, name, kStart);
    while (auto simulated = sensor.next()) scans.push_back(simulated->scan);
  }
  std::sort(scans.begin(), scans.end(),
            [](const core::Scan& a, const core::Scan& b) { return core::precedes(a, b); });
  return scans;
}

/// Errors of one stream of tracks against the truth.
class Accuracy {
 public:
  explicit Accuracy(const core::Scenario& scenario) : scenario_(scenario) {}

  /// Takes what was said of the time: a single confirmed track is right.
  void take(core::Time time, const std::vector<core::Track>& tracks) {
    const double t = core::seconds(time - kStart);
    if (t < kSettled) return;
    const auto truth = core::truthAt(scenario_, scenario_.targets[0], t);
    const auto is_confirmed = [](const core::Track& track) {
      return track.status == core::TrackStatus::confirmed;
    };
    const auto track = std::find_if(tracks.begin(), tracks.end(), is_confirmed);
    if (!truth || tracks.size() != 1 || track == tracks.end()) {
      ++broken_;
      return;
    }
    squares_ += core::angleDifference(track->state.angles(), truth->angles()).squaredNorm() / 2.0;
    ++count_;
  }

  void take(const sightline::TrackArray& message) {
    std::vector<core::Track> tracks;
    for (const sightline::Track& track : message.tracks) tracks.push_back(sightline_ros::toCore(track));
    take(sightline_ros::toCore(message.header.stamp), tracks);
  }

  /// Of one angle [rad].
  double rmse() const { return std::sqrt(squares_ / static_cast<double>(count_)); }
  std::size_t count() const { return count_; }
  std::size_t broken() const { return broken_; }

 private:
  core::Scenario scenario_;
  double squares_ = 0.0;
  std::size_t count_ = 0, broken_ = 0;
};

struct Figures {
  explicit Figures(const core::Scenario& scenario)
      : fused(scenario), central(scenario), central_then(scenario) {}

  Accuracy fused;         // tracklets of a local tracker for each sensor
  Accuracy central;       // one local tracker over all sightings
  Accuracy central_then;  // the same, where there is a fusion: once a round
};

constexpr double kAtOnce = 0.0;  // max_wait of the fusion node, so that it answers every scan [s]

core::LocalTrackerParams trackerParams() {
  core::LocalTrackerParams params;
  params.estimator.kind = core::EstimatorKind::noga;
  return params;
}

/// The recording through the classes of the core; `max_wait` of the fusion [s].
Figures throughCore(std::uint64_t seed, double max_wait) {
  struct Local {
    core::LocalTracker tracker{trackerParams()};
    core::TrackletBuilder tracklets{core::TrackletParams{}};
  };
  const core::Scenario scenario = scenarioOf(seed);
  Figures figures(scenario);
  core::TrackFusionParams fusion_params;
  fusion_params.tracklets.estimator.kind = core::EstimatorKind::noga;
  fusion_params.max_wait = max_wait;
  core::TrackFusion fusion(fusion_params);
  core::LocalTracker central(trackerParams());
  std::map<std::string, Local> locals;
  const std::vector<core::Scan> scans = scansOf(scenario);
  for (const core::Scan& scan : scans) {
    Local& local = locals[scan.sensor];
    const core::ScanReport tracked = local.tracker.onScan(scan);
    if (auto tracklets = local.tracklets.onScan(scan, tracked)) {
      tracklets->tracker = scan.sensor;
      fusion.onTracklets(*tracklets);
    }
    const core::ScanReport of_all = central.onScan(scan);
    figures.central.take(of_all.time, of_all.tracks);
    const bool is_refused = fusion.take({scan.sensor, tracked.time, tracked.tracks}).has_value();
    const bool is_last = &scan == &scans.back();
    if (is_refused || !(fusion.isDue() || is_last)) continue;
    const core::FusionReport fused = fusion.fuse();
    std::vector<core::Track> tracks;
    for (const core::FusedTrack& track : fused.tracks) tracks.push_back(track.track);
    figures.fused.take(fused.time, tracks);
    figures.central_then.take(of_all.time, of_all.tracks);
  }
  return figures;
}

/// How far a run's RMSE lies from the mean by chance, over kRuns seeds.
struct Band {
  double mean = 0.0, sigma = 0.0;  // [rad]

  double least() const { return mean - 3.0 * sigma; }
  double most() const { return mean + 3.0 * sigma; }
};

Band bandOfTheCore() {
  Band band;
  std::vector<double> figures;
  for (std::uint64_t seed = kPlayed; seed < kPlayed + kRuns; ++seed)
    figures.push_back(throughCore(seed, kAtOnce).fused.rmse());
  for (const double rmse : figures) band.mean += rmse / kRuns;
  for (const double rmse : figures) band.sigma += std::pow(rmse - band.mean, 2) / (kRuns - 1);
  band.sigma = std::sqrt(band.sigma);
  return band;
}

sightline::SightingArray messageOf(const core::Scan& scan) {
  return sightline_ros::toMessage(scan, kFrame);
}

std::string topicOf(const std::string& sensor) {
  return "/sensors/" + sensor + "/sightings";
}

TEST(SixSensorAccuracy, ReplayOfTheRecordingHasTheErrorOfTheCore) {
  const Figures direct = throughCore(kPlayed, core::TrackFusionParams{}.max_wait);
  const ScratchFolder folder;
  {
    rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Write);
    for (const core::Scan& scan : scansOf(scenarioOf(kPlayed)))
      bag.write(topicOf(scan.sensor), sightline_ros::toRos(scan.time), messageOf(scan));
  }
  sightline_ros::ReplaySettings settings{"", kEstimator, ""};
  settings.all = true;
  sightline_ros::replay(folder.file("in.bag"), folder.file("out.bag"), settings);

  Figures replayed(scenarioOf(kPlayed));
  rosbag::Bag bag(folder.file("out.bag"));
  rosbag::View view(bag, rosbag::TypeQuery("sightline/TrackArray"));
  for (const rosbag::MessageInstance& message : view) {
    const auto tracks = message.instantiate<sightline::TrackArray>();
    if (message.getTopic() == "/fusion/tracks") replayed.fused.take(*tracks);
    if (message.getTopic() == "/sensor_fusion/tracks") replayed.central.take(*tracks);
  }
  EXPECT_EQ(direct.fused.broken() + replayed.fused.broken(), 0u);
  EXPECT_EQ(replayed.fused.count(), direct.fused.count());
  EXPECT_EQ(replayed.central.count(), direct.central.count());
  EXPECT_NEAR(replayed.fused.rmse() / direct.fused.rmse(), 1.0, 1e-6);
  EXPECT_NEAR(replayed.central.rmse() / direct.central.rmse(), 1.0, 1e-6);
  EXPECT_NEAR(direct.fused.rmse() / direct.central_then.rmse(), 1.0, 0.01);
  RecordProperty("core_fused", std::to_string(direct.fused.rmse() / sigmaOf("tracking_1")));
  RecordProperty("core_central", std::to_string(direct.central.rmse() / sigmaOf("tracking_1")));
}

class Nodes : public testing::Test {
 protected:
  Nodes() {
    for (const std::string& sensor : kSensors)
      sightings_[sensor] = nh_.advertise<sightline::SightingArray>(topicOf(sensor), 1000);
  }

  /// Shows all sensors a target that stands still, long before the recording, until the fusion hears tracks
  /// and tracklets of all of them.
  bool connect() {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    core::Time time = kStart - std::chrono::seconds(200);
    const auto all_fused = [this] {
      if (reports_.messages().empty()) return false;
      const sightline::FusionReport& report = reports_.messages().back();
      return report.tracks.size() == 1 && report.tracks[0].rule == "tracklets" &&
             report.tracks[0].sources.size() == kSensors.size();
    };
    return eventually(all_fused, [&] {
      if (time > kStart - std::chrono::seconds(20)) return;
      time += std::chrono::milliseconds(10);
      for (const std::string& sensor : kSensors) {
        const double sigma = sigmaOf(sensor);
        core::Scan scan;
        scan.time = time;
        scan.sensor = sensor;
        scan.sightings = {core::sightingOf(sigma * Eigen::Vector2d(normal(random), normal(random)),
                                           sigma * sigma * Eigen::Matrix2d::Identity())};
        sightings_[sensor].publish(messageOf(scan));
      }
    });
  }

  /// Reports of the fusion since the recording began.
  std::size_t answers() {
    const ros::Time start = sightline_ros::toRos(kStart);
    const auto& all = reports_.messages();
    while (before_ < all.size() && all[before_].header.stamp < start) ++before_;
    return all.size() - before_;
  }

  /// Plays scans as fast as the fusion, which answers each, does, one after the other as the core has them:
  /// trackers that work side by side would overtake each other, the more the busier the machine is.
  void play(const std::vector<core::Scan>& scans) {
    for (std::size_t sent = 0; sent < scans.size();) {
      sightings_[scans[sent].sensor].publish(messageOf(scans[sent]));
      ++sent;
      ASSERT_TRUE(eventually([&] { return answers() >= sent; })) << "after " << sent << " scans";
    }
  }

  ros::NodeHandle nh_;
  std::map<std::string, ros::Publisher> sightings_;
  Received<sightline::TrackArray> tracks_{nh_, "/fusion/tracks"};
  Received<sightline::FusionReport> reports_{nh_, "/fusion/report"};
  std::size_t before_ = 0;  // of the reports, those before the recording
};

TEST_F(Nodes, FusedTrackHasTheErrorOfTheCoreWithinItsBand) {
  const Figures direct = throughCore(kPlayed, kAtOnce);
  const Band band = bandOfTheCore();
  ASSERT_TRUE(connect()) << "the fusion does not hear of all six sensors";
  const std::vector<core::Scan> scans = scansOf(scenarioOf(kPlayed));
  ASSERT_NO_FATAL_FAILURE(play(scans));

  Accuracy through_nodes(scenarioOf(kPlayed));
  for (const sightline::TrackArray& tracks : tracks_.messages()) {
    if (tracks.header.stamp >= sightline_ros::toRos(kStart)) through_nodes.take(tracks);
  }
  EXPECT_EQ(through_nodes.broken(), 0u);
  EXPECT_GT(through_nodes.count(), direct.fused.count() * 99 / 100);
  EXPECT_GT(through_nodes.rmse(), band.least());
  EXPECT_LT(through_nodes.rmse(), band.most());
  // The same sightings in the same order: only a tracklet that the tracks of its scan overtake may tell.
  EXPECT_NEAR(through_nodes.rmse() / direct.fused.rmse(), 1.0, 0.03);
  const double unit = sigmaOf("tracking_1");
  std::printf("RMSE / sigma of the best sensor: core %.4f, nodes %.4f; core over %d runs %.4f +- %.4f\n",
              direct.fused.rmse() / unit, through_nodes.rmse() / unit, kRuns, band.mean / unit,
              band.sigma / unit);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "six_sensor_accuracy_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
