#pragma once

#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

/// Places on the earth (WGS-84) and the axes there. Earth-fixed coordinates: x to latitude 0, longitude 0; z
/// to the north pole [m].
namespace sightline::formats {

/// A place: latitude and longitude [rad], height above the ellipsoid [m].
struct Station {
  double latitude = 0.0, longitude = 0.0, height = 0.0;
};

Eigen::Vector3d earthFixed(const Station& station);

/// The place of an earth-fixed point that is not at the centre of the earth.
Station stationAt(const Eigen::Vector3d& earth_fixed);

/// R_earth_from_enu: columns east, north and up of the place.
Eigen::Matrix3d eastNorthUp(const Station& station);

/// Where a frame stands in `world`: R_world_from_frame and the origin [m].
struct FramePlace {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

/// Stations in one frame `world`.
struct StationLayout {
  std::map<std::string, FramePlace> places;  ///< by sensor
  std::optional<Station> origin;             ///< of `world`, where it is known
};

/// `world` = east, north, up at the mean latitude, longitude and height of the stations; each station's frame
/// = its own east, north, up (S-133).
StationLayout layoutOf(const std::map<std::string, Station>& stations);

/// Reads STATIONS.csv: `sensor,east_m,north_m,up_m` (axes of every station parallel to `world`) or
/// `sensor,latitude_deg,longitude_deg,height_m` (WGS-84). Throws report::CsvError.
StationLayout readStationLayout(const std::string& path);

/// The geodetic stations of such a file; throws report::CsvError for one in metres.
std::map<std::string, Station> readStations(const std::string& path);

}  // namespace sightline::formats
