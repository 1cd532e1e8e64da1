// The spot detector: probability of detection, false spots and the centre's error on simulated spots of known
// place (with its stated covariance: NEES, 1 is honest) and on recorded infrared clips with labelled boxes;
// time a frame.
//
//   spots [CLIPS [OUT]]
//
// CLIPS: folder with NAME.mp4 and NAME_boxes.csv (frame,t_s,class,x,y,w,h; frames from 1, top left in
// pixels); by default data/infrared of SIGHTLINE_SHARED_DIR, and without either only the simulation runs.
// OUT: folder for pictures of some frames, and for each clip a CSV of its sightings (for csv_to_bag) and of
// the boxes' centres (for evaluate --truth).

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "sightline/core/association/assignment.h"
#include "sightline/core/imaging/spot_detector.h"
#include "sightline/core/simulation/random_stream.h"
#include "sightline/report/output_file.h"

#include "quantiles.h"

namespace sightline::bench {
namespace {

using core::SpotDetector;
using core::SpotDetectorParams;
using Background = SpotDetectorParams::Background;

// ---- simulated spots
// --------------------------------------------------------------------------------------------------

constexpr double kNoise = 10.0;  // [grey levels]

/// A sloping sky with white noise, 640x512.
std::vector<float> sky(core::RandomStream& stream) {
  std::vector<float> image(640 * 512);
  for (std::size_t i = 0; i < image.size(); i += 2) {
    const double slope = 3000.0 + 0.5 * static_cast<double>(i % 640) + 1.5 * static_cast<double>(i / 640);
    const Eigen::Vector2d noise = kNoise * stream.normalPair();
    image[i] = static_cast<float>(slope + noise.x());
    image[i + 1] = static_cast<float>(slope + noise.y());
  }
  return image;
}

/// Adds a Gaussian spot, integrated over each pixel.
void addSpot(std::vector<float>& image, const Eigen::Vector2d& centre, double sigma, double peak) {
  const auto share = [sigma](double from, double c) {
    const double scale = 1.0 / (sigma * std::sqrt(2.0));
    return 0.5 * (std::erf((from + 0.5 - c) * scale) - std::erf((from - 0.5 - c) * scale));
  };
  const double total = peak * 2.0 * 3.14159265358979 * sigma * sigma;
  const int reach = static_cast<int>(std::ceil(6.0 * sigma));
  const int u = static_cast<int>(std::lround(centre.x())), v = static_cast<int>(std::lround(centre.y()));
  for (int y = v - reach; y <= v + reach; ++y)
    for (int x = u - reach; x <= u + reach; ++x)
      image[static_cast<std::size_t>(y * 640 + x)] +=
          static_cast<float>(total * share(x, centre.x()) * share(y, centre.y()));
}

void simulate(double sigma, double peak_over_noise) {
  SpotDetectorParams params;
  params.threshold = 6.0;
  params.centroid_floor = 0.0;
  params.max_spots = 1000;
  SpotDetector detector(params);
  core::RandomStream stream(core::seedOf(1, std::to_string(sigma) + " " + std::to_string(peak_over_noise)));
  int seen = 0, offered = 0, false_spots = 0;
  double squared_error = 0.0, nees = 0.0, snr = 0.0;
  constexpr int kFrames = 40;
  for (int frame = 0; frame < kFrames; ++frame) {
    std::vector<float> image = sky(stream);
    std::vector<Eigen::Vector2d> truth;
    for (int v = 40; v < 500; v += 48)
      for (int u = 40; u < 620; u += 48) truth.emplace_back(u + stream.uniform(), v + stream.uniform());
    for (const auto& centre : truth) addSpot(image, centre, sigma, peak_over_noise * kNoise);
    offered += static_cast<int>(truth.size());
    for (const core::Spot& spot : detector.detect({image.data(), 640, 512})) {
      const auto nearest = std::min_element(truth.begin(), truth.end(), [&](const auto& a, const auto& b) {
        return (a - spot.pixel).squaredNorm() < (b - spot.pixel).squaredNorm();
      });
      const Eigen::Vector2d error = spot.pixel - *nearest;
      if (error.norm() > 4.0) {
        ++false_spots;
        continue;
      }
      ++seen;
      squared_error += error.squaredNorm() / 2.0;
      nees += error.dot(spot.covariance.llt().solve(error)) / 2.0;
      snr += spot.snr;
    }
  }
  std::printf("%9.1f %10.1f %8.1f %7.1f %% %10.4f %9.3f px %7.2f\n", sigma, peak_over_noise, snr / seen,
              100.0 * seen / offered, static_cast<double>(false_spots) / kFrames,
              std::sqrt(squared_error / seen), nees / seen);
}

void printSimulation() {
  std::printf(
      "Simulated Gaussian spots in white noise, 640x512, 130 a frame, threshold 6, floor of the centroid 0\n"
      "%9s %10s %8s %9s %10s %12s %7s\n",
      "sigma px", "peak/noise", "SNR", "detected", "false", "rms error", "NEES");
  for (const double sigma : {0.7, 1.0, 1.5, 2.5})
    for (const double peak : {5.0, 7.0, 10.0, 20.0, 50.0}) simulate(sigma, peak);
}

void printSpeed() {
  core::RandomStream stream(7);
  std::vector<std::vector<float>> frames;
  for (int i = 0; i < 8; ++i) {
    frames.push_back(sky(stream));
    for (int k = 0; k < 10; ++k)
      addSpot(frames.back(), {40.0 + 55.0 * k + 0.3 * i, 60.0 + 40.0 * k + 0.2 * i}, 1.2, 200.0);
  }
  for (const Background background : {Background::spatial, Background::temporal}) {
    SpotDetectorParams params;
    params.background = background;
    SpotDetector detector(params);
    std::vector<double> times;  // [ms]
    for (int i = 0; i < 300; ++i) {
      const std::clock_t start = std::clock();  // processor time
      detector.detect({frames[static_cast<std::size_t>(i % 8)].data(), 640, 512});
      times.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    std::printf("640x512, 10 spots, %s background: %.2f ms a frame (median of 300)\n",
                background == Background::spatial ? "spatial" : "temporal", median(times));
  }
}

// ---- recorded clips
// ---------------------------------------------------------------------------------------------------

struct Box {
  double x = 0.0, y = 0.0, w = 0.0, h = 0.0;  // [px]

  Eigen::Vector2d centre() const { return {x + 0.5 * (w - 1.0), y + 0.5 * (h - 1.0)}; }
  bool holds(const Eigen::Vector2d& pixel, double margin) const {
    return pixel.x() >= x - margin && pixel.x() <= x + w - 1.0 + margin && pixel.y() >= y - margin &&
           pixel.y() <= y + h - 1.0 + margin;
  }
};

std::multimap<int, Box> readBoxes(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  std::multimap<int, Box> boxes;
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    int frame = 0;
    double time = 0.0;
    std::string kind;
    Box box;
    if (!(row >> frame >> time >> kind >> box.x >> box.y >> box.w >> box.h)) continue;
    box.x -= 1.0, box.y -= 1.0;  // the labels come from MATLAB, whose first pixel is 1
    boxes.emplace(frame, box);
  }
  return boxes;
}

/// Numbers the boxes of a clip so that a target keeps its number: the labels have none.
class TargetNumbers {
 public:
  /// For each box of a frame the number of its target, from 1 on.
  std::vector<int> of(const std::vector<Box>& boxes, int frame) {
    constexpr int kForgotten = 15;      // frames without its box after which a target is gone
    constexpr double kFarthest = 12.0;  // [px] between boxes of one target
    for (auto target = last_.begin(); target != last_.end();)
      target = frame - target->second.frame > kForgotten ? last_.erase(target) : std::next(target);
    std::vector<int> known;
    for (const auto& [number, seen] : last_) known.push_back(number);
    Eigen::MatrixXd cost(boxes.size(), known.size());
    for (Eigen::Index i = 0; i < cost.rows(); ++i)
      for (Eigen::Index j = 0; j < cost.cols(); ++j) {
        const double distance = (boxes[i].centre() - last_.at(known[j]).centre).norm();
        cost(i, j) = distance <= kFarthest ? distance : std::numeric_limits<double>::infinity();
      }
    std::vector<int> numbers;
    for (const int j : core::assign(cost)) numbers.push_back(j >= 0 ? known[j] : ++newest_);
    for (std::size_t i = 0; i < boxes.size(); ++i) last_[numbers[i]] = {boxes[i].centre(), frame};
    return numbers;
  }

