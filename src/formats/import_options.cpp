#include "sightline/formats/import_options.h"

#include <cmath>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {

std::optional<std::pair<std::string, Station>> stationOption(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const std::string name = equals == std::string::npos ? "" : std::string(trimmed(text.substr(0, equals)));
  if (equals != std::string::npos && name.empty()) return std::nullopt;
  const auto parts = fieldsOf(equals == std::string::npos ? text : text.substr(equals + 1), ',');
  if (parts.size() != 3) return std::nullopt;
  const auto latitude = report::numberFrom(parts[0]), longitude = report::numberFrom(parts[1]),
             height = report::numberFrom(parts[2]);
  if (!latitude || !longitude || !height) return std::nullopt;
  if (std::abs(*latitude) > 90.0 || std::abs(*longitude) > 360.0 || *height < -1e4 || *height > 1e5)
    return std::nullopt;
  return std::make_pair(name, Station{*latitude * core::kDegree, *longitude * core::kDegree, *height});
}

std::optional<Eigen::Vector2d> anglePairOption(const std::string& text) {
  const auto parts = fieldsOf(text, ',');
  if (parts.empty() || parts.size() > 2) return std::nullopt;
  const auto first = angleWithUnit(parts.front()), second = angleWithUnit(parts.back());
  if (!first || !second) return std::nullopt;
  return Eigen::Vector2d(*first, *second);
}

std::optional<Eigen::Vector2d> imageSizeOption(const std::string& text) {
  const auto parts = fieldsOf(text, 'x');
  if (parts.size() != 2) return std::nullopt;
  const auto width = report::numberFrom(parts[0]), height = report::numberFrom(parts[1]);
  if (!width || !height || !(*width >= 1.0) || !(*height >= 1.0) || *width > 1e6 || *height > 1e6)
    return std::nullopt;
  return Eigen::Vector2d(*width, *height);
}

}  // namespace sightline::formats
