#include "sightline/report/position_text.h"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <vector>

#include "sightline/report/evaluation_text.h"
#include "sightline/report/value_text.h"

namespace sightline::report {
namespace {

std::vector<std::string> errorCells(const core::PositionErrors& errors) {
  return {std::to_string(errors.samples), readable(errors.rmse), readable(errors.median),
          readable(errors.p90),           readable(errors.p95),  readable(errors.median_velocity),
          readable(errors.anees)};
}

}  // namespace

std::string positionTable(const std::map<std::string, core::PositionRow>& rows) {
  if (rows.empty()) return "";
  std::vector<std::vector<std::string>> errors{{"positions", "", "samples", "RMSE [m]", "median [m]",
                                                "90 % [m]", "95 % [m]", "velocity, median [m/s]", "ANEES"}};
  std::vector<std::vector<std::string>> lives{{"positions", "coverage", "breaks", "ID changes", "tracks",
                                               "false tracks", "their share", "GOSPA [m]"}};
  for (const auto& [topic, row] : rows) {
    std::vector<std::string> line{topic, "all"};
    for (const std::string& cell : errorCells(row.all)) line.push_back(cell);
    errors.push_back(line);
    if (row.alone.samples > 0) {
      line = {topic, "one station alone"};
      for (const std::string& cell : errorCells(row.alone)) line.push_back(cell);
      errors.push_back(line);
    }
    lives.push_back({topic, percent(row.coverage), std::to_string(row.breaks), std::to_string(row.id_changes),
                     std::to_string(row.tracks), std::to_string(row.false_tracks), percent(row.false_share),
                     readable(row.gospa)});
  }
  return alignedTable(errors) + "\n" + alignedTable(lives);
}

std::string positionSummary(const std::map<std::string, core::PositionRow>& rows) {
  std::string summary;
  for (const auto& [topic, row] : rows) {
    if (row.reports == 0) continue;
    summary += topic + "  RMSE " + readable(row.all.rmse) + " m, median " + readable(row.all.median) +
               " m, ANEES " + readable(row.all.anees) + ", coverage " + percent(row.coverage) +
               ", false tracks " + std::to_string(row.false_tracks) + "\n";
  }
  return summary;
}

void writePositionRows(std::ostream& stream, const std::map<std::string, core::PositionRow>& rows) {
  stream << "topic,reports,samples,rmse_m,median_m,p90_m,p95_m,median_velocity_m_s,anees,alone_samples,"
            "alone_rmse_m,alone_median_m,alone_anees,coverage,breaks,id_changes,tracks,false_tracks,"
            "false_share,gospa_m\n";
  for (const auto& [topic, row] : rows) {
    stream << csvCell(topic) << ',' << row.reports << ',' << row.all.samples << ',' << orEmpty(row.all.rmse)
           << ',' << orEmpty(row.all.median) << ',' << orEmpty(row.all.p90) << ',' << orEmpty(row.all.p95)
           << ',' << orEmpty(row.all.median_velocity) << ',' << orEmpty(row.all.anees) << ','
           << row.alone.samples << ',' << orEmpty(row.alone.rmse) << ',' << orEmpty(row.alone.median) << ','
           << orEmpty(row.alone.anees) << ',' << orEmpty(row.coverage) << ',' << row.breaks << ','
           << row.id_changes << ',' << row.tracks << ',' << row.false_tracks << ','
           << orEmpty(row.false_share) << ',' << orEmpty(row.gospa) << '\n';
  }
}

std::string positionErrorHeader() {
  return "topic,time,target,track,error_x_m,error_y_m,error_z_m,sigma_x_m,sigma_y_m,sigma_z_m,nees,alone\n";
}

std::string positionErrorLine(const std::string& topic, core::Time time,
                              const core::PositionEvaluation::Pair& pair) {
  std::ostringstream line;
  line << csvCell(topic) << ',' << std::fixed << std::setprecision(9)
       << core::seconds(time.time_since_epoch()) << ',' << csvCell(pair.target) << ',' << pair.id;
  for (int axis = 0; axis < 3; ++axis) line << ',' << orEmpty(pair.error(axis));
  for (int axis = 0; axis < 3; ++axis) line << ',' << orEmpty(pair.sigma(axis));
  line << ',' << orEmpty(pair.nees) << ',' << (pair.is_alone ? 1 : 0) << '\n';
  return line.str();
}

std::string positionGospaHeader() {
  return "topic,time,distance,localisation,missed,false\n";
}

std::string positionGospaLine(const std::string& topic, core::Time time, const core::Gospa& gospa) {
  std::ostringstream line;
  line << csvCell(topic) << ',' << std::fixed << std::setprecision(9)
       << core::seconds(time.time_since_epoch()) << ',' << orEmpty(gospa.distance) << ','
       << orEmpty(gospa.localisation) << ',' << gospa.missed << ',' << gospa.extra << '\n';
  return line.str();
}

}  // namespace sightline::report
