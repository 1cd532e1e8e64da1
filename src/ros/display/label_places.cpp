#include "sightline/ros/display/label_places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/display/sphere_shapes.h"

namespace sightline_ros {
namespace {

constexpr double kLetterWidth = 0.55;  // over its height
constexpr double kLinePitch = 1.2;     // likewise

}  // namespace

Eigen::Vector2d labelSize(const std::string& text, double height) {
  std::size_t longest = 0, lines = 1, length = 0;
  for (const char letter : text) {
    length = letter == '\n' ? 0 : length + 1;
    lines += letter == '\n' ? 1 : 0;
    longest = std::max(longest, length);
  }
  return height * Eigen::Vector2d(kLetterWidth * static_cast<double>(longest),
                                  kLinePitch * static_cast<double>(lines));
}

void LabelPlaces::block(const Eigen::Vector2d& centre, double radius) {
  boxes_.push_back({centre, Eigen::Vector2d::Constant(2.0 * radius)});
}

bool LabelPlaces::take(const Eigen::Vector3d& centre, const Eigen::Vector2d& size) {
  const bool is_free = std::none_of(boxes_.begin(), boxes_.end(), [&](const Box& box) {
    const bool is_ahead = sightline::core::directionOf(box.centre).dot(centre) > 0.0;
    const Eigen::Vector2d apart = tangentTo(box.centre, centre).cwiseAbs();
    return is_ahead && (apart.array() < 0.5 * (size + box.size).array()).all();
  });
  if (is_free) boxes_.push_back({sightline::core::anglesOf(centre), size});
  return is_free;
}

}  // namespace sightline_ros
