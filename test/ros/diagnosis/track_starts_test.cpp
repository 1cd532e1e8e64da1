#include "sightline/ros/diagnosis/track_starts.h"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace {

using sightline_ros::Finding;
using sightline_ros::TrackStarts;

constexpr double kFirstScan = 1000.0;  // [s]

sightline::AssociationArray decided(const std::string& sensor, double time, std::uint8_t decision,
                                    std::uint32_t track) {
  sightline::AssociationArray message;
  message.header.stamp = ros::Time(time);
  message.sensor = sensor;
  message.associations.resize(1);
  message.associations[0].decision = decision;
  message.associations[0].track = track;
  return message;
}

sightline::TrackArray tracked(double time, std::uint32_t id, std::uint8_t status, double azimuth,
                              double sigma) {
  sightline::TrackArray message;
  message.header.stamp = ros::Time(time);
  message.tracks.resize(1);
  sightline::Track& track = message.tracks[0];
  track.id = id;
  track.status = status;
  track.azimuth = azimuth;
  track.elevation = 0.3;
  track.hits = 1;
  track.covariance[0] = track.covariance[5] = sigma * sigma;
  return message;
}

/// Every sighting starts a track, which is gone at the next one.
template <typename AzimuthAt>
void startInVain(TrackStarts& starts, int count, double interval, double sigma, const AzimuthAt& azimuthAt,
                 std::uint32_t first_id = 1) {
  for (int k = 0; k < count; ++k) {
    const double time = kFirstScan + interval * k;
    const std::uint32_t id = first_id + static_cast<std::uint32_t>(k);
    starts.take(decided("cam", time, sightline::Association::STARTED_TRACK, id));
    starts.take(tracked(time, id, sightline::Track::TENTATIVE, azimuthAt(k), sigma));
  }
}

Finding foundOf(const TrackStarts& starts) {
  const auto findings = starts.findings();
  const auto found = findings.find("cam");
  return found == findings.end() || !found->second ? Finding() : *found->second;
}

TEST(TrackStarts, OfATargetThatIsNeverConfirmedAreWrongWithIntervalSigmaAndDistance) {
  TrackStarts starts;
  startInVain(starts, 60, 10.0, 3e-4, [](int k) { return 0.1 + 0.01 * k; });
  const Finding found = foundOf(starts);
  EXPECT_FALSE(found.is_note);
  EXPECT_EQ(
      found.words.find("60 of 60 sightings started a track, none was confirmed: they come every 10 s, state "
                       "a sigma of 0.0003 rad and lie 0.00955 rad apart, as those of a target"),
      0u)
      << found.words;
}

TEST(TrackStarts, OfFalseSightingsAreANote) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> azimuth(-1.0, 1.0);
  TrackStarts starts;
  startInVain(starts, 60, 0.1, 1e-3, [&](int) { return azimuth(random); });
  EXPECT_TRUE(foundOf(starts).is_note);
  EXPECT_NE(foundOf(starts).words.find("as false sightings do"), std::string::npos) << foundOf(starts).words;
}

TEST(TrackStarts, WhoseSigmaIsAThousandTimesTooSmallSaySo) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1e-3);
  TrackStarts starts;
  startInVain(starts, 60, 0.1, 1e-6, [&](int k) { return 0.1 + 0.002 * k + noise(random); });
  const Finding found = foundOf(starts);
  EXPECT_FALSE(found.is_note);
  const std::size_t place = found.words.find(" rad, ", found.words.find("scattered by"));
  ASSERT_NE(place, std::string::npos) << found.words;
  const double times = std::stod(found.words.substr(place + 6));
  EXPECT_GT(times, 400.0) << found.words;
  EXPECT_LT(times, 1500.0) << found.words;
}

TEST(TrackStarts, AreForgottenOnceAConfirmedTrackTakesASighting) {
  TrackStarts starts;
  startInVain(starts, 20, 1.0, 1e-3, [](int k) { return 0.01 * k; });
  EXPECT_NE(foundOf(starts).words, "");
  starts.take(tracked(kFirstScan + 30.0, 7000, sightline::Track::CONFIRMED, 0.1, 1e-3));
  starts.take(decided("cam", kFirstScan + 31.0, sightline::Association::ACCEPTED, 7000));
  EXPECT_EQ(foundOf(starts).words, "");
}

TEST(TrackStarts, OfFalseSightingsAreNoNewsOnceATargetHasBeenTracked) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> azimuth(-1.0, 1.0);
  TrackStarts starts;
  starts.take(tracked(kFirstScan - 1.0, 7000, sightline::Track::CONFIRMED, 0.1, 1e-3));
  starts.take(decided("cam", kFirstScan - 1.0, sightline::Association::ACCEPTED, 7000));
  startInVain(starts, 60, 0.1, 1e-3, [&](int) { return azimuth(random); });
  EXPECT_EQ(foundOf(starts).words, "");
}

TEST(TrackStarts, AreTheSameWhenTracksComeBeforeTheirAssociations) {
  TrackStarts starts;
  for (std::uint32_t id = 1; id <= 60; ++id) {
    const double time = kFirstScan + 10.0 * id;
    starts.take(tracked(time, id, sightline::Track::TENTATIVE, 0.01 * id, 3e-4));
    starts.take(decided("cam", time, sightline::Association::STARTED_TRACK, id));
  }
  EXPECT_EQ(foundOf(starts).words.find(
                "60 of 60 sightings started a track, none was confirmed: they come every 10 s"),
            0u)
      << foundOf(starts).words;
}

TEST(TrackStarts, OfWhichOneIsConfirmedAreFine) {
  TrackStarts starts;
  startInVain(starts, 20, 1.0, 1e-3, [](int k) { return 0.01 * k; });
  starts.take(tracked(kFirstScan + 19.0, 20, sightline::Track::CONFIRMED, 0.1, 1e-3));
  EXPECT_EQ(foundOf(starts).words, "");
}

TEST(TrackStarts, AreJudgedWhenThereAreSomeOnly) {
  TrackStarts starts;
  startInVain(starts, 7, 1.0, 1e-3, [](int k) { return 0.01 * k; });
  EXPECT_EQ(foundOf(starts).words, "");
  startInVain(
      starts, 1, 1.0, 1e-3, [](int k) { return 0.01 * k; }, 100);
  EXPECT_NE(foundOf(starts).words, "");
}

}  // namespace
