#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace sightline_ros {

/// How wide and high a label of that height of its letters is, roughly [rad].
Eigen::Vector2d labelSize(const std::string& text, double height);

/// Places on the sphere for labels that do not lie over each other, in one picture. Text stands upright, so
/// that a label is a box along azimuth and elevation round its centre.
class LabelPlaces {
 public:
  /// No label may touch a disc: `centre` (azimuth, elevation) [rad].
  void block(const Eigen::Vector2d& centre, double radius);

  /// Takes the place for a label of that size if it is free; returns whether it was.
  bool take(const Eigen::Vector3d& centre, const Eigen::Vector2d& size);

 private:
  struct Box {
    Eigen::Vector2d centre, size;
  };
  std::vector<Box> boxes_;
};

}  // namespace sightline_ros
