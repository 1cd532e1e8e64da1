// Truth, sightings and tracks of known errors through the node: what it publishes and prints must be these
// errors.
#include <cmath>
#include <csignal>
#include <memory>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/Evaluation.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/core/model/sphere.h"

#include "support/waiting.h"

namespace {

namespace core = sightline::core;

constexpr double kStep = 0.05;  // [s] between instants
constexpr int kInstants = 61;
constexpr double kSigma = 0.01;  // stated by the sensor "level" [rad]; "tilted" states twice that

/// Along the horizon, where arcs are angles.
Eigen::Vector4d truthAt(double t) {
  return {0.2 * std::sin(t), 0.0, 0.2 * std::cos(t), 0.0};
}

const Eigen::Quaterniond kTilt(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.2, 0.3, 1.0).normalized()));

sightline::Track track(std::uint32_t id, const Eigen::Vector4d& mean, double sigma) {
  sightline::Track message;
  message.id = id;
  message.status = sightline::Track::CONFIRMED;
  message.azimuth = mean(0);
  message.elevation = mean(1);
  message.azimuth_rate = mean(2);
  message.elevation_rate = mean(3);
  message.covariance.fill(0.0);
  for (int i = 0; i < 4; ++i) message.covariance[5 * i] = sigma * sigma;
  return message;
}

sightline::SightingArray scan(const std::string& sensor, const Eigen::Vector2d& angles, double sigma) {
  sightline::SightingArray message;
  message.header.frame_id = message.sensor = sensor;
  message.ifov = message.detection_probability = message.clutter_density = std::nan("");
  message.sightings.resize(1);
  message.sightings[0].azimuth = angles.x();
  message.sightings[0].elevation = angles.y();
  message.sightings[0].covariance = {sigma * sigma, 0.0, 0.0, sigma * sigma};
  message.sightings[0].snr = std::nan("");
  return message;
}

/// A run of the platform with errors that are the same at every instant.
class SyntheticRun {
 public:
  SyntheticRun() {
    truth_ = nh_.advertise<sightline::TrackArray>("/truth", 1000);
    local_ = nh_.advertise<sightline::TrackArray>("/sensors/level/tracks", 1000);
    fused_ = nh_.advertise<sightline::TrackArray>("/fusion/tracks", 1000);
    level_ = nh_.advertise<sightline::SightingArray>("/sensors/level/sightings", 1000);
    tilted_ = nh_.advertise<sightline::SightingArray>("/sensors/tilted/sightings", 1000);
    position_truth_ = nh_.advertise<sightline::PositionTrackArray>("/truth/positions", 1000);
    positions_ = nh_.advertise<sightline::PositionTrackArray>("/positions/tracks", 1000);
    frames_ = nh_.advertise<tf2_msgs::TFMessage>("/tf_static", 10, true);
    frames_.publish(sensorFrames());
  }

  bool waitForListeners(std::uint32_t count) const {
    return eventually([&] {
      for (const ros::Publisher& publisher :
           {truth_, local_, fused_, level_, tilted_, position_truth_, positions_, frames_}) {
        if (publisher.getNumSubscribers() < count) return false;
      }
      return true;
    });
  }

  void publish() const {
    const ros::Time start = ros::Time::now() - ros::Duration(kStep * kInstants);
    for (int i = 0; i < kInstants; ++i) publishInstant(kStep * i, start + ros::Duration(kStep * i));
  }

 private:
  static tf2_msgs::TFMessage sensorFrames() {
    tf2_msgs::TFMessage message;
    for (const std::string sensor : {"level", "tilted"}) {
      geometry_msgs::TransformStamped transform;
      transform.header.frame_id = "platform_enu";
      transform.child_frame_id = sensor;
      const Eigen::Quaterniond q = sensor == "tilted" ? kTilt : Eigen::Quaterniond::Identity();
      transform.transform.rotation.x = q.x();
      transform.transform.rotation.y = q.y();
      transform.transform.rotation.z = q.z();
      transform.transform.rotation.w = q.w();
      message.transforms.push_back(transform);
    }
    return message;
  }

  void publishInstant(double t, const ros::Time& stamp) const {
    const Eigen::Vector4d truth = truthAt(t);
    sightline::TrackArray tracks;
    tracks.header.frame_id = "platform_enu";
    tracks.header.stamp = stamp;

    tracks.tracker = "level_tracker";
    tracks.estimator = "twbls";
    tracks.tracks = {track(3, truth + Eigen::Vector4d(0.003, 0.004, 0.03, 0.04), 0.005)};
    local_.publish(tracks);
    tracks.tracker = "fusion";
    tracks.estimator = "weighted_covariance";
    tracks.tracks = {track(1, truth + Eigen::Vector4d(0.001, 0.0, 0.0, 0.02), 0.001),
                     track(2, truth + Eigen::Vector4d(1.0, 0.0, 0.0, 0.0), 0.001)};  // of nothing
    fused_.publish(tracks);

    sightline::SightingArray level = scan("level", truth.head<2>() + Eigen::Vector2d(0.006, 0.008), kSigma);
    level.header.stamp = stamp;
    level.sightings.push_back(scan("level", {-2.0, 0.0}, kSigma).sightings[0]);  // a false one
    level_.publish(level);
    const Eigen::Vector3d seen = core::directionOf(truth.head<2>() + Eigen::Vector2d(0.0, -0.02));
    sightline::SightingArray tilted = scan("tilted", core::anglesOf(kTilt.conjugate() * seen), 2.0 * kSigma);
    tilted.header.stamp = stamp;
    tilted_.publish(tilted);

    position_truth_.publish(position(t, 0.0, stamp));
    positions_.publish(position(t, 0.75, stamp));
    tracks.tracker = tracks.estimator = "truth";
    tracks.tracks = {track(1, truth, 0.0)};
    truth_.publish(tracks);
  }

