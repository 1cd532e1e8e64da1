#pragma once

#include <QString>
#include <cmath>
#include <string>

namespace sightline_rviz {

inline QString text(const std::string& words) {
  return QString::fromStdString(words);
}

/// "-" for what is not finite.
inline QString number(double value, int decimals) {
  return std::isfinite(value) ? QString::number(value, 'f', decimals) : QString("-");
}

}  // namespace sightline_rviz
