#include "sightline/ros/components/local_tracker_component.h"

#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/ros/components/local_tracker_health.h"
#include "sightline/ros/messages/conversions.h"

#include "support/diagnostics.h"
#include "support/scans.h"
#include "support/times.h"

namespace {

namespace core = sightline::core;
using sightline::test::at;
using sightline::test::valueOf;
using sightline_ros::LocalTrackerComponent;
using sightline_ros::LocalTrackerHealth;
using sightline_ros::ParamReader;
using sightline_ros::toCore;
using sightline_ros::TrackerReport;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

sightline::SightingArray::Ptr scanAt(double stamp, const std::vector<double>& azimuths,
                                     const std::string& sensor = "eye") {
  auto scan = boost::make_shared<sightline::SightingArray>();
  scan->header.stamp = ros::Time(stamp);
  scan->header.frame_id = "platform_enu";
  scan->sensor = sensor;
  scan->ifov = scan->detection_probability = scan->clutter_density = kNaN;
  for (double azimuth : azimuths) {
    sightline::Sighting sighting;
    sighting.azimuth = azimuth;
    sighting.covariance = {1e-6, 0.0, 0.0, 1e-6};
    sighting.snr = kNaN;
    scan->sightings.push_back(sighting);
  }
  return scan;
}

class TrackerComponent : public testing::Test {
 protected:
  TrackerReport report(const sightline::SightingArray::Ptr& scan) {
    const auto reports = component_.onScan(scan, toCore(scan->header.stamp));
    EXPECT_EQ(reports.size(), 1u);
    return reports.at(0);
  }