  /// A target that flies along y, with an error along x [m].
  static sightline::PositionTrackArray position(double t, double error, const ros::Time& stamp) {
    sightline::PositionTrackArray message;
    message.header.frame_id = "world";
    message.header.stamp = stamp;
    message.tracks.resize(1);
    message.tracks[0].id = 4;
    message.tracks[0].status = sightline::PositionTrack::CONFIRMED;
    message.tracks[0].position.x = error;
    message.tracks[0].position.y = 10.0 * t;
    for (std::size_t i = 0; i < 6; ++i) message.tracks[0].covariance[7 * i] = 0.25;
    return message;
  }

  ros::NodeHandle nh_;
  ros::Publisher truth_, local_, fused_, level_, tilted_, position_truth_, positions_, frames_;
};

/// A second evaluator that the test starts and ends itself, with what it prints.
class Child {
 public:
  explicit Child(const std::string& name) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    pid_ = fork();
    if (pid_ == 0) {
      dup2(ends[1], STDOUT_FILENO);
      close(ends[0]);
      execl(SIGHTLINE_TRACK_EVALUATOR, "track_evaluator", ("__name:=" + name).c_str(), "/evaluation:=/unused",
            static_cast<char*>(nullptr));
      _exit(127);
    }
    close(ends[1]);
    output_ = ends[0];
  }
  ~Child() {
    if (pid_ > 0) kill(pid_, SIGKILL), waitpid(pid_, nullptr, 0);
    close(output_);
  }

  void interrupt() const { kill(pid_, SIGINT); }

  /// Reads until `part` was printed, or everything up to its end when that is empty.
  bool readUntil(const std::string& part = "") {
    return eventually([&] {
      readSome();
      return part.empty() ? ended_ : text_.find(part) != std::string::npos;
    });
  }

  /// Exit code; call when it has ended.
  int exitCode() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  const std::string& text() const { return text_; }

 private:
  void readSome() {
    pollfd waiting{output_, POLLIN, 0};
    while (!ended_ && poll(&waiting, 1, 0) > 0) {
      char buffer[4096];
      const ssize_t count = read(output_, buffer, sizeof buffer);
      if (count <= 0)
        ended_ = true;
      else
        text_.append(buffer, static_cast<std::size_t>(count));
    }
  }

  pid_t pid_ = -1;
  int output_ = -1;
  bool ended_ = false;
  std::string text_;
};

class TrackEvaluator : public ::testing::Test {
 protected:
  void configureChild(const std::string& name, bool live, double duration) {
    nh_.setParam(name + "/sighting_topics",
                 std::vector<std::string>{"/sensors/level/sightings", "/sensors/tilted/sightings"});
    nh_.setParam(name + "/track_topics", std::vector<std::string>{"/sensors/level/tracks", "/fusion/tracks"});
    nh_.setParam(name + "/live", live);
    nh_.setParam(name + "/duration", duration);
  }

  ros::NodeHandle nh_;
};

