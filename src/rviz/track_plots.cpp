#include "sightline/rviz/track_plots.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sightline/core/model/chi_square.h"
#include "sightline/core/model/sphere.h"
#include "sightline/report/value_text.h"
#include "sightline/rviz/palette.h"

namespace sightline_rviz {
namespace {

using sightline_ros::InspectorModel;
using sightline_ros::SensorGate;
using sightline_ros::SightingPoint;
using sightline_ros::SpreadPoint;

constexpr double kLeastNis = 0.01, kMostNis = 100.0;
constexpr double kOutside = 0.025;     // on either side of a band of 95 %
constexpr double kBeyondGate = 1.25;   // of the plot, over the largest gate
constexpr double kMrad = 1e3;          // in a radian
constexpr int kCorners = 48;           // of an ellipse
constexpr double kBeyondSpread = 1.3;  // above and below the lines, as a factor

Axis lastMinute() {
  return {-InspectorModel::kSpan, 0.0, false};
}

QRgb colourOf(const std::vector<QRgb>& colours, std::uint16_t sensor) {
  return sensor < colours.size() ? colours[sensor] : palette::kText;
}

/// 1, 2 or 5 times a power of ten, at least `value` > 0.
double roundedUp(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= value * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

/// Mean of those taken in each second, the oldest first.
std::vector<QPointF> meansBySecond(const std::vector<SightingPoint>& points) {
  constexpr auto kSeconds = static_cast<std::size_t>(InspectorModel::kSpan);
  std::array<double, kSeconds> sums{}, counts{};
  for (const SightingPoint& point : points) {
    if (!point.is_taken || !(point.age >= 0.0F) || !(point.age < static_cast<float>(kSeconds))) continue;
    const auto second = static_cast<std::size_t>(point.age);
    sums[second] += point.squared;
    counts[second] += 1.0;
  }
  std::vector<QPointF> means;
  for (std::size_t second = kSeconds; second-- > 0;) {
    if (counts[second] > 0.0)
      means.emplace_back(-(static_cast<double>(second) + 0.5), sums[second] / counts[second]);
  }
  return means;
}

}  // namespace

NisPlot::NisPlot(QWidget* parent) : Plot("normalised innovation squared, band of 95 %", parent) {
  setAxes(lastMinute(), {kLeastNis, kMostNis, true});
}

void NisPlot::draw(const sightline_ros::TrackDetail& detail, const std::vector<QRgb>& colours) {
  points_ = detail.sightings;
  colours_ = colours;
  means_ = meansBySecond(points_);
  const auto& nis = detail.nis;
  setNote(nis.count == 0 ? "no sighting taken"
                         : QString("mean %1 of %2, honest: %3 to %4")
                               .arg(nis.mean, 0, 'f', 2)
                               .arg(nis.count)
                               .arg(nis.low, 0, 'f', 2)
                               .arg(nis.high, 0, 'f', 2));
  update();
}

void NisPlot::drawBackdrop(QPainter& painter) {
  using sightline::core::chiSquareQuantile2;
  const QPointF from = at(x().low, chiSquareQuantile2(1.0 - kOutside)),
                to = at(x().high, chiSquareQuantile2(kOutside));
  painter.fillRect(QRectF(from, to), QColor(palette::kBand));
}

void NisPlot::drawData(QPainter& painter) {
  for (const SightingPoint& point : points_) {
    if (!(point.age <= InspectorModel::kSpan)) continue;
    const double time = -std::max(point.age, 0.0F);
    if (point.is_taken)
      dot(time, point.squared, colourOf(colours_, point.sensor));
    else
      cross(time, point.squared, palette::kBad);
  }
  QPolygonF line;
  for (const QPointF& mean : means_) line.append(at(mean.x(), mean.y()));
  painter.setPen(QPen(QColor(palette::kPlotGround), 4.0));
  painter.drawPolyline(line);
  painter.setPen(QPen(QColor(palette::kText), 2.0));
  painter.drawPolyline(line);
}

InnovationPlot::InnovationPlot(QWidget* parent) : Plot("innovations [mrad]", parent) {
  setAxes({-1.0, 1.0, false}, {-1.0, 1.0, false});
}

void InnovationPlot::draw(const sightline_ros::TrackDetail& detail, const std::vector<QRgb>& colours) {
  points_ = detail.sightings;
  gates_ = detail.gates;
  colours_ = colours;
  double reach = 0.0;
  for (const SensorGate& gate : gates_)
    reach =
        std::max<double>(reach, std::sqrt(gate.threshold * std::max(gate.covariance[0], gate.covariance[2])));
  if (reach > 0.0 && std::isfinite(reach)) {
    const double half = roundedUp(kBeyondGate * kMrad * reach);
    setAxes({-half, half, false}, {-half, half, false});
  }
  const auto refused = std::count_if(points_.begin(), points_.end(),
                                     [](const SightingPoint& point) { return !point.is_taken; });
  setNote(QString("%1 refused").arg(refused));
  update();
}

void InnovationPlot::drawData(QPainter& painter) {
  for (const SightingPoint& point : points_) {
    if (point.is_taken)
      dot(kMrad * point.x, kMrad * point.y, colourOf(colours_, point.sensor));
    else
      cross(kMrad * point.x, kMrad * point.y, palette::kBad);
  }
  painter.setRenderHint(QPainter::Antialiasing);
  for (const SensorGate& gate : gates_) {  // S = L L^T
    const double a = std::sqrt(gate.covariance[0]), b = gate.covariance[1] / a;
    const double c = std::sqrt(std::max(gate.covariance[2] - b * b, 0.0)),
                 scale = kMrad * std::sqrt(gate.threshold);
    QPolygonF rim;
    for (int corner = 0; corner < kCorners; ++corner) {
      const double angle = 2.0 * sightline::core::kPi * corner / kCorners;
      rim.append(at(scale * a * std::cos(angle), scale * (b * std::cos(angle) + c * std::sin(angle))));
    }
    painter.setPen(QPen(QColor(colourOf(colours_, gate.sensor)), 1.2));
    painter.drawPolygon(rim);
  }
}

SpreadPlot::SpreadPlot(QWidget* parent) : Plot("sigma (white), gate (green) [mrad]", parent) {
  setAxes(lastMinute(), {0.1, 10.0, true});
}

void SpreadPlot::draw(const sightline_ros::TrackDetail& detail) {
  points_ = detail.spread;
  const bool is_position = detail.row && detail.row->kind == sightline_ros::TrackKind::position;
  unit_ = is_position ? 1.0 : kMrad;
  setTitle(is_position ? "sigma [m]" : "sigma (white), gate (green) [mrad]");
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const SpreadPoint& point : points_) {
    for (const float value : {point.sigma, point.gate}) {
      if (!(value > 0.0F) || !std::isfinite(value)) continue;
      least = std::min<double>(least, unit_ * value);
      most = std::max<double>(most, unit_ * value);
    }
  }
  if (most > 0.0) {
    const double low = std::pow(10.0, std::floor(std::log10(least / kBeyondSpread)));
    const double high = std::pow(10.0, std::ceil(std::log10(most * kBeyondSpread)));
    setAxes(lastMinute(), {low, high, true});
  }
  QString note;
  if (!points_.empty()) {
    const SpreadPoint& now = points_.back();
    note = QString::number(unit_ * now.sigma, 'g', 3);
    if (now.gate > 0.0F) note += QString(", %1").arg(unit_ * now.gate, 0, 'g', 3);
  }
  setNote(note);
  update();
}

void SpreadPlot::drawLine(QPainter& painter, float SpreadPoint::*value) const {
  constexpr float kGap = 1.0F;  // from which a line is interrupted [s]
  QPolygonF line;
  float before = std::numeric_limits<float>::infinity();
  for (const SpreadPoint& point : points_) {
    if (before - point.age > kGap) {
      painter.drawPolyline(line);
      line.clear();
    }
    before = point.age;
    if (point.*value > 0.0F && std::isfinite(point.*value)) line.append(at(-point.age, unit_ * point.*value));
  }
  painter.drawPolyline(line);
}

void SpreadPlot::drawData(QPainter& painter) {
  painter.setPen(QPen(QColor(palette::kGood), 1.0));
  drawLine(painter, &SpreadPoint::gate);
  painter.setPen(QPen(QColor(palette::kText), 1.5));
  drawLine(painter, &SpreadPoint::sigma);
}

}  // namespace sightline_rviz
