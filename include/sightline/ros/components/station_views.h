#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/field_of_view.h"
#include "sightline/core/model/refusal.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// What the sensors of each station look at, as the parameter `fields_of_view` of a position tracker says.
class StationViews {
 public:
  /// Reads the list at this level. Throws ParamError.
  explicit StationViews(const ParamReader& reader);

  /// Whether the fields of view of a local tracker can be told at a stamp, or will not become known by
  /// waiting: of a frame that tf does not know at all.
  bool areSettled(const std::string& tracker, const std_msgs::Header& header, const std::string& metric_frame,
                  const tf2::BufferCore& transforms) const;

  /// The fields of view of one tracker at a stamp.
  struct Found {
    std::vector<sightline::core::FieldOfView> views;  ///< in the metric frame; empty where one is not known
    std::vector<sightline::core::Refusal> refusals;   ///< of fields that are not known at that stamp
  };

  /// `header` of the tracker's tracks, whose frame is that of a field which names none.
  Found at(const std::string& tracker, const std_msgs::Header& header, const std::string& metric_frame,
           const tf2::BufferCore& transforms) const;

 private:
  struct View {
    std::string frame;  // of the sensor; empty = that of the tracker's tracks
    Eigen::Vector2d half_widths = Eigen::Vector2d::Zero();
  };

  static const std::string& frameOf(const View& view, const std_msgs::Header& header);

  std::map<std::string, std::vector<View>> views_;  // by tracker
};

}  // namespace sightline_ros
