#include "sightline/ros/inspector/track_rows.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include <Eigen/Eigenvalues>

#include "sightline/core/model/sphere.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/display/display_tracks.h"
#include "sightline/ros/messages/position_messages.h"

namespace sightline_ros {
namespace {

std::string inLowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

template <typename Message>
TrackRow commonRow(const std::string& topic, const Message& message, std::size_t index) {
  const auto& track = message.tracks.at(index);
  TrackRow row;
  row.key = {topic, track.id};
  row.tracker = message.tracker;
  row.status = track.status;
  row.existence = track.existence;
  row.unseen = track.last_sighting.isZero() ? std::numeric_limits<double>::quiet_NaN()
                                            : (message.header.stamp - track.last_sighting).toSec();
  row.sigma = sigmaOfTrack(track);
  row.sources = track.sources;
  row.frame = message.header.frame_id;
  return row;
}

}  // namespace

double sigmaOfTrack(const sightline::Track& track) {
  return sigmaOf(track);
}

double sigmaOfTrack(const sightline::PositionTrack& track) {
  const Eigen::Matrix3d covariance = toCore(track).covariance.topLeftCorner<3, 3>();
  if (!covariance.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(solver.eigenvalues().maxCoeff(), 0.0));
}

TrackRow rowOf(const std::string& topic, const sightline::TrackArray& message, std::size_t index) {
  TrackRow row = commonRow(topic, message, index);
  const sightline::Track& track = message.tracks[index];
  row.place = sightline::core::directionOf({track.azimuth, track.elevation});
  return row;
}

TrackRow rowOf(const std::string& topic, const sightline::PositionTrackArray& message, std::size_t index) {
  TrackRow row = commonRow(topic, message, index);
  const auto& position = message.tracks[index].position;
  row.kind = TrackKind::position;
  row.place = {position.x, position.y, position.z};
  return row;
}

std::string wordOf(TrackKind kind) {
  switch (kind) {
    case TrackKind::global:
      return "global";
    case TrackKind::position:
      return "position";
    case TrackKind::local:
      break;
  }
  return "local";
}

std::string statusWord(std::uint8_t status) {
  switch (status) {
    case sightline::Track::TENTATIVE:
      return "tentative";
    case sightline::Track::CONFIRMED:
      return "confirmed";
    case sightline::Track::COASTING:
      return "coasting";
    default:
      return "status " + std::to_string(status);
  }
}

std::string sigmaText(double sigma, TrackKind kind) {
  if (!std::isfinite(sigma)) return "-";
  return kind == TrackKind::position ? sightline::report::valueOf(sigma, "m")
                                     : sightline::report::valueOf(1e3 * sigma, "mrad");
}

std::string stateText(const TrackRow& row) {
  if (!(row.silence > 0.0)) return statusWord(row.status);
  std::ostringstream text;
  text.precision(1);
  text << "silent " << std::fixed << row.silence << " s";
  return text.str();
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

bool matches(const TrackRow& row, const std::string& filter) {
  const std::string text =
      inLowerCase(wordOf(row.kind) + ' ' + row.tracker + ' ' + std::to_string(row.key.id) + ' ' +
                  stateText(row) + ' ' + joined(row.sources));
  std::istringstream words(inLowerCase(filter));
  for (std::string word; words >> word;) {
    if (text.find(word) == std::string::npos) return false;
  }
  return true;
}

}  // namespace sightline_ros
