#include "sightline/formats/odas_sources.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <yaml-cpp/yaml.h>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

constexpr std::size_t kLongestObject = 64 << 10;  // [bytes]
constexpr int kDeepest = 8;                       // objects within objects

class OdasReader {
 public:
  OdasReader(const TextFile& file, const ImportOptions& options)
      : file_(file), options_(options), builder_("ODAS", file, options) {}

  Recording read() {
    if (!options_.frame_rate) {
      throw file_.error(
          0,
          "times of ODAS are numbers of hops: state their rate, the sample rate over the hop size, with "
          "--frame-rate, for instance 125 for 16 kHz and hops of 128");
    }
    sensor_ = builder_.sensorOr("", 0);
    const std::string& text = file_.text();
    // The objects of the stream follow each other, with or without commas and a list around them.
    std::size_t begin = 0;
    int depth = 0;
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (is_quoted) {
        if (text[i] == '\\')
          ++i;
        else if (text[i] == '"')
          is_quoted = false;
      } else if (text[i] == '"') {
        is_quoted = true;
      } else if (text[i] == '{') {
        if (depth++ == 0) begin = i;
        if (depth > kDeepest) throw file_.error(file_.lineOf(i), "objects are nested too deep for ODAS");
      } else if (text[i] == '}') {
        if (--depth < 0) throw file_.error(file_.lineOf(i), "a brace is closed that was not opened");
        if (depth == 0) readObject(begin, text.substr(begin, i + 1 - begin));
      }
      if (depth > 0 && i - begin > kLongestObject)
        throw file_.error(file_.lineOf(begin),
                          "an object is longer than " + std::to_string(kLongestObject) + " bytes");
    }
    if (depth > 0) throw file_.error(file_.lineOf(begin), "the last object is not complete: cut it off");
    builder_.remark("directions are in the axes of the microphone array; times are hops at " +
                    report::valueOf(*options_.frame_rate, "Hz"));
    if (options_.heading) builder_.remark("azimuths from east, with the heading as told");
    return builder_.finish();
  }

 private:
  void readObject(std::size_t begin, const std::string& text) {
    const std::size_t line = file_.lineOf(begin);
    try {
      const YAML::Node object = YAML::Load(text);
      const YAML::Node hop = object["timeStamp"], sources = object["src"];
      if (!hop || !sources || !sources.IsSequence())
        throw file_.error(line, "expected an object with \"timeStamp\" and a list \"src\"");
      const double count = hop.as<double>();
      if (!(count >= 0.0 && count < 1e15)) throw file_.error(line, "timeStamp: expected the number of a hop");
      const core::Time time = core::Time{} + core::durationOf(count / *options_.frame_rate);
      builder_.addEmpty(line, time, sensor_);
      for (const YAML::Node& source : sources) readSource(line, time, source);
    } catch (const YAML::Exception& problem) {
      throw file_.error(line + static_cast<std::size_t>(std::max(problem.mark.line, 0)),
                        "is no JSON of ODAS: " + problem.msg);
    }
  }

  void readSource(std::size_t line, core::Time time, const YAML::Node& source) {
    const Eigen::Vector3d direction(source["x"].as<double>(), source["y"].as<double>(),
                                    source["z"].as<double>());
    if (!direction.allFinite()) throw file_.error(line, "a source has a direction that is not finite");
    const YAML::Node id = source["id"];
    if ((id && id.as<long>() == 0) || direction.norm() < 1e-6) return;
    const YAML::Node measure = source["activity"] ? source["activity"] : source["E"];
    if (options_.least_confidence && measure && measure.as<double>() < *options_.least_confidence) {
      builder_.count("sources below the least confidence are left out", line);
      return;
    }
    FileSighting sighting;
    sighting.angles = core::anglesOf(direction);
    if (options_.heading)
      sighting.angles.x() = core::wrapAngle(sighting.angles.x() + fromCompass(*options_.heading));
    if (id) sighting.target = id.as<std::string>();
    builder_.add(line, time, sensor_, sighting);
  }

  const TextFile& file_;
  const ImportOptions& options_;
  RecordingBuilder builder_;
  std::string sensor_;
};

}  // namespace

bool isOdas(const TextFile& file) {
  const std::string_view text = trimmed(std::string_view(file.text()).substr(0, 4096));
  return !text.empty() && (text.front() == '{' || text.front() == '[') &&
         text.find("\"timeStamp\"") != std::string_view::npos;
}

Recording readOdas(const TextFile& file, const ImportOptions& options) {
  return OdasReader(file, options).read();
}

}  // namespace sightline::formats
