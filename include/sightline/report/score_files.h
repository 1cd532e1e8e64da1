#pragma once

#include <fstream>
#include <string>

#include "sightline/core/evaluation/scores.h"

namespace sightline_ros {

/// Writes what an evaluation compared, for plotting: in a folder, made when it is not there,
///   errors.csv   topic,name,time,target,track,azimuth,elevation,truth_azimuth,truth_elevation,error_azimuth,
///                error_elevation,sigma_azimuth,sigma_elevation,nees_position,nees_state   (errors are arcs
///                [rad])
///   gospa.csv    topic,time,distance,localisation,missed,false,ospa
/// with what is not known left empty.
class JudgementFiles {
 public:
  /// Throws std::runtime_error when the folder cannot be written.
  explicit JudgementFiles(const std::string& folder);
  JudgementFiles(const JudgementFiles&) = delete;
  JudgementFiles& operator=(const JudgementFiles&) = delete;

  /// Writes as long as this lives.
  sightline::core::ScoreListener listener();

 private:
  void write(const sightline::core::ScoredPair& pair);
  void write(const sightline::core::ScoredReport& report);

  std::ofstream errors_, gospa_;
};

}  // namespace sightline_ros
