#include "sightline/formats/mot_boxes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/core/model/sphere.h"
#include "sightline/formats/field_text.h"
#include "sightline/formats/image_rays.h"
#include "sightline/report/value_text.h"

namespace sightline::formats {
namespace {

constexpr std::size_t kLeastFields = 7, kMostFields = 10, kTruthFields = 9;
constexpr double kMostFrames = 1e6;

bool separatorIsComma(std::string_view line) {
  return line.find(',') != std::string_view::npos;
}

/// The numbers of a line; nullopt when it holds anything else.
std::optional<std::vector<double>> numbersOf(std::string_view line) {
  std::vector<double> numbers;
  for (const std::string& field : fieldsOf(line, separatorIsComma(line) ? ',' : ' ')) {
    const auto number = report::numberFrom(field);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

class MotReader {
 public:
  MotReader(const TextFile& file, const ImportOptions& options)
      : file_(file),
        options_(options),
        builder_("MOTChallenge", file, options),
        rays_(ImageRays::from(options, file)) {}

  Recording read() {
    if (!options_.frame_rate)
      throw file_.error(
          0, "frames are numbers: state how many there are in a second with --frame-rate, for instance 30");
    sensor_ = builder_.sensorOr("", 0);
    double last = 0.0;
    for (std::size_t line = 1; line <= file_.lines(); ++line) {
      if (file_.line(line).empty()) continue;
      const auto numbers = numbersOf(file_.line(line));
      if (!numbers || numbers->size() < kLeastFields || numbers->size() > kMostFields) {
        throw file_.error(
            line, "expected 7 to 10 numbers: frame, id, left, top, width, height, confidence, got \"" +
                      std::string(file_.line(line)) + "\": is the line complete?");
      }
      last = std::max(last, readBox(line, *numbers));
    }
    const auto frames = static_cast<std::int64_t>(last);
    for (std::int64_t frame = 1; frame <= frames; ++frame)
      builder_.addEmpty(0, timeOf(static_cast<double>(frame)), sensor_);
    builder_.remark(
        "the middles of the boxes, the first pixel being 1; frame 1 is at time 0 plus --offset; frames up "
        "to " +
        std::to_string(frames) + " without a box saw nothing");
    return builder_.finish();
  }

 private:
  core::Time timeOf(double frame) const {
    return core::Time{} + core::durationOf((frame - 1.0) / *options_.frame_rate);
  }

  /// The number of the frame.
  double readBox(std::size_t line, const std::vector<double>& box) {
    const double frame = box[0];
    if (!(frame >= 1.0 && frame <= kMostFrames) || frame != std::floor(frame))
      throw file_.error(line, "frame: expected a whole number from 1, got " + fieldText(line, 0));
    if (!(box[4] > 0.0) || !(box[5] > 0.0))
      throw file_.error(line, "width and height: expected pixels above 0, got " + fieldText(line, 4) +
                                  " and " + fieldText(line, 5));
    // In a truth, of 9 fields, the seventh says whether the box counts.
    if (box.size() == kTruthFields && box[6] == 0.0) {
      builder_.count("boxes that are marked as not counting are left out", line);
      return frame;
    }
    if (box.size() != kTruthFields && options_.least_confidence && box[6] < *options_.least_confidence) {
      builder_.count("boxes below the least confidence are left out", line);
      return frame;
    }
    // The first pixel is 1, and a box of width 1 at 1 is that pixel.
    const Eigen::Vector2d middle(box[2] - 1.0 + 0.5 * (box[4] - 1.0), box[3] - 1.0 + 0.5 * (box[5] - 1.0));
    const auto ray = rays_.rayAt(middle);
    if (!ray) {
      builder_.count("boxes where no ray of the lens falls are left out", line);
      return frame;
    }
    FileSighting sighting;
    sighting.angles = ray->angles;
    if (options_.heading)
      sighting.angles.x() = core::wrapAngle(sighting.angles.x() + fromCompass(*options_.heading));
    if (options_.sigma_pixels) sighting.sigma = ray->jacobian.rowwise().norm() * *options_.sigma_pixels;
    if (box[1] > 0.0) sighting.target = std::to_string(static_cast<long long>(std::min(box[1], 1e15)));
    builder_.add(line, timeOf(frame), sensor_, sighting);
    return frame;
  }

  std::string fieldText(std::size_t line, std::size_t field) const {
    const std::string_view text = file_.line(line);
    return "\"" + fieldsOf(text, separatorIsComma(text) ? ',' : ' ').at(field) + "\"";
  }

  const TextFile& file_;
  const ImportOptions& options_;
  RecordingBuilder builder_;
  ImageRays rays_;
  std::string sensor_;
};

}  // namespace

bool isMotBoxes(const TextFile& file) {
  for (std::size_t line = 1; line <= file.lines(); ++line) {
    if (file.line(line).empty()) continue;
    const auto numbers = numbersOf(file.line(line));
    return numbers && numbers->size() >= kLeastFields && numbers->size() <= kMostFields &&
           (*numbers)[0] >= 1.0 && (*numbers)[0] == std::floor((*numbers)[0]) &&
           (*numbers)[1] == std::floor((*numbers)[1]);
  }
  return false;
}

Recording readMotBoxes(const TextFile& file, const ImportOptions& options) {
  return MotReader(file, options).read();
}

}  // namespace sightline::formats
