#pragma once

#include <vector>

#include "sightline/ros/inspector/inspector_model.h"
#include "sightline/rviz/plot.h"

/// What the panel draws of the selected track. Colours of sensors are handed in, by their place in
/// TrackDetail::sensors.
namespace sightline_rviz {

/// Normalised innovations squared over the last minute on a logarithmic scale, with the band in which 95 % of
/// an honest track's lie, and their mean by the second. Refused sightings are crosses.
class NisPlot : public Plot {
  Q_OBJECT
 public:
  explicit NisPlot(QWidget* parent);
  void draw(const sightline_ros::TrackDetail& detail, const std::vector<QRgb>& colours);

 protected:
  void drawBackdrop(QPainter& painter) override;
  void drawData(QPainter& painter) override;

 private:
  std::vector<sightline_ros::SightingPoint> points_;
  std::vector<QPointF> means_;  // age and mean, by the second
  std::vector<QRgb> colours_;
};

/// Innovations, in mrad, with the newest gate of each sensor. What is outside lies on the rim.
class InnovationPlot : public Plot {
  Q_OBJECT
 public:
  explicit InnovationPlot(QWidget* parent);
  void draw(const sightline_ros::TrackDetail& detail, const std::vector<QRgb>& colours);

 protected:
  void drawData(QPainter& painter) override;

 private:
  std::vector<sightline_ros::SightingPoint> points_;
  std::vector<sightline_ros::SensorGate> gates_;
  std::vector<QRgb> colours_;
};

/// Sigma and half width of the gate over the last minute, in mrad, of a position sigma in m.
class SpreadPlot : public Plot {
  Q_OBJECT
 public:
  explicit SpreadPlot(QWidget* parent);
  void draw(const sightline_ros::TrackDetail& detail);

 protected:
  void drawData(QPainter& painter) override;

 private:
  void drawLine(QPainter& painter, float sightline_ros::SpreadPoint::*value) const;

  std::vector<sightline_ros::SpreadPoint> points_;
  double unit_ = 1e3;  // from what the points have
};

}  // namespace sightline_rviz
