#include "sightline/formats/ccsds_tdm.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tinyxml2.h>
#include <utility>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

constexpr std::size_t kLargestXml = std::size_t{64} << 20;  // [bytes]: its tree takes several times as much

struct Entry {
  std::string value;
  std::size_t line = 0;
};

/// Metadata of a segment, by keyword.
using Metadata = std::map<std::string, Entry>;

/// Segments one after the other, whatever the syntax.
class Segments {
 public:
  Segments(const TextFile& file, const ImportOptions& options)
      : file_(file), builder_("CCSDS TDM", file, options) {}

  void begin(Metadata metadata, std::size_t line) {
    metadata_ = std::move(metadata);
    line_ = line;
    angle_type_.clear();
    angles_.clear();
  }

  /// A keyword of the data with its epoch.
  void observe(std::size_t line, const std::string& keyword, const std::string& epoch,
               const std::string& value) {
    if (keyword != "ANGLE_1" && keyword != "ANGLE_2") {
      builder_.count("data of " + keyword + " are not used", line);
      return;
    }
    if (angle_type_.empty()) readMetadata();
    const auto time = isoTime(epoch);
    const auto utc = time ? utcOf(*time, textOf("TIME_SYSTEM", "UTC")) : std::nullopt;
    if (!utc)
      throw file_.error(line,
                        keyword + ": expected an epoch as 1998-06-10T00:57:37.5, got \"" + epoch + "\"");
    const auto number = report::numberFrom(value);
    if (!number || !(*number >= -180.0 && *number <= 360.0))
      throw file_.error(line, keyword + ": expected degrees, -180 to 360, got \"" + value + "\"");
    const int which = keyword == "ANGLE_1" ? 0 : 1;
    auto& pair = angles_[*utc];
    if (pair.count(which) > 0)
      throw file_.error(line, keyword + " stands twice at " + epoch + "; it first stands on line " +
                                  std::to_string(pair.at(which).second));
    pair[which] = {*number * core::kDegree + correction_[which], line};
  }

  void end() {
    for (const auto& [time, pair] : angles_) {
      if (pair.size() < 2) {
        builder_.count("angles without the other one at the same epoch are left out",
                       pair.begin()->second.second);
        continue;
      }
      add(time, pair.at(0).first, pair.at(1).first, pair.at(0).second);
    }
    angles_.clear();
  }

  Recording finish() { return builder_.finish(); }

 private:
  std::string textOf(const std::string& keyword, const std::string& fallback = "") const {
    const auto found = metadata_.find(keyword);
    return found != metadata_.end() ? found->second.value : fallback;
  }

  std::size_t lineOf(const std::string& keyword) const {
    const auto found = metadata_.find(keyword);
    return found != metadata_.end() ? found->second.line : line_;
  }

  void readMetadata() {
    angle_type_ = textOf("ANGLE_TYPE");
    const std::size_t line = lineOf("ANGLE_TYPE");
    if (angle_type_.empty())
      throw file_.error(
          line, "ANGLE_TYPE is missing in the metadata: what ANGLE_1 and ANGLE_2 are is not said; add it");
    if (angle_type_ == "XEYN" || angle_type_ == "XSYE") {
      throw file_.error(
          line, "ANGLE_TYPE " + angle_type_ +
                    ": these are angles of a mount with its axes in the horizon (x to the " +
                    (angle_type_ == "XEYN" ? "east, y to the north" : "south, y to the east") +
                    "), not azimuth and elevation, although the first one looks like an azimuth: export "
                    "them as AZEL");
    }
    if (angle_type_ != "AZEL" && angle_type_ != "RADEC")
      throw file_.error(line, "ANGLE_TYPE: expected AZEL or RADEC, got \"" + angle_type_ + "\"");
    const std::string system = textOf("TIME_SYSTEM", "UTC");
    if (!utcOf(core::Time{} + core::durationOf(1e9), system)) {
      throw file_.error(lineOf("TIME_SYSTEM"), "TIME_SYSTEM: expected UTC, TAI, GPS or TT, got \"" + system +
                                                   "\": convert the times");
    }
    if (system != "UTC") builder_.remark("times are of " + system + " and become UTC");
    readFrame();
    readPath();
    readCorrections();
  }

