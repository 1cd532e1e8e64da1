#include "sightline/report/score_files.h"

#include <filesystem>
#include <optional>

#include "sightline/report/value_text.h"

namespace sightline::report {
namespace {

/// The path of a file in the folder, which is made where it is missing.
std::string fileIn(const std::string& folder, const char* name) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) throw OutputError(folder + ": cannot be made: " + problem.message());
  return std::filesystem::path(folder) / name;
}

double secondsOf(core::Time time) {
  return core::seconds(time.time_since_epoch());
}

std::string orEmpty(const std::optional<double>& value) {
  return value ? std::to_string(*value) : "";
}

}  // namespace

ScoreFiles::ScoreFiles(const std::string& folder, const std::vector<std::string>& inputs)
    : errors_(fileIn(folder, "errors.csv"), inputs), gospa_(fileIn(folder, "gospa.csv"), inputs) {
  errors_.stream().precision(15);
  gospa_.stream().precision(15);
  errors_.stream()
      << "topic,name,time,target,track,azimuth,elevation,truth_azimuth,truth_elevation,error_azimuth,"
         "error_elevation,sigma_azimuth,sigma_elevation,nees_position,nees_state\n";
  gospa_.stream() << "topic,time,distance,localisation,missed,false,ospa\n";
}

void ScoreFiles::finish() {
  errors_.finish();
  gospa_.finish();
}

core::ScoreListener ScoreFiles::listener() {
  return {[this](const core::ScoredPair& pair) { write(pair); },
          [this](const core::ScoredReport& report) { write(report); }};
}

void ScoreFiles::write(const core::ScoredPair& pair) {
  const core::DirectionError& error = pair.error;
  errors_.stream() << csvCell(pair.topic) << ',' << csvCell(pair.name) << ',' << secondsOf(pair.time) << ','
                   << pair.target << ',' << pair.track << ',' << pair.angles.x() << ',' << pair.angles.y()
                   << ',' << pair.truth.x() << ',' << pair.truth.y() << ',' << error.position.x() << ','
                   << error.position.y() << ',' << error.sigma.x() << ',' << error.sigma.y() << ','
                   << orEmpty(error.position_nees) << ',' << orEmpty(error.state_nees) << '\n';
}

void ScoreFiles::write(const core::ScoredReport& report) {
  const core::Gospa& gospa = report.gospa;
  gospa_.stream() << csvCell(report.topic) << ',' << secondsOf(report.time) << ',' << gospa.distance << ','
                  << gospa.localisation << ',' << gospa.missed << ',' << gospa.extra << ','
                  << report.ospa.distance << '\n';
}

}  // namespace sightline::report
