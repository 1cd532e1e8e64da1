#pragma once

#include <string>
#include <vector>

#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>

#include "sightline/report/csv_table.h"

namespace sightline_ros {

/// Columns of a recording of sightings; `scan` (any text) is optional: without it each row is a scan.
sightline::report::CsvTable readSightingTable(const std::string& path);

/// The recording as scans, in order of time and sensor; a row whose four angles are empty says that the
/// sensor saw nothing. Times get `offset` [s] added; `frame` is that of the angles. Throws CsvError, with the
/// line, for a time that ROS cannot hold, a sensor name that no topic can be made of, a sighting that every
/// tracker would reject, and a scan whose rows differ in time.
std::vector<sightline::SightingArray> scansOf(const sightline::report::CsvTable& table,
                                              const std::string& frame, double offset);

/// `time,tracker,track,status,azimuth,...`: the header line of tracks, without line end.
std::string trackColumns();

/// One line with line end for each track of the message.
std::string csvOf(const sightline::TrackArray& tracks);

/// Runs csv_to_bag: returns a line about what was written. `stations` is a table of the sensors' positions
/// (readStationLayout); empty = none. With it each sensor's scans are in a frame of its own, named as the
/// sensor, with its place in /tf_static, and `frame` is not used.
std::string convertCsvToBag(const std::string& csv, const std::string& bag, const std::string& frame,
                            double offset, const std::string& stations = {});

/// Runs bag_to_csv: the tracks of `topics`, or of all TrackArray topics when there are none given. Returns a
/// line about what was written. Throws std::runtime_error when there is none.
std::string convertBagToCsv(const std::string& bag, const std::string& csv,
                            const std::vector<std::string>& topics);

/// Runs bag_to_csv --sightings: the scans of `topics`, or of all SightingArray topics, as readSightingTable
/// and import_sightings read them; a scan that saw nothing is a row without angles. The correlation of
/// azimuth and elevation is left out. Returns a line about what was written. Throws std::runtime_error when
/// there is none.
std::string convertBagToSightingCsv(const std::string& bag, const std::string& csv,
                                    const std::vector<std::string>& topics);

}  // namespace sightline_ros