  tf2::BufferCore transforms_;
  ParamReader reader_{XmlRpc::XmlRpcValue(), "/test"};
  LocalTrackerComponent component_{reader_, "my_tracker", transforms_};
};

TEST_F(TrackerComponent, SightingsOfATargetBecomeAConfirmedTrack) {
  TrackerReport last;
  for (int i = 0; i < 10; ++i) last = report(scanAt(10.0 + 0.03 * i, {0.5 + 0.003 * i}));
  ASSERT_TRUE(last.tracks);
  EXPECT_EQ(last.tracks->tracker, "my_tracker");
  EXPECT_EQ(last.tracks->estimator, component_.estimator());
  EXPECT_EQ(last.tracks->header.frame_id, "platform_enu");
  EXPECT_EQ(last.tracks->header.stamp, ros::Time(10.27));
  ASSERT_EQ(last.tracks->tracks.size(), 1u);
  const auto& track = last.tracks->tracks[0];
  EXPECT_EQ(track.status, sightline::Track::CONFIRMED);
  EXPECT_NEAR(track.azimuth, 0.527, 1e-3);
  EXPECT_EQ(track.sources, std::vector<std::string>{"eye"});
  EXPECT_EQ(track.last_sighting, ros::Time(10.27));
}

TEST_F(TrackerComponent, EverySightingHasItsAssociationAndBadOnesTheirReason) {
  for (int i = 0; i < 5; ++i) report(scanAt(10.0 + 0.03 * i, {0.5}));
  const auto last = report(scanAt(10.15, {0.5, kNaN, 100.0}));
  ASSERT_EQ(last.associations->associations.size(), 3u);
  EXPECT_EQ(last.associations->sensor, "eye");
  EXPECT_EQ(last.associations->associations[0].decision, sightline::Association::ACCEPTED);
  EXPECT_EQ(last.associations->associations[1].decision, sightline::Association::REJECTED_INPUT);
  EXPECT_NE(last.associations->associations[1].reason.find("not finite"), std::string::npos);
  EXPECT_NE(last.associations->associations[2].reason.find("degrees"), std::string::npos);
  EXPECT_EQ(last.rejected, 2u);
  EXPECT_FALSE(last.refusal);
}

TEST_F(TrackerComponent, DuplicateAndLateScansAreDroppedWithTheirReason) {
  report(scanAt(10.0, {0.5}));
  report(scanAt(12.0, {0.5}));
  const auto duplicate = report(scanAt(12.0, {0.5}));
  ASSERT_TRUE(duplicate.refusal);
  EXPECT_EQ(duplicate.refusal->kind, "duplicate");
  EXPECT_FALSE(duplicate.tracks);
  ASSERT_EQ(duplicate.associations->associations.size(), 1u);
  EXPECT_EQ(duplicate.associations->associations[0].decision, sightline::Association::REJECTED_INPUT);
  EXPECT_EQ(duplicate.associations->associations[0].reason, core::textOf(*duplicate.refusal));
  const auto late = report(scanAt(12.0 - component_.maxLag() - 0.1, {0.5}));
  ASSERT_TRUE(late.refusal);
  EXPECT_EQ(late.refusal->kind, "late");
}

TEST_F(TrackerComponent, AScanThatItsEstimatorCannotWeighIsRefusedAndItGoesOnAsIfItHadNotCome) {
  XmlRpc::XmlRpcValue values;
  values["estimator"] = std::string("twbls");
  values["twbls"]["form"] = std::string("paper");
  values["twbls"]["paper"]["sensor_weight"] = std::string("ifov");
  const ParamReader reader(values, "/test");
  LocalTrackerComponent with(reader, "with", transforms_), without(reader, "without", transforms_);
  LocalTrackerHealth health(2.0, {0.5, 0.1});
  const auto scanOf = [](double stamp, double ifov) {
    auto scan = scanAt(stamp, {0.5 + 0.1 * (stamp - 10.0)});
    scan->ifov = ifov;
    return scan;
  };
  int refused = 0;
  for (int i = 0; i < 60; ++i) {
    const double stamp = 10.0 + 0.03 * i;
    const auto good = scanOf(stamp, 1e-3);
    const auto expected = without.onScan(good, at(stamp)).at(0), got = with.onScan(good, at(stamp)).at(0);
    ASSERT_TRUE(expected.tracks && got.tracks);
    ASSERT_EQ(expected.tracks->tracks.size(), got.tracks->tracks.size()) << i;
    for (std::size_t k = 0; k < got.tracks->tracks.size(); ++k) {
      EXPECT_EQ(expected.tracks->tracks[k].id, got.tracks->tracks[k].id);
      EXPECT_EQ(expected.tracks->tracks[k].azimuth, got.tracks->tracks[k].azimuth) << i;
      EXPECT_EQ(expected.tracks->tracks[k].covariance, got.tracks->tracks[k].covariance) << i;
    }
    if (i < 20 || i % 4 != 0) continue;
    const auto bad = with.onScan(scanOf(stamp + 0.01, kNaN), at(stamp + 0.01));
    ASSERT_EQ(bad.size(), 1u);
    ASSERT_TRUE(bad[0].refusal) << "this estimator needs the ifov";
    EXPECT_EQ(bad[0].refusal->kind, "invalid");
    EXPECT_NE(bad[0].refusal->detail.find("ifov"), std::string::npos) << bad[0].refusal->detail;
    EXPECT_FALSE(bad[0].tracks);
    health.note(bad[0]);
    ++refused;
  }
  EXPECT_EQ(refused, 10);
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(11.8), 0, status);
  bool is_counted = false;
  for (const auto& value : status.values)
    is_counted |= value.key == "scans dropped, invalid" && value.value == "10";
  EXPECT_TRUE(is_counted);
}

TEST_F(TrackerComponent, HealthTellsNoMoreThanSoManySensorsApart) {
  LocalTrackerHealth health(2.0, {0.5, 0.1});
  for (int k = 0; k < 3000; ++k)
    health.noteArrival(*scanAt(10.0 + 0.001 * k, {}, "sensor " + std::to_string(k)), at(10.0 + 0.001 * k));
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(13.0), 0, status);
  EXPECT_LT(status.values.size(), 2000u);
}

TEST_F(TrackerComponent, ScanWithoutTransformIsReportedOnceItIsGivenUp) {
  auto scan = scanAt(10.0, {0.5, 0.6});
  scan->header.frame_id = "nowhere";
  EXPECT_TRUE(component_.onScan(scan, at(10.0)).empty());
  EXPECT_EQ(component_.waiting(), 1u);
  const auto reports = component_.onTransforms(at(10.0 + component_.tfTimeout()));
  ASSERT_EQ(reports.size(), 1u);
  ASSERT_TRUE(reports[0].refusal);
  EXPECT_EQ(reports[0].refusal->kind, "no transform");
  EXPECT_EQ(reports[0].associations->associations.size(), 2u);
}

