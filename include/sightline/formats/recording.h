#pragma once

#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/time.h"
#include "sightline/formats/geodesy.h"
#include "sightline/formats/import_options.h"
#include "sightline/formats/star_coordinates.h"
#include "sightline/formats/text_file.h"

namespace sightline::formats {

inline constexpr double kNotSaid = std::numeric_limits<double>::quiet_NaN();

/// One direction of a file in the axes of its sensor's frame (x forward or east, y left or north, z up),
/// azimuth counter-clockwise from x.
struct FileSighting {
  Eigen::Vector2d angles = Eigen::Vector2d::Zero();             ///< azimuth, elevation [rad]
  Eigen::Vector2d sigma = Eigen::Vector2d::Constant(kNotSaid);  ///< of azimuth itself and elevation [rad]
  double snr = kNotSaid;                                        ///< amplitude ratio
  std::string target;  ///< whose direction it is, where the file says so
};

/// One exposure of one sensor; without sightings it looked and saw nothing.
struct FileScan {
  core::Time time{};
  std::string sensor;
  std::vector<FileSighting> sightings;
};

/// What a file says, in this package's units and axes.
struct Recording {
  std::string format;
  std::map<std::string, Station> stations;  ///< by sensor, as far as they are known
  std::vector<FileScan> scans;              ///< in order of time and sensor
  std::vector<std::string> remarks;         ///< what was understood, corrected, left out
};

/// What all readers do alike: sigmas, names, offsets, checks, order.
class RecordingBuilder {
 public:
  RecordingBuilder(std::string format, const TextFile& file, const ImportOptions& options);

  /// The sensor's name for those files that have none, or may have an empty one. Throws FormatError.
  std::string sensorOr(const std::string& name, std::size_t line);

  /// A sighting of line `line`. Sightings of one sensor with the same `scan`, or the same time where that is
  /// empty, are one scan. A sigma that is not said is that of the options, along arcs. Throws FormatError
  /// when there is none, and for a sighting that every tracker would reject.
  void add(std::size_t line, core::Time time, const std::string& sensor, FileSighting sighting,
           const std::string& scan = {});

  /// The sensor looked and saw nothing.
  void addEmpty(std::size_t line, core::Time time, const std::string& sensor, const std::string& scan = {});

  void setStation(const std::string& sensor, const Station& station);

  /// The station of a sensor, from the file or the options; throws FormatError naming the option when it is
  /// needed for `purpose` and not known.
  Station station(const std::string& sensor, std::size_t line, const std::string& purpose) const;

  /// Azimuth and elevation at the sensor's station of right ascension and declination [rad]. Throws
  /// FormatError where the station is not known.
  Eigen::Vector2d fromStars(std::size_t line, core::Time time, const std::string& sensor,
                            const Eigen::Vector2d& right_ascension_declination, Equinox equinox);

  void remark(const std::string& text);

  /// Counts something that is said once at the end: "3 lines: <what> (first in line 17)".
  void count(const std::string& what, std::size_t line);

  const ImportOptions& options() const { return options_; }
  std::size_t sightings() const { return sightings_; }

  /// Throws FormatError when there is no scan at all.
  Recording finish();

 private:
  FileScan& scanAt(std::size_t line, core::Time time, const std::string& sensor, const std::string& scan);
  void fillSigma(std::size_t line, FileSighting& sighting);

  const TextFile& file_;
  const ImportOptions& options_;
  Recording recording_;
  std::map<std::pair<std::string, std::string>, std::size_t> scan_of_;
  std::map<std::string, std::pair<std::size_t, std::size_t>> counts_;  // how often, first line
  std::size_t sightings_ = 0, default_sigmas_ = 0, own_sigmas_ = 0;
};

/// Azimuth [rad], counter-clockwise from east, of one that is clockwise from north, in (-pi, pi] (S-131).
double fromCompass(double compass);

/// Several files' recordings as one; its remarks are of what they have in common: scans of one sensor at one
/// time. Throws FormatError when two of them place one sensor differently.
Recording merged(const std::vector<Recording>& recordings);

}  // namespace sightline::formats
