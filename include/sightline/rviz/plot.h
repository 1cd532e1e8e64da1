#pragma once

#include <QImage>
#include <QPainter>
#include <QString>
#include <QWidget>
#include <vector>

namespace sightline_rviz {

/// An axis of a plot: linear, or logarithmic with `low` > 0.
struct Axis {
  double low = 0.0, high = 1.0;
  bool is_logarithmic = false;

  /// In [0, 1] from low to high, not limited.
  double share(double value) const;

  /// Where numbers stand: steps of 1, 2 or 5 times a power of ten, or powers of ten.
  std::vector<double> ticks() const;
};

bool operator==(const Axis& a, const Axis& b);

/// A frame with axes, and in it what a subclass draws. The frame is drawn once and kept, dots are set pixel
/// by pixel: thousands of them in a frame take less than a millisecond.
class Plot : public QWidget {
  Q_OBJECT
 public:
  Plot(const QString& title, QWidget* parent);

  QSize sizeHint() const override { return {260, 150}; }
  QSize minimumSizeHint() const override { return {140, 90}; }

  /// A text beside the title.
  const QString& note() const { return note_; }

 protected:
  void setAxes(const Axis& x, const Axis& y);
  void setNote(const QString& note);
  void setTitle(const QString& title);

  /// Behind the axes' lines; drawn only when the frame is.
  virtual void drawBackdrop(QPainter& painter) { Q_UNUSED(painter) }
  virtual void drawData(QPainter& painter) = 0;

  const Axis& x() const { return x_; }
  const Axis& y() const { return y_; }
  QRect area() const;                           ///< inside of the axes [pixel]
  QPointF at(double x, double y) const;         ///< [pixel]
  void dot(double x, double y, QRgb colour);    ///< 3 x 3 pixels without corners; on the rim when outside
  void cross(double x, double y, QRgb colour);  ///< likewise, 5 x 5

  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void drawFrame();
  QPoint pixelAt(double x, double y) const;
  void setPixel(int column, int row, QRgb colour);

  QString title_, note_;
  Axis x_, y_;
  QImage frame_, picture_;
};

/// "1500", "0.05", "1e-06".
QString tickText(double value);

}  // namespace sightline_rviz