TEST_F(TrackerComponent, HealthShowsRatesDropsAgesAndTracks) {
  LocalTrackerHealth health(2.0);
  diagnostic_updater::DiagnosticStatusWrapper before;
  health.diagnose(at(10.0), 0, before);
  EXPECT_EQ(before.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_EQ(before.message, "no scan yet");

  for (int i = 0; i < 20; ++i) health.note(report(scanAt(10.0 + 0.05 * i, {0.5})));
  health.note(report(scanAt(10.95, {0.5})));        // duplicate
  health.note(report(scanAt(10.96, {0.5, kNaN})));  // one bad sighting
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(11.0), 3, status);
  EXPECT_EQ(valueOf(status, "eye: scan rate [Hz]"), "21.0");
  EXPECT_EQ(valueOf(status, "eye: sightings"), "21");
  EXPECT_EQ(valueOf(status, "eye: age of last sighting [s]"), "0.040");
  EXPECT_EQ(valueOf(status, "tracks confirmed"), "1");
  EXPECT_EQ(valueOf(status, "scans waiting for a transform"), "3");
  EXPECT_EQ(valueOf(status, "scans dropped, duplicate"), "1");
  EXPECT_EQ(valueOf(status, "sightings rejected"), "1");
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::WARN)
      << "something was dropped since the last time";

  diagnostic_updater::DiagnosticStatusWrapper calm;
  health.diagnose(at(12.0), 0, calm);
  EXPECT_EQ(calm.level, diagnostic_msgs::DiagnosticStatus::OK);
  diagnostic_updater::DiagnosticStatusWrapper silent;
  health.diagnose(at(14.0), 0, silent);
  EXPECT_EQ(silent.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(silent.message.find("no scan for"), std::string::npos);
}

TEST_F(TrackerComponent, ASensorThatGoesWrongIsInTheLogAndInTheDiagnosticsUntilItHasRecovered) {
  LocalTrackerHealth health(2.0);
  std::vector<std::string> lines;
  diagnostic_updater::DiagnosticStatusWrapper during, after;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1600; ++i) {
    const double t = 10.0 + 0.01 * i;
    const bool is_bad = i % 4 == 0 && t >= 13.0 && t < 18.0;
    const double azimuth = 0.5 + 1e-3 * (normal(random) + (is_bad ? 4.0 : 0.0));
    const TrackerReport last = report(scanAt(t, {azimuth}, "eye_" + std::to_string(i % 4)));
    health.note(last);
    for (const std::string& line : health.sensorLines(last, at(t))) lines.push_back(line);
    if (i == 700) health.diagnose(at(t), 0, during, component_.sensors());
  }
  health.diagnose(at(26.0), 0, after, component_.sensors());
  ASSERT_GE(lines.size(), 2u);
  EXPECT_NE(lines.front().find("sensor \"eye_0\""), std::string::npos);
  EXPECT_NE(lines.back().find("is as it states again"), std::string::npos);
  EXPECT_NE(valueOf(during, "guard of eye_0").find("not used"), std::string::npos);
  EXPECT_EQ(valueOf(during, "guard of eye_1"), "healthy");
  EXPECT_EQ(during.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(during.message.find("eye_0"), std::string::npos);
  EXPECT_NE(valueOf(after, "guard of eye_0").find("recovered"), std::string::npos);
}