  void readFrame() const {
    if (angle_type_ != "RADEC") return;
    const std::string frame = textOf("REFERENCE_FRAME");
    if (frame == "EME2000" || frame == "ICRF" || frame == "GCRF") return;
    throw file_.error(lineOf("REFERENCE_FRAME"),
                      "REFERENCE_FRAME: right ascension and declination are read in EME2000 or ICRF, got \"" +
                          frame + "\"" + (frame.empty() ? ": add it to the metadata" : ": convert them"));
  }

  void readPath() {
    std::string path = textOf("PATH", textOf("PATH_1"));
    if (path.empty()) path = textOf("PARTICIPANT_2").empty() ? "1" : "2,1";
    const auto numbers = fieldsOf(path, ',');
    const std::string receiver = textOf("PARTICIPANT_" + numbers.back());
    if (receiver.empty() && builder_.options().sensor.empty()) {
      throw file_.error(lineOf("PATH"), "PATH ends at participant " + numbers.back() + ", but PARTICIPANT_" +
                                            numbers.back() +
                                            " is not in the metadata: add it, or state --sensor NAME");
    }
    sensor_ = builder_.sensorOr(receiver, line_);
    target_ = numbers.size() > 1 ? textOf("PARTICIPANT_" + numbers[numbers.size() - 2]) : "";
    builder_.remark(angle_type_ + " of " + sensor_ + (target_.empty() ? "" : ", target " + target_));
  }

  void readCorrections() {
    correction_[0] = correction_[1] = 0.0;
    for (int which = 0; which < 2; ++which) {
      const std::string keyword = "CORRECTION_ANGLE_" + std::to_string(which + 1);
      const std::string text = textOf(keyword);
      if (text.empty()) continue;
      // "0.01 [deg]" has a unit in brackets.
      const auto number = report::numberFrom(std::string(trimmed(text.substr(0, text.find('[')))));
      if (!number) throw file_.error(lineOf(keyword), keyword + ": expected degrees, got \"" + text + "\"");
      const std::string applied = textOf("CORRECTIONS_APPLIED");
      if (applied == "YES") continue;
      if (applied != "NO") {
        throw file_.error(lineOf(keyword), keyword + " is given, but CORRECTIONS_APPLIED is \"" + applied +
                                               "\": say YES or NO in the metadata");
      }
      correction_[which] = *number * core::kDegree;
      builder_.remark(keyword + " of " + text +
                      " deg is added: the file says that corrections are not applied");
    }
  }

  void add(core::Time time, double first, double second, std::size_t line) {
    if (std::abs(second) > 0.5 * core::kPi + 1e-9) {
      throw file_.error(line, std::string("ANGLE_2 at this epoch is ") +
                                  std::to_string(second / core::kDegree) +
                                  " degrees: expected -90 to 90 of " +
                                  (angle_type_ == "AZEL" ? "an elevation" : "a declination"));
    }
    FileSighting sighting;
    sighting.target = target_;
    if (angle_type_ == "AZEL") {
      sighting.angles = {fromCompass(first), second};
    } else {
      sighting.angles = builder_.fromStars(line, time, sensor_, {first, second}, Equinox::j2000);
    }
    builder_.add(line, time, sensor_, sighting);
  }

  const TextFile& file_;
  RecordingBuilder builder_;
  Metadata metadata_;
  std::size_t line_ = 1;
  std::string angle_type_, sensor_, target_;
  double correction_[2] = {0.0, 0.0};                                           // [rad]
  std::map<core::Time, std::map<int, std::pair<double, std::size_t>>> angles_;  // angle [rad], line
};

std::string valueOf(const tinyxml2::XMLElement& element) {
  return element.GetText() != nullptr ? std::string(trimmed(element.GetText())) : "";
}

std::size_t lineOf(const tinyxml2::XMLElement& element) {
  return static_cast<std::size_t>(std::max(element.GetLineNum(), 0));
}

void readObservation(const TextFile& file, const tinyxml2::XMLElement& observation, Segments& segments) {
  const auto* epoch = observation.FirstChildElement("EPOCH");
  if (epoch == nullptr) throw file.error(lineOf(observation), "an <observation> has no <EPOCH>");
  for (const auto* entry = observation.FirstChildElement(); entry != nullptr;
       entry = entry->NextSiblingElement()) {
    if (entry != epoch) segments.observe(lineOf(*entry), entry->Name(), valueOf(*epoch), valueOf(*entry));
  }
}