 private:
  struct Seen {
    Eigen::Vector2d centre;  // [px]
    int frame = 0;
  };

  std::map<int, Seen> last_;  // by number
  int newest_ = 0;
};

struct ClipFigures {
  int frames = 0, boxes = 0, seen = 0, false_spots = 0;
  std::vector<double> errors;  // distance of the spot from the box's centre [px]
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  double squared_scatter = 0.0;  // second differences of the centres, see below

  void add(const ClipFigures& other) {
    frames += other.frames, boxes += other.boxes, seen += other.seen, false_spots += other.false_spots;
    errors.insert(errors.end(), other.errors.begin(), other.errors.end());
  }
};

/// Draws boxes and spots, three times as large.
cv::Mat picture(const cv::Mat& grey, const std::vector<core::Spot>& spots, const std::vector<Box>& boxes) {
  constexpr int kZoom = 3;
  cv::Mat large;
  cv::resize(grey, large, {}, kZoom, kZoom, cv::INTER_NEAREST);
  cv::cvtColor(large, large, cv::COLOR_GRAY2BGR);
  for (const Box& box : boxes)
    cv::rectangle(large, cv::Rect2d(kZoom * box.x, kZoom * box.y, kZoom * box.w, kZoom * box.h), {0, 255, 0});
  for (const core::Spot& spot : spots) {
    const cv::Point centre(static_cast<int>(kZoom * (spot.pixel.x() + 0.5)),
                           static_cast<int>(kZoom * (spot.pixel.y() + 0.5)));
    cv::drawMarker(large, centre, {0, 0, 255}, cv::MARKER_CROSS, 14);
    cv::circle(large, centre, 12, {0, 0, 255});
  }
  return large;
}

/// 24 x 19 degrees over 320 x 256: small enough for pixels times a constant.
constexpr double kRadiansPerPixel = 24.0 / 320.0 * 3.14159265358979323846 / 180.0;

Eigen::Vector2d anglesOfPixel(const Eigen::Vector2d& pixel) {
  return kRadiansPerPixel * (Eigen::Vector2d(159.5, 127.5) - pixel);
}

ClipFigures runClip(const std::string& folder, const std::string& name, const SpotDetectorParams& params,
                    const std::string& out) {
  const auto boxes = readBoxes(folder + "/" + name + "_boxes.csv");
  cv::VideoCapture video(folder + "/" + name + ".mp4");
  if (!video.isOpened()) throw std::runtime_error(folder + "/" + name + ".mp4: cannot be opened");
  SpotDetector detector(params);
  std::optional<report::TextFile> sightings, truth;
  if (!out.empty()) {
    sightings.emplace(out + "/" + name + ".csv");
    truth.emplace(out + "/" + name + "_truth.csv");
    sightings->stream() << "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation,scan\n";
    truth->stream() << "time,target,azimuth,elevation\n";
  }
  ClipFigures figures;
  TargetNumbers numbers;
  cv::Mat frame, grey;
  cv::Mat pixels;
  for (int number = 1; video.read(frame); ++number) {
    cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
    grey.convertTo(pixels, CV_32F);
    const auto& spots = detector.detect({pixels.ptr<float>(), pixels.cols, pixels.rows});
    if (!detector.isReady()) continue;
    std::vector<Box> here;
    for (auto [box, end] = boxes.equal_range(number); box != end; ++box) here.push_back(box->second);
    ++figures.frames;
    figures.boxes += static_cast<int>(here.size());
    for (const Box& box : here) {
      double nearest = 1e9;
      Eigen::Vector2d offset = Eigen::Vector2d::Zero();
      for (const core::Spot& spot : spots) {
        if (!box.holds(spot.pixel, 2.0) || (spot.pixel - box.centre()).norm() >= nearest) continue;
        offset = spot.pixel - box.centre();
        nearest = offset.norm();
      }
      if (nearest > 1e8) continue;
      ++figures.seen;
      figures.offset += offset;
      figures.errors.push_back(nearest);
    }
    for (const core::Spot& spot : spots) {
      const bool is_target =
          std::any_of(here.begin(), here.end(), [&](const Box& box) { return box.holds(spot.pixel, 2.0); });
      figures.false_spots += is_target ? 0 : 1;
    }
    if (out.empty()) continue;
    const double time = 100.0 + (number - 1) / 30.0;
    for (const core::Spot& spot : spots) {
      const Eigen::Vector2d angles = anglesOfPixel(spot.pixel),
                            sigma = kRadiansPerPixel * spot.covariance.diagonal().cwiseSqrt();
      sightings->stream() << std::to_string(time) << ",infrared," << angles.x() << ',' << angles.y() << ','
                          << sigma.x() << ',' << sigma.y() << ',' << number << '\n';
    }
    const std::vector<int> targets = numbers.of(here, number);
    for (std::size_t i = 0; i < here.size(); ++i) {
      const Eigen::Vector2d angles = anglesOfPixel(here[i].centre());
      truth->stream() << std::to_string(time) << ',' << targets[i] << ',' << angles.x() << ',' << angles.y()
                      << '\n';
    }
    if (number == 60 || number == 150 || number == 240)
      cv::imwrite(out + "/" + name + "_" + std::to_string(number) + ".png", picture(grey, spots, here));
  }
  if (sightings) sightings->finish();
  if (truth) truth->finish();
  return figures;
}

void printRow(const std::string& name, const ClipFigures& figures) {
  std::printf("%-20s %7d %7d %8.1f %% %11.3f %10.2f px %7.2f px", name.c_str(), figures.frames, figures.boxes,
              100.0 * figures.seen / std::max(figures.boxes, 1),
              static_cast<double>(figures.false_spots) / std::max(figures.frames, 1), median(figures.errors),
              quantile(figures.errors, 0.9));
  if (figures.seen > 0 && !figures.offset.isZero())
    std::printf("   (%+.2f, %+.2f)", figures.offset.x() / figures.seen, figures.offset.y() / figures.seen);
  std::printf("\n");
}

void printClips(const std::string& folder, const std::string& out) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".mp4") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  for (const Background background : {Background::spatial, Background::temporal}) {
    SpotDetectorParams params;
    params.background = background;
    const bool is_temporal = background == Background::temporal;
    std::printf(
        "\nRecorded clips, %s background, otherwise default settings\n%-20s %7s %7s %10s %11s %13s %10s   "
        "%s\n",
        is_temporal ? "temporal" : "spatial", "clip", "frames", "boxes", "detected", "false/frame",
        "error median", "90 %", "mean offset px");
    ClipFigures all;
    for (const std::string& name : names) {
      const ClipFigures figures = runClip(folder, name, params, is_temporal ? out : "");
      printRow(name, figures);
      all.add(figures);
    }
    printRow("all", all);
  }
}

}  // namespace
}  // namespace sightline::bench

int main(int argc, char** argv) {
  using namespace sightline::bench;
  if (argc > 3) {
    std::fprintf(stderr, "usage: spots [CLIPS [OUT]]\n");
    return 2;
  }
  const char* shared = std::getenv("SIGHTLINE_SHARED_DIR");
  const std::string folder = argc > 1            ? argv[1]
                             : shared != nullptr ? std::string(shared) + "/data/infrared"
                                                 : "";
  try {
    printSimulation();
    printSpeed();
    if (folder.empty() || !std::filesystem::is_directory(folder)) {
      std::printf("\nSKIPPED: recorded clips (%s)\n", folder.empty()
                                                          ? "no folder given, SIGHTLINE_SHARED_DIR not set"
                                                          : (folder + " is no folder").c_str());
    } else {
      printClips(folder, argc > 2 ? argv[2] : "");
    }
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "spots: %s\n", problem.what());
    return 1;
  }
  return 0;
}