TEST_F(TrackerComponent, ASensorThatIsRougherThanItSaysIsWarnedOfAndOneThatIsCalmerIsSaid) {
  for (const double truth : {0.1, 3.0}) {
    LocalTrackerComponent component(reader_, "my_tracker", transforms_);
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    LocalTrackerHealth health(2.0);
    diagnostic_updater::DiagnosticStatusWrapper status;
    for (int i = 0; i < 1200; ++i) {
      const auto scan = scanAt(10.0 + 0.03 * i, {0.5 + truth * 1e-3 * normal(random)});
      scan->sightings[0].elevation = truth * 1e-3 * normal(random);
      for (const TrackerReport& report : component.onScan(scan, toCore(scan->header.stamp)))
        health.note(report);
    }
    health.diagnose(at(46.0), 0, status, component.sensors(), component.calibratedSensors());
    EXPECT_NEAR(std::stod(valueOf(status, "noise of eye")), truth, 0.4 * truth);
    EXPECT_EQ(status.level == diagnostic_msgs::DiagnosticStatus::WARN, truth > 2.0) << status.message;
  }
}

TEST_F(TrackerComponent, HowTheSensorSeesIsInTheDiagnostics) {
  LocalTrackerComponent component(reader_, "my_tracker", transforms_);
  LocalTrackerHealth health(2.0);
  diagnostic_updater::DiagnosticStatusWrapper status;
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> anywhere(-0.6, 0.6);
  for (int i = 0; i < 1200; ++i) {  // four of five scans show the target, and each a false sighting anywhere
    std::vector<double> azimuths{anywhere(random)};
    if (i % 5 != 0) azimuths.push_back(0.35);
    const auto scan = scanAt(10.0 + 0.03 * i, azimuths);
    for (const TrackerReport& report : component.onScan(scan, toCore(scan->header.stamp)))
      health.note(report);
  }
  health.diagnose(at(46.0), 0, status, component.sensors(), component.calibratedSensors(), component.stamps(),
                  component.detection());
  const std::string words = valueOf(status, "detection of eye");
  EXPECT_NEAR(std::stod(words), 80.0, 3.0) << words;
  const auto comma = words.find(", ");
  ASSERT_NE(words.find(" false sightings a scan"), std::string::npos) << words;
  EXPECT_NEAR(std::stod(words.substr(comma + 2)), 1.0, 0.1) << words;
}

TEST_F(TrackerComponent, AWrongClockIsWarnedOfOnceAndStaysInTheDiagnostics) {
  LocalTrackerHealth health(2.0);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<std::string> lines;
  for (int i = 0; i < 3000; ++i) {
    const double t = 10.0 + 0.01 * i;
    const double seen = t + (i % 3 == 0 ? 0.0603 : 0.0);  // eye_0 stamps 0.06 s too early
    const double azimuth = 0.01 * std::sin(seen) + 1e-3 * normal(random);
    const TrackerReport last = report(scanAt(t, {azimuth}, "eye_" + std::to_string(i % 3)));
    health.note(last);
    if (i % 100 != 0) continue;
    for (const std::string& line : health.clockLines(component_.sensors())) lines.push_back(line);
  }
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("clock of eye_0 is 0.0"), std::string::npos) << lines[0];
  EXPECT_NE(lines[0].find("behind the others'"), std::string::npos) << lines[0];
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(40.0), 0, status, component_.sensors());
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("clock of eye_0"), std::string::npos);
}

TEST_F(TrackerComponent, LatencyAndDropsOfEachSensorAreInTheDiagnostics) {
  LocalTrackerHealth health(2.0);
  const auto deliver = [&](const sightline::SightingArray::Ptr& scan, double latency) {
    const core::Time now = toCore(scan->header.stamp) + core::durationOf(latency);
    health.noteArrival(*scan, now);
    for (const TrackerReport& report : component_.onScan(scan, now)) health.note(report);
  };
  for (int i = 0; i < 100; ++i) {
    deliver(scanAt(10.0 + 0.05 * i, {0.5}, "quick"), i < 90 ? 0.010 : 0.025);
    deliver(scanAt(10.0 + 0.05 * i, {0.5}, "slow"), 0.2);
  }
  deliver(scanAt(14.95, {0.5}, "slow"), 0.2);  // duplicate
  deliver(scanAt(12.0, {0.5}, "slow"), 0.2);   // late
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(15.0), 0, status, {}, {}, component_.stamps());
  EXPECT_EQ(valueOf(status, "latency of quick"), "10.0 ms (median), 25.0 ms (95 %), over the last 100 scans");
  EXPECT_EQ(valueOf(status, "latency of slow"),
            "200.0 ms (median), 200.0 ms (95 %), over the last 102 scans");
  EXPECT_EQ(valueOf(status, "slow: scans dropped, duplicate"), "1");
  EXPECT_EQ(valueOf(status, "slow: scans dropped, late"), "1");
  EXPECT_EQ(valueOf(status, "quick: scans dropped, late"), "(absent)");
}

