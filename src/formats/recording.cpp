#include "sightline/formats/recording.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <tuple>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"

namespace sightline::formats {
namespace {

constexpr std::size_t kMostScans = 20000000;
constexpr std::size_t kMostKinds = 200;  // of counted remarks, whose words may hold names from the file
constexpr double kLeastCosine = 1e-6;    // below, an azimuth says nothing of the direction

std::string degrees(double angle) {
  std::ostringstream text;
  text << angle / core::kDegree << " deg";
  return text.str();
}

}  // namespace

double fromCompass(double compass) {
  return core::wrapAngle(0.5 * core::kPi - compass);
}

RecordingBuilder::RecordingBuilder(std::string format, const TextFile& file, const ImportOptions& options)
    : file_(file), options_(options) {
  recording_.format = std::move(format);
}

std::string RecordingBuilder::sensorOr(const std::string& name, std::size_t line) {
  std::string own(trimmed(name));
  if (!own.empty()) {
    if (!options_.sensor.empty() && own != options_.sensor)
      count("the file names its sensors; --sensor is for those without a name and is not used", line);
    return own;
  }
  if (!options_.sensor.empty()) return options_.sensor;
  throw file_.error(line, "the name of the sensor is not in the file: state it with --sensor NAME");
}

Station RecordingBuilder::station(const std::string& sensor, std::size_t line,
                                  const std::string& purpose) const {
  const auto own = recording_.stations.find(sensor);
  if (own != recording_.stations.end()) return own->second;
  for (const std::string& name : {sensor, std::string()}) {
    const auto told = options_.stations.find(name);
    if (told != options_.stations.end()) return told->second;
  }
  throw file_.error(
      line, "the position of station \"" + sensor + "\" is not in the file and is needed for " + purpose +
                ": state it with --station " + sensor +
                "=LATITUDE,LONGITUDE,HEIGHT (degrees north, degrees east, metres above WGS-84) or "
                "--stations FILE.csv");
}

void RecordingBuilder::setStation(const std::string& sensor, const Station& station) {
  if (!(std::abs(station.latitude) <= 0.5 * core::kPi) || !(std::abs(station.longitude) <= 2.0 * core::kPi) ||
      !(std::abs(station.height) <= 1e5)) {
    throw file_.error(0, "the position of station \"" + sensor + "\", latitude " + degrees(station.latitude) +
                             ", longitude " + degrees(station.longitude) + ", height " +
                             std::to_string(station.height) +
                             " m, is not on the earth: correct it in the file");
  }
  recording_.stations[sensor] = station;
}

Eigen::Vector2d RecordingBuilder::fromStars(std::size_t line, core::Time time, const std::string& sensor,
                                            const Eigen::Vector2d& right_ascension_declination,
                                            Equinox equinox) {
  const Station at = station(sensor, line, "azimuths from right ascensions");
  const double ut1_minus_utc = options_.ut1_minus_utc.value_or(0.0);
  const auto angles = horizontalOf(right_ascension_declination, equinox, time, at, ut1_minus_utc);
  if (!angles)
    throw file_.error(line, "the time " + isoText(time) + " is too far from today for the earth's rotation");
  const char* of = equinox == Equinox::j2000 ? "J2000" : equinox == Equinox::b1950 ? "B1950" : "of date";
  count(std::string("azimuth and elevation from right ascension and declination (") + of +
            "), without refraction, UT1 - UTC " +
            (options_.ut1_minus_utc ? "as told" : "taken for 0 (up to 14 arc seconds; --ut1-utc)"),
        line);
  return *angles;
}

void RecordingBuilder::remark(const std::string& text) {
  recording_.remarks.push_back(text);
}

void RecordingBuilder::count(const std::string& what, std::size_t line) {
  if (counts_.size() >= kMostKinds && counts_.count(what) == 0) return;
  ++counts_.emplace(what, std::make_pair(std::size_t{0}, line)).first->second.first;
}

FileScan& RecordingBuilder::scanAt(std::size_t line, core::Time time, const std::string& sensor,
                                   const std::string& scan) {
  time += options_.offset;
  const std::string name = scan.empty() ? std::to_string(time.time_since_epoch().count()) : "scan " + scan;
  const auto [place, is_new] = scan_of_.emplace(std::make_pair(sensor, name), recording_.scans.size());
  if (is_new) {
    if (recording_.scans.size() >= kMostScans)
      throw file_.error(line, "there are too many scans: split the file");
    recording_.scans.push_back({time, sensor, {}});
  }
  FileScan& found = recording_.scans[place->second];
  if (found.time != time) {
    throw file_.error(line, "scan \"" + scan + "\" of " + sensor + " has rows of different times, " +
                                isoText(found.time) + " and " + isoText(time) + "; one exposure has one");
  }
  return found;
}

void RecordingBuilder::fillSigma(std::size_t line, FileSighting& sighting) {
  if (sighting.sigma.allFinite()) {
    own_sigmas_ += options_.sigma ? 1 : 0;
    return;
  }
  if (!options_.sigma) {
    if (options_.for_truth) return;
    throw file_.error(
        line,
        "the sigma of the sightings is not in the file: state it with --sigma 0.05deg, or with --sigma "
        "AZIMUTH,ELEVATION where they differ (along arcs of the sphere)");
  }
  ++default_sigmas_;
  const double cosine = std::max(std::cos(sighting.angles.y()), kLeastCosine);
  if (!std::isfinite(sighting.sigma.x())) sighting.sigma.x() = options_.sigma->x() / cosine;
  if (!std::isfinite(sighting.sigma.y())) sighting.sigma.y() = options_.sigma->y();
}

void RecordingBuilder::add(std::size_t line, core::Time time, const std::string& sensor,
                           FileSighting sighting, const std::string& scan) {
  fillSigma(line, sighting);
  if (sighting.sigma.minCoeff() < 0.0)
    throw file_.error(line, "a sigma is negative: expected a standard deviation");
  const bool has_sigma = sighting.sigma.allFinite();
  const Eigen::Vector2d checked = has_sigma ? sighting.sigma : Eigen::Vector2d::Constant(1e-3);
  const Eigen::Matrix2d covariance = checked.cwiseAbs2().asDiagonal();
  if (const auto why = core::rejectionOf(sighting.angles, covariance)) throw file_.error(line, why->detail);
  sighting.angles.x() = core::wrapAngle(sighting.angles.x());
  scanAt(line, time, sensor, scan).sightings.push_back(std::move(sighting));
  ++sightings_;
}

void RecordingBuilder::addEmpty(std::size_t line, core::Time time, const std::string& sensor,
                                const std::string& scan) {
  scanAt(line, time, sensor, scan);
}

Recording RecordingBuilder::finish() {
  if (recording_.scans.empty()) {
    std::string why;
    for (const auto& [what, times] : counts_) why += "; " + what;
    throw file_.error(0, "there is no sighting in this " + recording_.format + " file" + why);
  }
  std::stable_sort(recording_.scans.begin(), recording_.scans.end(),
                   [](const FileScan& a, const FileScan& b) {
                     return std::tie(a.time, a.sensor) < std::tie(b.time, b.sensor);
                   });
  std::set<std::string> sensors;
  for (const FileScan& scan : recording_.scans) sensors.insert(scan.sensor);
  for (const std::string& sensor : sensors) {
    for (const std::string& name : {sensor, std::string()}) {
      const auto told = options_.stations.find(name);
      if (told == options_.stations.end() || recording_.stations.count(sensor) > 0) continue;
      recording_.stations[sensor] = told->second;
    }
  }
  if (own_sigmas_ > 0)
    remark("sigma of " + std::to_string(own_sigmas_) +
           " sightings is the file's; --sigma is for those without one");
  if (default_sigmas_ > 0) {
    std::ostringstream text;
    text << "sigma of " << default_sigmas_ << " sightings as told: " << degrees(options_.sigma->x())
         << " and " << degrees(options_.sigma->y()) << " along azimuth and elevation";
    remark(text.str());
  }
  for (const auto& [what, times] : counts_) {
    const auto& [often, line] = times;
    remark(what + " (" + std::to_string(often) + (often == 1 ? " line" : " lines") + ", first line " +
           std::to_string(line) + ")");
  }
  return std::move(recording_);
}

Recording merged(const std::vector<Recording>& recordings) {
  Recording all;
  std::set<std::pair<std::string, core::Time>> seen;
  std::map<std::string, std::size_t> doubled;  // by sensor
  for (const Recording& one : recordings) {
    if (all.format.find(one.format) == std::string::npos)
      all.format += (all.format.empty() ? "" : ", ") + one.format;
    for (const auto& [sensor, station] : one.stations) {
      const auto [place, is_new] = all.stations.emplace(sensor, station);
      if (!is_new && (earthFixed(place->second) - earthFixed(station)).norm() > 1.0) {
        throw FormatError(
            "station \"" + sensor +
            "\" stands at two places in these files, more than a metre apart: import them one by one, or "
            "give one of the sensors another name");
      }
    }
    all.scans.insert(all.scans.end(), one.scans.begin(), one.scans.end());
    std::set<std::pair<std::string, core::Time>> own;
    for (const FileScan& scan : one.scans) own.insert({scan.sensor, scan.time});
    for (const auto& scan : own) doubled[scan.first] += seen.insert(scan).second ? 0 : 1;
  }
  std::stable_sort(all.scans.begin(), all.scans.end(), [](const FileScan& a, const FileScan& b) {
    return std::tie(a.time, a.sensor) < std::tie(b.time, b.sensor);
  });
  for (const auto& [sensor, often] : doubled) {
    if (often > 0) {
      all.remarks.push_back(std::to_string(often) + " times of " + sensor +
                            " stand in more than one file, and each is a scan: is a file given twice?");
    }
  }
  return all;
}

}  // namespace sightline::formats
