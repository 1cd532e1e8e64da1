#pragma once

#include <string>

#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>

#include "sightline/ros/outputs/output_tracks.h"

/// Tracks as one line of JSON, without its end: topic, stamp [s] (nine digits after the point), frame,
/// tracker and the chosen tracks, whose fields are named as in the messages; a status is a word. Radians,
/// metres, seconds. A number that is not finite is null; bytes that are no UTF-8 are shown as U+FFFD.
namespace sightline_ros {

std::string jsonOf(const sightline::TrackArray& message, const std::string& topic,
                   const OutputChoice& choice);
std::string jsonOf(const sightline::PositionTrackArray& message, const std::string& topic,
                   const OutputChoice& choice);

/// A text in quotes.
std::string jsonText(const std::string& text);

}  // namespace sightline_ros