TEST_F(TrackerComponent, WhatTheDoctorWouldSayOfASensorIsInTheDiagnosticsEveryTenSecondsUntilItIsRight) {
  LocalTrackerHealth health(2.0, {component_.maxLag(), component_.maxFuture()});
  SeenTarget target(1);
  const auto deliver = [&](double from, double latency) {
    for (int i = 0; i < 100; ++i) {
      const double time = from + 0.1 * i;
      health.noteArrival(scanOf("eye", time, {target.at(time)}), at(time + latency));
    }
  };
  diagnostic_updater::DiagnosticStatusWrapper first, wrong, right;
  health.diagnose(at(10.0), 0, first);
  deliver(10.0, 0.9);
  health.diagnose(at(20.0), 0, wrong);
  EXPECT_NE(valueOf(wrong, "input of eye").find("its stamps are 0.9 s behind the clock"), std::string::npos)
      << valueOf(wrong, "input of eye");
  EXPECT_NE(wrong.message.find("eye: its stamps are 0.9 s behind the clock"), std::string::npos);
  deliver(20.0, 0.01);
  health.diagnose(at(30.0), 0, right);
  EXPECT_EQ(valueOf(right, "input of eye"), "(absent)");
}

TEST_F(TrackerComponent, SightingsThatStartTracksInVainAreWarnedOfUntilOneIsConfirmed) {
  LocalTrackerHealth health(2.0);
  const auto note = [&](int k, std::uint8_t status) {  // of a target that is another one at each scan
    const auto id = static_cast<std::uint32_t>(k + 1);
    TrackerReport report;
    report.scan = scanAt(10.0 + k, {0.01 * k});
    report.associations = boost::make_shared<sightline::AssociationArray>();
    report.associations->header.stamp = report.scan->header.stamp;
    report.associations->sensor = "eye";
    report.associations->associations.resize(1);
    report.associations->associations[0].decision = sightline::Association::STARTED_TRACK;
    report.associations->associations[0].track = id;
    report.tracks = boost::make_shared<sightline::TrackArray>();
    report.tracks->header.stamp = report.scan->header.stamp;
    report.tracks->tracks.resize(1);
    sightline::Track& track = report.tracks->tracks[0];
    track.id = id;
    track.status = status;
    track.hits = 1;
    track.azimuth = 0.01 * k;
    track.covariance[0] = track.covariance[5] = 1e-6;
    health.note(report);
  };
  diagnostic_updater::DiagnosticStatusWrapper in_vain, confirmed;
  for (int k = 0; k < 30; ++k) note(k, sightline::Track::TENTATIVE);
  health.diagnose(at(40.0), 0, in_vain);
  EXPECT_EQ(
      valueOf(in_vain, "track starts of eye").find("30 of 30 sightings started a track, none was confirmed"),
      0u)
      << valueOf(in_vain, "track starts of eye");
  EXPECT_EQ(in_vain.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(in_vain.message.find("none was confirmed"), std::string::npos) << in_vain.message;
  note(30, sightline::Track::CONFIRMED);
  health.diagnose(at(41.0), 0, confirmed);
  EXPECT_EQ(valueOf(confirmed, "track starts of eye"), "(absent)");
  EXPECT_EQ(confirmed.level, diagnostic_msgs::DiagnosticStatus::OK) << confirmed.message;
}

TEST_F(TrackerComponent, LatencyIsNotMadeUpWithoutAClock) {
  LocalTrackerHealth health(2.0);
  health.noteArrival(*scanAt(10.0, {}), core::Time{});
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(15.0), 0, status);
  EXPECT_EQ(valueOf(status, "latency of eye"), "(absent)");
}

