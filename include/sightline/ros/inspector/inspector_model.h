#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <sightline/FusionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/inspector/recent_ring.h"
#include "sightline/ros/inspector/sensor_board.h"
#include "sightline/ros/inspector/sighting_log.h"
#include "sightline/ros/inspector/track_rows.h"

namespace sightline_ros {

/// One sighting of the selected track, for plots.
struct SightingPoint {
  float age = 0.0F;          ///< of its stamp [s]
  float x = 0.0F, y = 0.0F;  ///< innovation, azimuth and elevation [rad]
  float squared = 0.0F;      ///< normalised innovation squared [1]
  std::uint16_t sensor = 0;  ///< of TrackDetail::sensors
  bool is_taken = false;
};

/// The gate of the newest sighting of a sensor: innovation^T S^-1 innovation <= threshold.
struct SensorGate {
  std::uint16_t sensor = 0;
  std::array<float, 3> covariance{};  ///< S: (1, 1), (1, 2), (2, 2) [rad^2]
  float threshold = 0.0F;
};

/// Where a track stood: [rad], of a position [m]; NaN = not known.
struct SpreadPoint {
  float age = 0.0F;    ///< [s]
  float sigma = 0.0F;  ///< largest
  float gate = 0.0F;   ///< larger half width of the gate
};

/// Mean of the normalised innovations squared, of two degrees of freedom each.
struct NisMean {
  std::size_t count = 0;
  double mean = 0.0;             ///< 2 of honest covariances
  double low = 0.0, high = 0.0;  ///< where it lies with 95 % probability, of independent innovations
};

/// All of one track that changes from frame to frame.
struct TrackDetail {
  TrackKey key;
  std::optional<TrackRow> row;  ///< none: there is no such track now
  std::vector<std::string> sensors;
  std::vector<SightingPoint> sightings;  ///< in order of arrival
  std::vector<SensorGate> gates;         ///< one a sensor
  std::vector<SpreadPoint> spread;       ///< in order of arrival
  NisMean nis;                           ///< of those taken
};

/// A sighting taken or refused, in words.
struct SightingLine {
  double age = 0.0;  ///< of its stamp [s]
  std::string sensor, tracker, decision, reason;
  bool is_taken = false;
};

/// Who supports a track, or what it supports.
struct SupportRow {
  std::string tracker;
  std::uint32_t id = 0;
  double weight = 0.0;            ///< in [0, 1]; NaN = not known
  double distance_squared = 0.0;  ///< from the others [1]; NaN = not known
  std::string words;              ///< why it is left out; or of which rule's track it is a part
};

/// What a person inspects: the newest tracks of every topic, and of one chosen track the last minute. It
/// knows neither widgets nor a clock, and one thread uses it at a time. `now` is the time of receipt on ROS's
/// clock: going back by more than a second (a recording that begins again) it forgets all but the choice. A
/// topic whose own stamps go back begins anew by itself.
class InspectorModel {
 public:
  static constexpr double kSpan = 60.0;                ///< of arrival that is kept [s]
  static constexpr std::size_t kMostTopics = 128;      ///< of tracks; of further ones nothing is kept
  static constexpr std::size_t kMostTracks = 5000;     ///< of one message; further ones are not shown
  static constexpr std::size_t kMostSamples = 400000;  ///< of where tracks stood, 13 MB
  static constexpr double kSamplePeriod = 0.2;         ///< between two of one track [s]
  static constexpr double kSilence = 1.5;              ///< from which a topic counts as silent [s]
  static constexpr double kForgotten = 10.0;           ///< from which its tracks are not shown [s]

  InspectorModel() : samples_(kMostSamples, kSpan), selected_samples_(kMostSamples, kSpan) {}

  void take(const std::string& topic, const sightline::TrackArray::ConstPtr& tracks,
            sightline::core::Time now);
  void take(const std::string& topic, const sightline::PositionTrackArray::ConstPtr& tracks,
            sightline::core::Time now);
  void take(const std::string& topic, const sightline::AssociationArray& decisions,
            sightline::core::Time now);
  void take(const std::string& topic, const sightline::FusionReport::ConstPtr& report,
            sightline::core::Time now);
  void take(const diagnostic_msgs::DiagnosticArray& diagnostics, sightline::core::Time now);

  /// The clock goes on while nothing comes.
  void tick(sightline::core::Time now);

  /// While frozen nothing is taken in, so that all can be looked at as it was.
  void freeze(bool is_frozen) { is_frozen_ = is_frozen; }
  bool isFrozen() const { return is_frozen_; }
  sightline::core::Time now() const { return now_; }

  void select(const std::optional<TrackKey>& key);
  const std::optional<TrackKey>& selected() const { return selected_; }

  /// Global tracks first, then positions, then local ones; by topic and id.
  std::vector<TrackRow> rows() const;

  /// Of the selected track; nullopt while none is selected.
  std::optional<TrackDetail> detail() const;

  std::vector<SightingLine> sightings(std::size_t most) const;  ///< of the selected track, the newest first
  std::vector<SupportRow> support() const;                      ///< of the selected track
  std::vector<SensorRow> sensors() const { return board_.rows(now_); }
  const std::deque<VerdictChange>& verdictChanges() const { return board_.changes(); }

  /// What a person should know of the whole: empty, or that there are more topics than are shown.
  std::string notice() const;

 private:
  struct Memo {
    sightline::core::Time first{};   // stamp of the first message with the track
    sightline::core::Time sample{};  // of the last sample
  };
  struct Topic {
    sightline::TrackArray::ConstPtr directions;  // one of the two
    sightline::PositionTrackArray::ConstPtr positions;
    sightline::core::Time arrival{}, stamp{};
    std::string tracker;
    std::map<std::uint32_t, Memo> memos;  // of the tracks of the newest message
  };
  struct Sample {
    sightline::core::Time arrival{}, stamp{};
    std::uint32_t track = 0;
    std::uint16_t topic = 0;
    float sigma = 0.0F, gate = 0.0F;
  };

  bool begin(sightline::core::Time now);
  template <typename Message>
  Topic* renew(const std::string& topic, const Message& tracks, sightline::core::Time now);
  void followSelected();
  bool isOfSelected(const Sample& sample) const;
  std::optional<TrackRow> rowOfTrack(const TrackKey& key) const;
  TrackRow completed(const std::string& name, const Topic& topic, TrackRow row) const;
  const sightline::FusedTrack* fusedTrack(const TrackKey& key) const;
  void addSupported(const TrackRow& local, std::vector<SupportRow>& rows) const;
  std::string topicOfTracker(const std::string& tracker) const;
  std::string trackerOfSpace(const std::string& space) const;
  sightline::core::Time stampNow() const;

  std::map<std::string, Topic> topics_;
  std::map<std::string, sightline::FusionReport::ConstPtr> reports_;  // by namespace
  SightingLog log_;
  RecentRing<Sample> samples_;
  RecentRing<Sample> selected_samples_;  // those of the selected track, again
  NameTable sample_topics_{kMostTopics};
  SensorBoard board_;
  std::optional<TrackKey> selected_;
  sightline::core::Time now_{};
  bool is_frozen_ = false;
  std::size_t topics_left_out_ = 0;
};

}  // namespace sightline_ros
