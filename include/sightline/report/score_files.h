#pragma once

#include <fstream>
#include <string>

#include "sightline/core/evaluation/score_listener.h"

namespace sightline::report {

/// Writes everything that an evaluation scores, for plotting, into a folder that is created when it is
/// missing:
///   errors.csv   topic,name,time,target,track,azimuth,elevation,truth_azimuth,truth_elevation,error_azimuth,
///                error_elevation,sigma_azimuth,sigma_elevation,nees_position,nees_state   (errors are arcs
///                [rad])
///   gospa.csv    topic,time,distance,localisation,missed,false,ospa
/// Unknown values are left empty.
class ScoreFiles {
 public:
  /// Throws std::runtime_error when the folder cannot be written.
  explicit ScoreFiles(const std::string& folder);
  ScoreFiles(const ScoreFiles&) = delete;
  ScoreFiles& operator=(const ScoreFiles&) = delete;

  /// The listener that writes. It must not be called after this object is destroyed.
  core::ScoreListener listener();

 private:
  void write(const core::ScoredPair& pair);
  void write(const core::ScoredReport& report);

  std::ofstream errors_, gospa_;
};

}  // namespace sightline::report
