#include "sightline/ros/outputs/track_json.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "sightline/ros/params/param_text.h"

namespace sightline_ros {
namespace {

const std::array<const char*, 3> kStatusWords{"tentative", "confirmed", "coasting"};

/// Bytes of the UTF-8 character at the beginning of a text; 0 when there is none.
std::size_t characterLength(std::string_view text) {
  const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const bool is_overlong = (lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xF0 && byte(1) < 0x90);
  const bool is_no_character = (lead == 0xED && byte(1) >= 0xA0) || (lead == 0xF4 && byte(1) >= 0x90);
  return is_overlong || is_no_character ? 0 : length;
}

std::string jsonNumber(double value) {
  return std::isfinite(value) ? shortestText(value) : "null";
}

/// Of a whole number.
std::string jsonNumber(std::uint32_t value) {
  return std::to_string(value);
}

std::string jsonTime(const ros::Time& time) {
  char text[32];
  std::snprintf(text, sizeof text, "%u.%09u", time.sec, time.nsec);
  return text;
}

template <typename Values, typename Text>
std::string jsonList(const Values& values, Text textOfValue) {
  std::string list;
  for (const auto& value : values) list += (list.empty() ? "" : ", ") + textOfValue(value);
  return "[" + list + "]";
}

template <typename Values>
std::string jsonNumbers(const Values& values) {
  return jsonList(values, [](double value) { return jsonNumber(value); });
}

template <typename Vector>
std::string jsonVector(const Vector& vector) {
  return jsonNumbers(std::array<double, 3>{vector.x, vector.y, vector.z});
}

std::string field(const char* name, const std::string& value) {
  return '"' + std::string(name) + "\": " + value;
}

template <typename Track>
std::string identityOf(const Track& track) {
  const bool has_word = track.status < kStatusWords.size();
  return field("id", jsonNumber(track.id)) + ", " +
         field("status",
               has_word ? jsonText(kStatusWords[track.status]) : jsonNumber(std::uint32_t{track.status}));
}

template <typename Track>
std::string supportOf(const Track& track) {
  return field("covariance", jsonNumbers(track.covariance)) + ", " +
         field("existence", jsonNumber(track.existence)) + ", " +
         field("last_sighting", jsonTime(track.last_sighting)) + ", " +
         field("sources", jsonList(track.sources, jsonText));
}

std::string objectOf(const sightline::Track& track) {
  return "{" + identityOf(track) + ", " + field("azimuth", jsonNumber(track.azimuth)) + ", " +
         field("elevation", jsonNumber(track.elevation)) + ", " +
         field("azimuth_rate", jsonNumber(track.azimuth_rate)) + ", " +
         field("elevation_rate", jsonNumber(track.elevation_rate)) + ", " +
         field("hits", jsonNumber(track.hits)) + ", " + field("misses", jsonNumber(track.misses)) + ", " +
         supportOf(track) + "}";
}

std::string objectOf(const sightline::PositionTrack& track) {
  return "{" + identityOf(track) + ", " + field("position", jsonVector(track.position)) + ", " +
         field("velocity", jsonVector(track.velocity)) + ", " +
         field("parallax", jsonNumber(track.parallax)) + ", " + supportOf(track) + "}";
}

template <typename Message>
std::string lineOf(const Message& message, const std::string& topic, const OutputChoice& choice) {
  std::string tracks;
  for (const auto& track : message.tracks) {
    if (isChosen(track.status, choice)) tracks += (tracks.empty() ? "" : ", ") + objectOf(track);
  }
  return "{" + field("topic", jsonText(topic)) + ", " + field("stamp", jsonTime(message.header.stamp)) +
         ", " + field("frame", jsonText(message.header.frame_id)) + ", " +
         field("tracker", jsonText(message.tracker)) + ", " + field("tracks", "[" + tracks + "]") + "}";
}

}  // namespace

std::string jsonText(const std::string& text) {
  std::string json = "\"";
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t length = characterLength(rest);
    const char letter = rest.front();
    if (length == 0) {
      json += "\xEF\xBF\xBD";
    } else if (letter == '"' || letter == '\\') {
      json += std::string("\\") + letter;
    } else if (static_cast<unsigned char>(letter) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(letter));
      json += code;
    } else {
      json += rest.substr(0, length);
    }
    rest.remove_prefix(length == 0 ? 1 : length);
  }
  return json + '"';
}

std::string jsonOf(const sightline::TrackArray& message, const std::string& topic,
                   const OutputChoice& choice) {
  return lineOf(message, topic, choice);
}

std::string jsonOf(const sightline::PositionTrackArray& message, const std::string& topic,
                   const OutputChoice& choice) {
  return lineOf(message, topic, choice);
}

}  // namespace sightline_ros
