#include "sightline/formats/formats.h"

#include <cstdint>
#include <cstdio>
#include <sstream>

#include "sightline/formats/ccsds_tdm.h"
#include "sightline/formats/cmn_sightings.h"
#include "sightline/formats/csv_sightings.h"
#include "sightline/formats/fireball_ecsv.h"
#include "sightline/formats/krakensdr_bearings.h"
#include "sightline/formats/mot_boxes.h"
#include "sightline/formats/observer_reports.h"
#include "sightline/formats/odas_sources.h"
#include "sightline/formats/rms_detections.h"

namespace sightline::formats {
namespace {

const Format& named(const std::string& name) {
  std::string known;
  for (const Format& format : formats()) {
    if (format.name == name) return format;
    known += (known.empty() ? "" : ", ") + format.name;
  }
  throw FormatError("--format: there is no format \"" + name + "\"; there are " + known);
}

/// Seconds to the nanosecond.
std::string secondsText(core::Time time) {
  const std::int64_t since = time.time_since_epoch().count();
  const std::int64_t size = since < 0 ? -since : since;
  char text[48];
  std::snprintf(text, sizeof text, "%s%lld.%09lld", since < 0 ? "-" : "",
                static_cast<long long>(size / 1000000000), static_cast<long long>(size % 1000000000));
  return text;
}

/// A name that holds no comma, quote or line end.
std::string plainName(const std::string& name) {
  std::string plain = name.empty() ? "1" : name;
  for (char& letter : plain) {
    if (letter == ',' || letter == '"' || static_cast<unsigned char>(letter) < ' ') letter = '_';
  }
  return plain;
}

}  // namespace

const std::vector<Format>& formats() {
  static const std::vector<Format> all{
      {"ecsv", "fireball ECSV (Desert Fireball Network, Global Fireball Exchange)", isFireballEcsv,
       readFireballEcsv},
      {"tdm", "CCSDS Tracking Data Message, text", isTdmText, readTdmText},
      {"tdm-xml", "CCSDS Tracking Data Message, XML", isTdmXml, readTdmXml},
      {"rms", "FTPdetectinfo of RMS meteor stations", isRmsDetections, readRmsDetections},
      {"cmn", "Croatian Meteor Network", isCmn, readCmn},
      {"odas", "sound sources of ODAS, JSON", isOdas, readOdas},
      {"krakensdr", "bearings of a KrakenSDR", isKrakenSdr, readKrakenSdr},
      {"iod", "observers' reports of satellites, IOD", isIod, readIod},
      {"uk", "observers' reports of satellites, UK", isUk, readUk},
      {"mot", "boxes of MOTChallenge", isMotBoxes, readMotBoxes},
      {"csv", "a table with a header line", isCsv, readCsv},
  };
  return all;
}

Recording readRecording(const TextFile& file, const ImportOptions& options) {
  if (file.lines() == 0) throw file.error(0, "is empty");
  if (!options.format.empty()) return named(options.format).read(file, options);
  for (const Format& format : formats()) {
    if (format.recognises(file)) return format.read(file, options);
  }
  std::string known;
  for (const Format& format : formats()) known += "; " + format.name + ": " + format.description;
  throw file.error(0, "is of none of the known formats" + known + ". Say which it is with --format NAME");
}

Recording readRecording(const std::string& path, const ImportOptions& options) {
  return readRecording(TextFile::fromFile(path), options);
}

std::string truthCsv(const Recording& recording) {
  std::ostringstream text;
  text << "time,target,sensor,azimuth,elevation\n";
  char angles[80];
  for (const FileScan& scan : recording.scans) {
    for (const FileSighting& sighting : scan.sightings) {
      std::snprintf(angles, sizeof angles, "%.10f,%.10f", sighting.angles.x(), sighting.angles.y());
      text << secondsText(scan.time) << ',' << plainName(sighting.target) << ',' << plainName(scan.sensor)
           << ',' << angles << '\n';
    }
  }
  return text.str();
}

}  // namespace sightline::formats
