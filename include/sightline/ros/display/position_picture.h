#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <sightline/PositionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>

#include "sightline/core/positions/position_scene.h"
#include "sightline/core/simulation/station.h"
#include "sightline/ros/display/display_colours.h"
#include "sightline/ros/display/position_shapes.h"

namespace sightline_ros {

/// How much is drawn. Times are of receipt, except for `history`, which is of stamps.
struct PositionPictureParams {
  std::string frame = "world";  ///< metric
  double size = 0.0;            ///< of the scene [m]; 0 = the largest distance of two stations
  double sighting_time = 0.3;   ///< a sighting is shown for so long [s]
  double history = 4.0;         ///< of positions and truth that is drawn as a trail [s]
  double prediction = 1.0;      ///< of its motion that a position's arrow is long [s]
  double silence = 1.5;         ///< after which the things of a silent topic vanish [s]
  ros::Duration lifetime{1.0};  ///< after which a marker that is not repeated vanishes
};

/// Messages in, markers out: stations with their fields of view and sightings, the rays of their local
/// tracks, positions with ellipsoid, trail and velocity, and the crossings that are refused. Things are drawn
/// in channels, so that each can be switched off. `now` is the time of receipt [s]; when it goes back by more
/// than a second, all is forgotten. What is kept is bounded.
class PositionPicture {
 public:
  static constexpr const char* kStations = "stations";
  static constexpr const char* kRays = "rays";
  static constexpr const char* kPositions = "positions";
  static constexpr const char* kRefused = "refused_crossings";
  static constexpr const char* kTruth = "true_positions";

  PositionPicture(const PositionPictureParams& params, const SensorColours& colours);

  /// Where the sensors stand now.
  void setStations(std::vector<StationView> stations) { stations_ = std::move(stations); }

  /// What hides targets from stations, where that is known.
  void setObstacles(std::vector<sightline::core::Obstacle> obstacles) { obstacles_ = std::move(obstacles); }

  /// Directions (unit vectors, metric frame) that a sensor at `origin` [m] saw.
  void addSightings(const std::string& sensor, const Eigen::Vector3d& origin,
                    const std::vector<Eigen::Vector3d>& directions, double now);

  /// Tracks of a local tracker, whose station is at `pose`.
  void addTracks(const sightline::TrackArray& tracks, const sightline::core::StationPose& pose, double now);

  void addPositions(const sightline::PositionTrackArray& positions, double now);
  void addReport(const sightline::PositionReport& report, double now);
  void addTruth(const sightline::PositionTrackArray& truth, double now);

  /// Markers by channel; every channel at every call.
  std::map<std::string, MarkerArray> draw(double now);

  /// The size of the scene [m], and its middle on the ground between the stations.
  double size() const;
  Eigen::Vector3d middle() const;

 private:
  struct Seen {
    Eigen::Vector3d place;
    std::string sensor;
    double arrival;
  };
  struct Ray {
    std::uint32_t id = 0;
    bool is_established = false;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  };
  struct Station {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    std::vector<Ray> rays;
    double arrival = 0.0;
  };
  struct Trail {
    std::deque<std::pair<double, Eigen::Vector3d>> samples;  // stamp [s] and place [m]
  };
  struct Reported {
    sightline::PositionTrackArray newest;
    double arrival = 0.0;
    std::map<std::uint32_t, Trail> trails;

    void add(const sightline::PositionTrackArray& report, double history, double now);
    void clear();
    std::vector<Eigen::Vector3d> pathOf(std::uint32_t id) const;
  };

  MetricCanvas canvas() const;
  std::map<std::string, Eigen::Vector3d> places() const;
  void restartWhenBack(double now);
  void forget(double now);
  void drawStations(MarkerArray& array, double now) const;
  void drawRays(MarkerArray& array) const;
  void drawPositions(MarkerArray& array);
  void drawRefused(MarkerArray& array) const;
  void drawTruth(MarkerArray& array) const;
  std::string labelOf(const sightline::PositionTrack& track) const;

  PositionPictureParams params_;
  SensorColours colours_;
  std::vector<StationView> stations_;
  std::vector<sightline::core::Obstacle> obstacles_;
  std::deque<Seen> seen_;
  std::map<std::string, Station> trackers_;
  std::map<std::string, Eigen::Vector3d> places_;  // of the trackers' stations, also of silent ones [m]
  Reported positions_, truth_;
  std::optional<sightline::PositionReport> report_;
  double report_arrival_ = 0.0;
  double newest_ = 0.0;
  double enlargement_ = 0.0;  // of the ellipsoids
};

}  // namespace sightline_ros
