#pragma once

#include <map>
#include <string>
#include <vector>

#include <std_msgs/ColorRGBA.h>

/// Colours of the display, chosen for a dark background and told apart with any common colour blindness
/// (after Okabe and Ito). Components in [0, 1], not premultiplied.
namespace sightline_ros {

using Colour = std_msgs::ColorRGBA;

/// The colour with another opacity (0 = not seen, 1 = opaque). Only for dots, patches and text: rviz draws
/// the vertices of lines opaque.
Colour withAlpha(Colour colour, double alpha);

/// A share of the colour (1 = all) mixed into the background, opaque: for lines.
Colour dimmed(const Colour& colour, double share);

Colour backgroundColour();  ///< of the shipped displays

/// What happened in a gate since its track's last report.
enum class GateOutcome { accepted, nothing_seen, claimed_by_other, tentative };

Colour colourOf(GateOutcome outcome);
Colour mainColour();   ///< of the fused track: white
Colour truthColour();  ///< of the truth
Colour gridColour();   ///< of the sphere's lines

/// One colour for each sensor or tracker, by name. Names given at construction take the palette in their
/// order (warm colours first, then cool ones); another name always takes the same one, by its hash.
class SensorColours {
 public:
  explicit SensorColours(const std::vector<std::string>& names = {});

  Colour of(const std::string& name) const;

 private:
  std::map<std::string, Colour> colours_;
};

}  // namespace sightline_ros
