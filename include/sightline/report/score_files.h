#pragma once

#include <string>
#include <vector>

#include "sightline/core/evaluation/score_listener.h"
#include "sightline/report/output_file.h"

namespace sightline::report {

/// Writes everything that an evaluation scores, for plotting, into a folder that is created when it is
/// missing:
///   errors.csv   topic,name,time,target,track,azimuth,elevation,truth_azimuth,truth_elevation,error_azimuth,
///                error_elevation,sigma_azimuth,sigma_elevation,nees_position,nees_state   (errors are arcs
///                [rad])
///   gospa.csv    topic,time,distance,localisation,missed,false,ospa
/// Unknown values are left empty. The files are there once they are finished.
class ScoreFiles {
 public:
  /// `inputs`: files that are read meanwhile. Throws OutputError when the folder cannot be made or written,
  /// or when an input is one of these files.
  explicit ScoreFiles(const std::string& folder, const std::vector<std::string>& inputs = {});
  ScoreFiles(const ScoreFiles&) = delete;
  ScoreFiles& operator=(const ScoreFiles&) = delete;

  /// The listener that writes. It must not be called after this object is destroyed.
  core::ScoreListener listener();

  /// Puts the files in their place. Throws OutputError when something could not be written.
  void finish();

 private:
  void write(const core::ScoredPair& pair);
  void write(const core::ScoredReport& report);

  TextFile errors_, gospa_;
};

}  // namespace sightline::report
