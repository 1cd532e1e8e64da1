#include "sightline/rviz/plot.h"

#include <QResizeEvent>
#include <algorithm>
#include <cmath>

#include "sightline/rviz/palette.h"

namespace sightline_rviz {
namespace {

constexpr int kLeft = 42, kRight = 8, kTop = 18, kBottom = 18;  // margins [pixel]
constexpr int kLetters = 11;                                    // height [pixel]
constexpr double kMostTicks = 6.0;
constexpr double kTolerance = 1e-9;  // of a tick beside the axis's end, relative to its length

}  // namespace

double Axis::share(double value) const {
  if (!is_logarithmic) return (value - low) / (high - low);
  return std::log(std::max(value, 1e-300) / low) / std::log(high / low);
}

std::vector<double> Axis::ticks() const {
  std::vector<double> ticks;
  if (is_logarithmic) {
    for (double exponent = std::ceil(std::log10(low) - kTolerance); exponent <= std::log10(high) + kTolerance;
         exponent += 1.0)
      ticks.push_back(std::pow(10.0, exponent));
    return ticks;
  }
  const double length = high - low;
  if (!(length > 0.0) || !std::isfinite(length)) return ticks;
  double step = std::pow(10.0, std::floor(std::log10(length / kMostTicks)));
  for (const double factor : {2.0, 2.5, 2.0}) {  // 1, 2, 5, 10
    if (length / step <= kMostTicks) break;
    step *= factor;
  }
  const double first = std::ceil(low / step - kTolerance);
  for (double number = first; number * step <= high + kTolerance * length; number += 1.0)
    ticks.push_back(number * step);
  return ticks;
}

bool operator==(const Axis& a, const Axis& b) {
  return a.low == b.low && a.high == b.high && a.is_logarithmic == b.is_logarithmic;
}

QString tickText(double value) {
  return QString::number(std::abs(value) < 1e-12 ? 0.0 : value, 'g', 5);
}

Plot::Plot(const QString& title, QWidget* parent) : QWidget(parent), title_(title) {
  setAttribute(Qt::WA_OpaquePaintEvent);
}

void Plot::setAxes(const Axis& x, const Axis& y) {
  if (x == x_ && y == y_) return;
  x_ = x;
  y_ = y;
  frame_ = QImage();
}

void Plot::setNote(const QString& note) {
  if (note == note_) return;
  note_ = note;
  frame_ = QImage();
}

void Plot::setTitle(const QString& title) {
  if (title == title_) return;
  title_ = title;
  frame_ = QImage();
}

QRect Plot::area() const {
  return {kLeft, kTop, std::max(width() - kLeft - kRight, 1), std::max(height() - kTop - kBottom, 1)};
}

QPointF Plot::at(double x, double y) const {
  const QRect inside = area();
  return {inside.left() + x_.share(x) * (inside.width() - 1),
          inside.bottom() - y_.share(y) * (inside.height() - 1)};
}

QPoint Plot::pixelAt(double x, double y) const {
  const QPointF exact = at(x, y);
  const QRect inside = area();
  const auto limited = [](double value, int low, int high) {
    return static_cast<int>(std::lround(std::clamp<double>(value, low, high)));
  };
  return {limited(exact.x(), inside.left(), inside.right()),
          limited(exact.y(), inside.top(), inside.bottom())};
}

void Plot::setPixel(int column, int row, QRgb colour) {
  if (column < 0 || row < 0 || column >= picture_.width() || row >= picture_.height()) return;
  reinterpret_cast<QRgb*>(picture_.scanLine(row))[column] = colour;
}

void Plot::dot(double x, double y, QRgb colour) {
  const QPoint pixel = pixelAt(x, y);
  setPixel(pixel.x(), pixel.y(), colour);
  for (const int step : {-1, 1}) {
    setPixel(pixel.x() + step, pixel.y(), colour);
    setPixel(pixel.x(), pixel.y() + step, colour);
  }
}

void Plot::cross(double x, double y, QRgb colour) {
  const QPoint pixel = pixelAt(x, y);
  for (int step = -2; step <= 2; ++step) {
    setPixel(pixel.x() + step, pixel.y() + step, colour);
    setPixel(pixel.x() + step, pixel.y() - step, colour);
  }
}

void Plot::drawFrame() {
  frame_ = QImage(size(), QImage::Format_RGB32);
  frame_.fill(palette::kGround);
  QPainter painter(&frame_);
  QFont font = painter.font();
  font.setPixelSize(kLetters);
  painter.setFont(font);
  const QRect inside = area();
  painter.fillRect(inside, QColor(palette::kPlotGround));
  painter.setClipRect(inside);
  drawBackdrop(painter);
  painter.setClipping(false);
  const auto drawTick = [&](const QPointF& from, const QPointF& to) {
    painter.setPen(QColor(palette::kGrid));
    painter.drawLine(from, to);
    painter.setPen(QColor(palette::kFaintText));
  };
  for (const double tick : x_.ticks()) {
    const double column = at(tick, y_.low).x();
    drawTick({column, static_cast<double>(inside.top())}, {column, static_cast<double>(inside.bottom())});
    const double left = std::min(
        column - 30, width() - 60 + (60 - painter.fontMetrics().horizontalAdvance(tickText(tick))) / 2.0);
    painter.drawText(QRectF(left, inside.bottom() + 2, 60, kBottom - 2), Qt::AlignHCenter | Qt::AlignTop,
                     tickText(tick));
  }
  for (const double tick : y_.ticks()) {
    const double row = at(x_.low, tick).y();
    drawTick({static_cast<double>(inside.left()), row}, {static_cast<double>(inside.right()), row});
    painter.drawText(QRectF(0, row - 8, kLeft - 4, 16), Qt::AlignRight | Qt::AlignVCenter, tickText(tick));
  }
  painter.setPen(QColor(palette::kFaintText));
  painter.drawRect(inside.adjusted(0, 0, -1, -1));
  painter.setPen(QColor(palette::kText));
  painter.drawText(QRect(4, 0, width() - 8, kTop), Qt::AlignLeft | Qt::AlignVCenter, title_);
  const int room = width() - 16 - painter.fontMetrics().horizontalAdvance(title_);
  painter.setPen(QColor(palette::kFaintText));
  painter.drawText(QRect(4, 0, width() - 8, kTop), Qt::AlignRight | Qt::AlignVCenter,
                   painter.fontMetrics().elidedText(note_, Qt::ElideRight, std::max(room, 0)));
}

void Plot::paintEvent(QPaintEvent*) {
  if (frame_.size() != size()) drawFrame();
  picture_ = frame_.copy();
  {
    QPainter painter(&picture_);
    painter.setClipRect(area());
    drawData(painter);
  }
  QPainter(this).drawImage(0, 0, picture_);
}

void Plot::resizeEvent(QResizeEvent* event) {
  frame_ = QImage();
  QWidget::resizeEvent(event);
}

}  // namespace sightline_rviz
