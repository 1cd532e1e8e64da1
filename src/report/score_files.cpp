#include "sightline/report/score_files.h"

#include <filesystem>
#include <optional>
#include <stdexcept>

namespace sightline::report {
namespace {

std::ofstream opened(const std::filesystem::path& path) {
  std::ofstream stream(path);
  if (!stream) throw std::runtime_error(path.string() + ": cannot be written");
  stream.precision(15);
  return stream;
}

double secondsOf(core::Time time) {
  return core::seconds(time.time_since_epoch());
}

std::string orEmpty(const std::optional<double>& value) {
  return value ? std::to_string(*value) : "";
}

}  // namespace

ScoreFiles::ScoreFiles(const std::string& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) throw std::runtime_error(folder + ": cannot be made: " + problem.message());
  errors_ = opened(std::filesystem::path(folder) / "errors.csv");
  gospa_ = opened(std::filesystem::path(folder) / "gospa.csv");
  errors_ << "topic,name,time,target,track,azimuth,elevation,truth_azimuth,truth_elevation,error_azimuth,"
             "error_elevation,sigma_azimuth,sigma_elevation,nees_position,nees_state\n";
  gospa_ << "topic,time,distance,localisation,missed,false,ospa\n";
}

core::ScoreListener ScoreFiles::listener() {
  return {[this](const core::ScoredPair& pair) { write(pair); },
          [this](const core::ScoredReport& report) { write(report); }};
}

void ScoreFiles::write(const core::ScoredPair& pair) {
  const core::DirectionError& error = pair.error;
  errors_ << pair.topic << ',' << pair.name << ',' << secondsOf(pair.time) << ',' << pair.target << ','
          << pair.track << ',' << pair.angles.x() << ',' << pair.angles.y() << ',' << pair.truth.x() << ','
          << pair.truth.y() << ',' << error.position.x() << ',' << error.position.y() << ','
          << error.sigma.x() << ',' << error.sigma.y() << ',' << orEmpty(error.position_nees) << ','
          << orEmpty(error.state_nees) << '\n';
}

void ScoreFiles::write(const core::ScoredReport& report) {
  const core::Gospa& gospa = report.gospa;
  gospa_ << report.topic << ',' << secondsOf(report.time) << ',' << gospa.distance << ','
         << gospa.localisation << ',' << gospa.missed << ',' << gospa.extra << ',' << report.ospa.distance
         << '\n';
}

}  // namespace sightline::report
