#pragma once

#include <QColor>
#include <string>

#include "sightline/ros/display/display_colours.h"

/// Colours of the panel: dark as the pictures of the displays beside it.
namespace sightline_rviz::palette {

constexpr QRgb kGround = 0xff22272f;
constexpr QRgb kPlotGround = 0xff10141c;  ///< that of the displays
constexpr QRgb kGrid = 0xff2b333f;
constexpr QRgb kBand = 0xff1b3a33;
constexpr QRgb kText = 0xffe6e8ec;
constexpr QRgb kFaintText = 0xff98a0ac;
constexpr QRgb kGood = 0xff00c88c;
constexpr QRgb kBad = 0xffff5a46;
constexpr QRgb kDoubtful = 0xfff0e442;

inline QRgb rgbOf(const sightline_ros::Colour& colour) {
  return QColor::fromRgbF(colour.r, colour.g, colour.b).rgb();
}

}  // namespace sightline_rviz::palette