TEST_F(TrackEvaluator, PublishesTheErrorsThatWereMade) {
  sightline::Evaluation evaluation;
  const ros::Subscriber subscriber = nh_.subscribe<sightline::Evaluation>(
      "/evaluation", 10, [&](const sightline::Evaluation::ConstPtr& message) { evaluation = *message; });
  SyntheticRun run;
  ASSERT_TRUE(run.waitForListeners(1));
  run.publish();
  ASSERT_TRUE(eventually([&] {
    if (evaluation.rows.size() != 4) return false;
    for (const auto& row : evaluation.rows) {
      if (row.samples < kInstants) return false;
    }
    return true;
  })) << "rows: "
      << evaluation.rows.size();

  const auto& level = evaluation.rows[0];
  EXPECT_EQ(level.topic, "/sensors/level/sightings");
  EXPECT_EQ(level.name, "level");
  EXPECT_EQ(level.samples, std::uint64_t(kInstants));
  EXPECT_NEAR(level.rmse, 0.01 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(level.relative_rmse, 1.0 / std::sqrt(2.0), 1e-3);
  EXPECT_NEAR(level.anees_position, 0.5, 1e-3);
  EXPECT_TRUE(std::isnan(level.rate_rmse) && std::isnan(level.anees_state) && std::isnan(level.coverage));
  EXPECT_EQ(level.unmatched, std::uint64_t(kInstants));

  const auto& tilted = evaluation.rows[1];
  EXPECT_EQ(tilted.name, "tilted");
  EXPECT_NEAR(tilted.rmse, 0.02 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(tilted.relative_rmse, 2.0 / std::sqrt(2.0), 2e-3);

  const auto& local = evaluation.rows[2];
  EXPECT_EQ(local.topic, "/sensors/level/tracks");
  EXPECT_EQ(local.name, "level_tracker");
  EXPECT_NEAR(local.rmse, 0.005 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(local.rate_rmse, 0.05 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(local.anees_position, 0.5, 1e-6);
  EXPECT_NEAR(local.anees_state, (1.0 + 100.0) / 4.0, 1e-3);
  EXPECT_EQ(local.coverage, 1.0);
  EXPECT_EQ(local.breaks + local.id_switches + local.unmatched, 0u);

  const auto& fused = evaluation.rows[3];
  EXPECT_EQ(fused.topic, "/fusion/tracks");
  EXPECT_NEAR(fused.rmse, 0.001 / std::sqrt(2.0), 1e-9);
  EXPECT_EQ(fused.samples, std::uint64_t(kInstants));
  EXPECT_EQ(fused.unmatched, std::uint64_t(kInstants));
  EXPECT_EQ(fused.tracks, 2u);
  EXPECT_EQ(fused.false_tracks, 1u);
  EXPECT_NEAR(fused.false_tracks_per_hour, 3600.0 / (kStep * (kInstants - 1)), 1e-3);
  EXPECT_NEAR(fused.purity, 0.5, 1e-9);
  EXPECT_NEAR(fused.completeness, 1.0, 1e-9);
  EXPECT_EQ(fused.appearances, 1u);
  EXPECT_EQ(fused.never_confirmed, 0u);
  EXPECT_NEAR(fused.confirm_worst, 0.0, 1e-9);
  EXPECT_NEAR(fused.gospa_false, 0.01 / std::sqrt(2.0), 1e-9);  // c = 0.01 rad, one in each report
  EXPECT_NEAR(fused.gospa_localisation, 0.001, 1e-9);
  EXPECT_NEAR(fused.ospa, std::sqrt((1e-6 + 1e-4) / 2.0), 1e-9);
  ASSERT_EQ(evaluation.targets.size(), 2u);
  EXPECT_EQ(evaluation.targets[0].topic, "/sensors/level/tracks");
  EXPECT_EQ(evaluation.targets[0].target, 1u);
  EXPECT_NEAR(evaluation.targets[0].rmse, 0.005 / std::sqrt(2.0), 1e-9);
  EXPECT_EQ(evaluation.targets[1].coverage, 1.0);
  EXPECT_EQ(evaluation.header.frame_id, "platform_enu");
}

TEST_F(TrackEvaluator, EndsByItselfAfterItsDurationWithTheTable) {
  configureChild("/ending", false, kStep * (kInstants - 1) - 0.001);
  Child child("ending");
  SyntheticRun run;
  ASSERT_TRUE(run.waitForListeners(2));
  run.publish();
  ASSERT_TRUE(child.readUntil()) << "it did not end; so far:\n" << child.text();
  EXPECT_EQ(child.exitCode(), 0);
  EXPECT_NE(child.text().find("/sensors/level/tracks"), std::string::npos) << child.text();
  EXPECT_NE(child.text().find("0.003536"), std::string::npos) << child.text();  // 0.005 / sqrt(2)
  const std::size_t positions = child.text().find("/positions/tracks");
  ASSERT_NE(positions, std::string::npos) << child.text();
  EXPECT_NE(child.text().find("0.75", positions), std::string::npos) << child.text();
}

TEST_F(TrackEvaluator, ShowsASummaryWhileItRunsAndTheTableAfterCtrlC) {
  configureChild("/live", true, 0.0);
  Child child("live");
  SyntheticRun run;
  ASSERT_TRUE(run.waitForListeners(2));
  run.publish();
  ASSERT_TRUE(child.readUntil("  sensors/level")) << child.text();
  EXPECT_EQ(child.text().find('\033'), std::string::npos) << "control characters, though nobody sits there";
  child.interrupt();
  ASSERT_TRUE(child.readUntil()) << "it did not end";
  EXPECT_EQ(child.exitCode(), 0);
  EXPECT_NE(child.text().find("fused tracks\n"), std::string::npos) << child.text();
}

TEST_F(TrackEvaluator, RefusesAParameterThatNobodyKnows) {
  configureChild("/wrong", false, 0.0);
  nh_.setParam("/wrong/durations", 3.0);
  Child child("wrong");
  ASSERT_TRUE(child.readUntil());
  EXPECT_EQ(child.exitCode(), 1);
}

TEST_F(TrackEvaluator, RefusesATableFileThatCannotBeWritten) {
  configureChild("/unwritable", false, 0.0);
  nh_.setParam("/unwritable/table_file", "/no/such/folder/table.txt");
  Child child("unwritable");
  ASSERT_TRUE(child.readUntil()) << "it runs, and would lose its table";
  EXPECT_EQ(child.exitCode(), 1);
}

}  // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "track_evaluator_test");
  const ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