void readTdmElement(const TextFile& file, const tinyxml2::XMLElement& tdm, Segments& segments) {
  const auto* body = tdm.FirstChildElement("body");
  if (body == nullptr) throw file.error(lineOf(tdm), "this <tdm> has no <body>");
  for (const auto* segment = body->FirstChildElement("segment"); segment != nullptr;
       segment = segment->NextSiblingElement("segment")) {
    Metadata metadata;
    if (const auto* entries = segment->FirstChildElement("metadata")) {
      for (const auto* entry = entries->FirstChildElement(); entry != nullptr;
           entry = entry->NextSiblingElement())
        metadata[entry->Name()] = {valueOf(*entry), lineOf(*entry)};
    }
    segments.begin(std::move(metadata), lineOf(*segment));
    const auto* data = segment->FirstChildElement("data");
    const auto* observation = data != nullptr ? data->FirstChildElement("observation") : nullptr;
    for (; observation != nullptr; observation = observation->NextSiblingElement("observation"))
      readObservation(file, *observation, segments);
    segments.end();
  }
}

}  // namespace

bool isTdmText(const TextFile& file) {
  for (std::size_t line = 1; line <= file.lines(); ++line) {
    const std::string_view text = file.line(line);
    if (!text.empty()) return text.substr(0, 14) == "CCSDS_TDM_VERS";
  }
  return false;
}

bool isTdmXml(const TextFile& file) {
  const std::string_view text = trimmed(std::string_view(file.text()).substr(0, 4096));
  return !text.empty() && text.front() == '<' && text.find("CCSDS_TDM_VERS") != std::string_view::npos;
}

Recording readTdmText(const TextFile& file, const ImportOptions& options) {
  Segments segments(file, options);
  Metadata metadata;
  enum class Part { head, metadata, data } part = Part::head;
  for (std::size_t line = 1; line <= file.lines(); ++line) {
    const std::string text(file.line(line));
    if (text.empty() || text.substr(0, 7) == "COMMENT") continue;
    if (text == "META_START") {
      metadata.clear();
      part = Part::metadata;
    } else if (text == "DATA_START") {
      segments.begin(metadata, line);
      part = Part::data;
    } else if (text == "DATA_STOP") {
      segments.end();
      part = Part::head;
    } else if (text == "META_STOP") {
      part = Part::head;
    } else {
      const std::size_t equals = text.find('=');
      if (equals == std::string::npos)
        throw file.error(line, "expected KEYWORD = VALUE, got \"" + text + "\"");
      const std::string keyword(trimmed(text.substr(0, equals))), value(trimmed(text.substr(equals + 1)));
      if (part == Part::metadata) metadata[keyword] = {value, line};
      if (part != Part::data) continue;
      const auto fields = fieldsOf(value, ' ');
      if (fields.size() != 2)
        throw file.error(line, keyword + ": expected an epoch and a value, got \"" + value + "\"");
      segments.observe(line, keyword, fields[0], fields[1]);
    }
  }
  if (part == Part::data) throw file.error(file.lines(), "ends without DATA_STOP: it is not complete");
  return segments.finish();
}

Recording readTdmXml(const TextFile& file, const ImportOptions& options) {
  if (file.text().size() > kLargestXml)
    throw file.error(
        0, "has more than " + std::to_string(kLargestXml >> 20) + " MiB, too much for XML: split it");
  tinyxml2::XMLDocument document;
  if (document.Parse(file.text().c_str(), file.text().size()) != tinyxml2::XML_SUCCESS) {
    throw file.error(static_cast<std::size_t>(std::max(document.ErrorLineNum(), 0)),
                     std::string("is no complete XML: ") + document.ErrorName());
  }
  const tinyxml2::XMLElement* root = document.RootElement();
  Segments segments(file, options);
  if (root != nullptr && std::string(root->Name()) == "tdm") {
    readTdmElement(file, *root, segments);
  } else {  // in a combined message (ndm) there are several
    const auto* tdm = root != nullptr ? root->FirstChildElement("tdm") : nullptr;
    if (tdm == nullptr) throw file.error(0, "there is no <tdm> in it");
    for (; tdm != nullptr; tdm = tdm->NextSiblingElement("tdm")) readTdmElement(file, *tdm, segments);
  }
  return segments.finish();
}

}  // namespace sightline::formats
