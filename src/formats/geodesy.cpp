#include "sightline/formats/geodesy.h"

#include <cmath>
#include <erfa.h>
#include <stdexcept>

#include "sightline/core/model/sphere.h"
#include "sightline/report/csv_table.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

using report::CsvTable;

constexpr int kWgs84 = 1;                                    // ERFA's number of the ellipsoid
constexpr double kFurthest = 1e8;                            // [m], of a station
constexpr double kLeastHeight = -1e4, kLargestHeight = 1e5;  // [m], of a station

double bounded(const CsvTable& table, std::size_t row, const std::string& column, const std::string& unit,
               double least, double largest) {
  const double value = table.number(row, column, unit);
  if (value >= least && value <= largest) return value;
  throw table.error(row, column + ": expected " + report::valueOf(least, unit) + " to " +
                             report::valueOf(largest, unit) + ", got " + table.text(row, column));
}

CsvTable stationTable(const std::string& path) {
  CsvTable table = CsvTable::fromFile(
      path, {"sensor"}, {"east_m", "north_m", "up_m", "latitude_deg", "longitude_deg", "height_m"});
  const bool is_geodetic = table.has("latitude_deg") && table.has("longitude_deg") && table.has("height_m");
  const bool is_local = table.has("east_m") && table.has("north_m") && table.has("up_m");
  const bool is_mixed =
      is_geodetic ? table.has("east_m") || table.has("north_m") || table.has("up_m")
                  : table.has("latitude_deg") || table.has("longitude_deg") || table.has("height_m");
  if (is_geodetic == is_local || is_mixed) {
    throw report::CsvError(path +
                           ":1: expected the columns sensor,east_m,north_m,up_m or sensor,latitude_deg,"
                           "longitude_deg,height_m");
  }
  if (table.rows() == 0) throw report::CsvError(path + ": there is a header, but no station below it");
  return table;
}

template <typename Value>
void insert(std::map<std::string, Value>& all, const CsvTable& table, std::size_t row, const Value& value) {
  const std::string& sensor = table.text(row, "sensor");
  if (sensor.empty()) throw table.error(row, "sensor: the name is empty");
  if (!all.emplace(sensor, value).second)
    throw table.error(row, "sensor: \"" + sensor + "\" stands twice; a station has one place");
}

std::map<std::string, Station> geodeticStations(const CsvTable& table) {
  std::map<std::string, Station> stations;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    Station station;
    station.latitude = core::kDegree * bounded(table, row, "latitude_deg", "deg", -90.0, 90.0);
    station.longitude = core::kDegree * bounded(table, row, "longitude_deg", "deg", -360.0, 360.0);
    station.height = bounded(table, row, "height_m", "m", kLeastHeight, kLargestHeight);
    insert(stations, table, row, station);
  }
  return stations;
}

}  // namespace

Eigen::Vector3d earthFixed(const Station& station) {
  double point[3];
  if (eraGd2gc(kWgs84, station.longitude, station.latitude, station.height, point) != 0)
    throw std::invalid_argument("earthFixed: no place on the earth");
  return {point[0], point[1], point[2]};
}

Station stationAt(const Eigen::Vector3d& earth_fixed) {
  double point[3] = {earth_fixed.x(), earth_fixed.y(), earth_fixed.z()};
  Station station;
  if (eraGc2gd(kWgs84, point, &station.longitude, &station.latitude, &station.height) != 0)
    throw std::invalid_argument("stationAt: no place on the earth");
  return station;
}

Eigen::Matrix3d eastNorthUp(const Station& station) {
  const double sin_lat = std::sin(station.latitude), cos_lat = std::cos(station.latitude);
  const double sin_lon = std::sin(station.longitude), cos_lon = std::cos(station.longitude);
  Eigen::Matrix3d axes;
  axes.col(0) << -sin_lon, cos_lon, 0.0;
  axes.col(1) << -sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat;
  axes.col(2) << cos_lat * cos_lon, cos_lat * sin_lon, sin_lat;
  return axes;
}

StationLayout layoutOf(const std::map<std::string, Station>& stations) {
  StationLayout layout;
  if (stations.empty()) return layout;
  // The differences from the first one, so that longitudes of 179 and -179 degrees have their mean between
  // them.
  const Station first = stations.begin()->second;
  Station mean = first;
  for (const auto& [sensor, station] : stations) {
    const double share = 1.0 / static_cast<double>(stations.size());
    mean.latitude += share * (station.latitude - first.latitude);
    mean.longitude += share * core::wrapAngle(station.longitude - first.longitude);
    mean.height += share * (station.height - first.height);
  }
  mean.longitude = core::wrapAngle(mean.longitude);
  layout.origin = mean;
  const Eigen::Vector3d origin = earthFixed(*layout.origin);
  const Eigen::Matrix3d R_world_from_earth = eastNorthUp(*layout.origin).transpose();
  for (const auto& [sensor, station] : stations) {
    FramePlace& place = layout.places[sensor];
    place.rotation = R_world_from_earth * eastNorthUp(station);
    place.origin = R_world_from_earth * (earthFixed(station) - origin);
  }
  return layout;
}

StationLayout readStationLayout(const std::string& path) {
  const CsvTable table = stationTable(path);
  if (table.has("latitude_deg")) return layoutOf(geodeticStations(table));
  StationLayout layout;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    FramePlace place;
    place.origin << bounded(table, row, "east_m", "m", -kFurthest, kFurthest),
        bounded(table, row, "north_m", "m", -kFurthest, kFurthest),
        bounded(table, row, "up_m", "m", -kFurthest, kFurthest);
    insert(layout.places, table, row, place);
  }
  return layout;
}

std::map<std::string, Station> readStations(const std::string& path) {
  const CsvTable table = stationTable(path);
  if (!table.has("latitude_deg")) {
    throw report::CsvError(
        path +
        ":1: these stations are in metres; here latitude_deg, longitude_deg and height_m are "
        "needed");
  }
  return geodeticStations(table);
}

}  // namespace sightline::formats
