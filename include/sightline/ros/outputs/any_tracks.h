#pragma once

#include <optional>
#include <string>
#include <topic_tools/shape_shifter.h>

#include <ros/message_traits.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/refusal.h"

namespace sightline_ros {

template <typename Message>
bool isMessage(const topic_tools::ShapeShifter& any) {
  return any.getDataType() == ros::message_traits::datatype<Message>() &&
         any.getMD5Sum() == ros::message_traits::md5sum<Message>();
}

/// Gives a message of unknown type to `take` as the TrackArray or PositionTrackArray that it is. A message of
/// any other type is refused.
template <typename Take>
std::optional<sightline::core::Refusal> takeTracks(const topic_tools::ShapeShifter& any,
                                                   const std::string& topic, Take take) {
  if (isMessage<sightline::TrackArray>(any)) {
    take(*any.instantiate<sightline::TrackArray>());
  } else if (isMessage<sightline::PositionTrackArray>(any)) {
    take(*any.instantiate<sightline::PositionTrackArray>());
  } else {
    return sightline::core::Refusal{
        "type", topic + " carries " + any.getDataType() + " (" + any.getMD5Sum() +
                    "), expected sightline/TrackArray or sightline/PositionTrackArray of this version"};
  }
  return std::nullopt;
}

}  // namespace sightline_ros
