#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

#include <Eigen/Core>

#include "sightline/core/model/time.h"
#include "sightline/formats/geodesy.h"

namespace sightline::formats {

/// What files do not say, and their readers must be told.
struct ImportOptions {
  std::string format;  ///< name of a format; empty = found by content
  std::string sensor;  ///< name of the sensor where the file has none
  std::optional<Eigen::Vector2d>
      sigma;  ///< along azimuth and elevation, as arcs [rad], where the file has none
  std::optional<double> sigma_pixels;  ///< the same in pixels, for files of images
  std::optional<double> elevation;     ///< of all sightings, where the file has azimuths alone [rad]
  std::optional<double> heading;  ///< compass azimuth of the sensor's x axis, where the file has none [rad]
  std::map<std::string, Station> stations;       ///< by sensor; "" = every sensor without one
  std::string columns;                           ///< of a CSV file: WHAT=COLUMN[:UNIT[:CONVENTION]],...
  char separator = 0;                            ///< of a CSV file; 0 = found by content
  std::optional<bool> decimal_comma;             ///< of a CSV file; not given = found by content
  std::string camera;                            ///< file of a camera's calibration (camera_info YAML)
  std::optional<Eigen::Vector2d> field_of_view;  ///< of an undistorted image, across and down [rad]
  std::optional<Eigen::Vector2d> image_size;     ///< [pixels]
  std::optional<double> frame_rate;              ///< of files that count frames [1/s]
  std::optional<double> least_confidence;  ///< detections below it are left out, in the file's own measure
  std::optional<double> ut1_minus_utc;     ///< of the day, for right ascensions [s]; 0 where not given
  core::Duration offset{};                 ///< added to all times
  bool for_truth = false;                  ///< the file is a truth: nothing needs a sigma
};

/// NAME=LAT,LON,HEIGHT or LAT,LON,HEIGHT (degrees, degrees, metres) of the option --station; the name is ""
/// in the second case. nullopt when it is neither.
std::optional<std::pair<std::string, Station>> stationOption(const std::string& text);

/// One angle with unit for both axes, or two with a comma between them: "0.05deg", "3deg,20deg" [rad].
std::optional<Eigen::Vector2d> anglePairOption(const std::string& text);

/// "1920x1080" [pixels].
std::optional<Eigen::Vector2d> imageSizeOption(const std::string& text);

}  // namespace sightline::formats
