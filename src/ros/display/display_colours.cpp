#include "sightline/ros/display/display_colours.h"

#include <array>
#include <cstdint>

namespace sightline_ros {
namespace {

Colour rgb(int red, int green, int blue) {
  Colour colour;
  colour.r = static_cast<float>(red) / 255.0F;
  colour.g = static_cast<float>(green) / 255.0F;
  colour.b = static_cast<float>(blue) / 255.0F;
  colour.a = 1.0F;
  return colour;
}

const std::array<Colour, 8>& palette() {
  static const std::array<Colour, 8> colours = {
      rgb(230, 159, 0),    // orange
      rgb(213, 94, 0),     // vermillion
      rgb(240, 228, 66),   // yellow
      rgb(86, 180, 233),   // sky blue
      rgb(0, 158, 115),    // green
      rgb(204, 121, 167),  // pink
      rgb(150, 110, 60),   // brown
      rgb(90, 120, 210),   // blue
  };
  return colours;
}

/// FNV-1a: unlike std::hash the same on every machine, so that a sensor keeps its colour.
std::uint32_t hashOf(const std::string& name) {
  std::uint32_t hash = 2166136261U;
  for (const char letter : name) hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
  return hash;
}

}  // namespace

Colour withAlpha(Colour colour, double alpha) {
  colour.a = static_cast<float>(alpha);
  return colour;
}

Colour dimmed(const Colour& colour, double share) {
  const auto part = static_cast<float>(share);
  const Colour background = backgroundColour();
  Colour mixed;
  mixed.r = part * colour.r + (1.0F - part) * background.r;
  mixed.g = part * colour.g + (1.0F - part) * background.g;
  mixed.b = part * colour.b + (1.0F - part) * background.b;
  mixed.a = 1.0F;
  return mixed;
}

Colour backgroundColour() {
  return rgb(16, 20, 28);
}

Colour colourOf(GateOutcome outcome) {
  switch (outcome) {
    case GateOutcome::accepted:
      return rgb(0, 200, 140);
    case GateOutcome::claimed_by_other:
      return rgb(230, 60, 40);
    case GateOutcome::tentative:
      return rgb(240, 228, 66);
    case GateOutcome::nothing_seen:
      break;
  }
  return rgb(150, 150, 160);
}

Colour mainColour() {
  return rgb(255, 255, 255);
}

Colour truthColour() {
  return rgb(185, 150, 255);
}

Colour gridColour() {
  return rgb(110, 120, 135);
}

SensorColours::SensorColours(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    colours_.emplace(name, palette()[colours_.size() % palette().size()]);
  }
}

Colour SensorColours::of(const std::string& name) const {
  const auto known = colours_.find(name);
  return known != colours_.end() ? known->second : palette()[hashOf(name) % palette().size()];
}

}  // namespace sightline_ros