/// Three sensors of 30 Hz for a second from `from`, the first off by `off` [s]; the clock is of another time.
std::vector<TrackerReport> runThree(LocalTrackerComponent& component, double from, double off) {
  std::vector<TrackerReport> all;
  for (int k = 0; k < 30; ++k) {
    for (const char* name : {"a", "b", "c"}) {
      const double stamp = from + k / 30.0 + (name[0] - 'a') * 0.01 + (name[0] == 'a' ? off : 0.0);
      for (auto& report : component.onScan(scanAt(stamp, {0.5}, name), at(1e6))) all.push_back(report);
    }
  }
  return all;
}

std::string noticesOf(const std::vector<TrackerReport>& reports) {
  std::string notices;
  for (const TrackerReport& report : reports) notices += report.notice;
  return notices;
}

TEST_F(TrackerComponent, ARecordingInALoopIsTrackedAgainFromItsStart) {
  for (int k = 0; k < 5; ++k) runThree(component_, 100.0 + k, 0.0);
  const auto again = runThree(component_, 100.0, 0.0);
  EXPECT_NE(noticesOf(again).find("stamps went back by"), std::string::npos);
  const auto last = runThree(component_, 101.0, 0.0).back();
  ASSERT_TRUE(last.tracks);
  ASSERT_EQ(last.tracks->tracks.size(), 1u);
  EXPECT_EQ(last.tracks->tracks[0].status, sightline::Track::CONFIRMED);
  EXPECT_LT(last.tracks->header.stamp, ros::Time(103.0));
}

TEST_F(TrackerComponent, OneClockThatStepsIsLeftOutSaidAndTakenBackWhileTheOthersTrackOn) {
  for (const double step : {-3600.0, -10.0, -0.7, 0.7, 10.0, 3600.0}) {
    LocalTrackerComponent component(reader_, "my_tracker", transforms_);
    for (int k = 0; k < 3; ++k) runThree(component, 5000.0 + k, 0.0);
    LocalTrackerHealth health(2.0);
    const auto during = runThree(component, 5003.0, step);
    for (const auto& report : during) health.note(report);
    diagnostic_updater::DiagnosticStatusWrapper status;
    health.diagnose(at(5004.0), 0, status, {}, {}, component.stamps());
    EXPECT_NE(noticesOf(during).find("stamps of a are "), std::string::npos) << step;
    EXPECT_NE(valueOf(status, "stamps of a").find(step < 0.0 ? "behind" : "ahead"), std::string::npos)
        << step;
    EXPECT_EQ(valueOf(status, "stamps of b"), "(absent)") << step;
    std::size_t used = 0, accepted = 0;
    for (const auto& report : during) {
      used += report.tracks ? 1 : 0;
      if (report.tracks) accepted += report.tracks->tracks.size();
    }
    EXPECT_GE(used, 60u) << step << ": those of the others";
    EXPECT_EQ(accepted, used) << step << ": one track all the time";
    const auto after = runThree(component, 5004.0, 0.0);
    EXPECT_NE(noticesOf(after).find("stamps of a agree with the others' again"), std::string::npos) << step;
    EXPECT_EQ(after.back().tracks->tracks.at(0).sources.size(), 3u) << step;
  }
}

TEST_F(TrackerComponent, WarningsOfOneKindComeAtMostEveryFiveSeconds) {
  LocalTrackerHealth health(2.0);
  report(scanAt(10.0, {0.5}));
  const auto duplicate = report(scanAt(10.0, {0.5}));
  health.note(duplicate);
  EXPECT_TRUE(health.warningAbout(duplicate, at(100.0)));
  health.note(duplicate);
  EXPECT_FALSE(health.warningAbout(duplicate, at(104.9)));
  health.note(duplicate);
  const auto warning = health.warningAbout(duplicate, at(105.1));
  ASSERT_TRUE(warning);
  EXPECT_NE(warning->find("2 new, 3 in all"), std::string::npos) << *warning;
  EXPECT_FALSE(health.warningAbout(report(scanAt(10.1, {0.5})), at(200.0))) << "nothing to complain of";
}

}  // namespace
