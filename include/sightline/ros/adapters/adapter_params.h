#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/imaging/laser_spots.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// A number in a message's fields: value = scale * field + offset.
struct Quantity {
  std::string field;     ///< name or path; empty = not in the message, the value is `offset`
  double scale = 1.0;    ///< sign and unit: rad, m or px in one unit of the field
  double offset = 0.0;   ///< [rad], [m] or [px]
  std::string sigma;     ///< field with its standard deviation, in the field's unit; empty = there is none
  std::string variance;  ///< field with its variance, in the square of that unit; empty = there is none
};

/// Which fields make a sighting.
struct FieldMap {
  enum class Form { angles, point, pixel, corners };

  Form form = Form::point;
  std::vector<Quantity> axes;  ///< (azimuth, elevation), (x, y, z), (u, v) or (xmin, xmax, ymin, ymax)
  std::string snr;             ///< field; empty = there is none
  bool snr_in_db = false;      ///< 20 log10 of the amplitude ratio, not the ratio itself
  std::string each;    ///< path of the array with an element for each sighting; empty = the message is one
  std::string header;  ///< path of the message's std_msgs/Header; empty = it has none
};

/// How a topic of a driver is read, and as which sensor's sightings it is published.
struct AdapterTopic {
  enum class Kind {
    direction,  ///< Vector3Stamped
    point,      ///< PointStamped, metric
    pixel,      ///< PointStamped, pixel coordinates
    pose,
    poses,
    pose_with_covariance,
    odometry,
    box,     ///< RegionOfInterest
    cloud,   ///< PointCloud2
    laser,   ///< LaserScan
    fields,  ///< any other message, by field paths
  };

  Kind kind = Kind::direction;
  std::string topic, type, sensor;
  std::string output;             ///< topic of the sightings
  std::string frame;              ///< instead of the message's frame_id; empty = the message's
  bool is_optical = false;        ///< the frame has z forward, x right: sightings go out in <frame>_boresight
  bool stamp_on_arrival = false;  ///< instead of the message's stamp
  double stamp_offset = 0.0;      ///< added to the stamp [s]

  /// Standard deviations where the message's covariance cannot be used: as arcs along azimuth and elevation
  /// [rad], or of pixel coordinates [px].
  std::optional<Eigen::Vector2d> sigma, sigma_px;

  std::string camera_info;  ///< topic; empty = not a camera
  bool is_rectified = false;

  /// A vector (0, 0, 0), or a box of four zeros, is an unused slot: nothing is there. Else it is refused.
  bool zero_is_nothing = false;

  double ifov = std::numeric_limits<double>::quiet_NaN();
  double detection_probability = std::numeric_limits<double>::quiet_NaN();
  double clutter_density = std::numeric_limits<double>::quiet_NaN();
  int max_sightings = 1000;  ///< a message with more is refused, >= 1

  FieldMap fields;                         ///< of clouds and messages read by field paths
  sightline::core::LaserSpotParams laser;  ///< of laser scans
};

/// The list `topics` of this level, strictly. Throws ParamError.
std::vector<AdapterTopic> loadAdapterTopics(const ParamReader& reader);

}  // namespace sightline_ros
