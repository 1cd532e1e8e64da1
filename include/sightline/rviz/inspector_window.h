#pragma once

#include <QTimer>
#include <QWidget>

#include "sightline/ros/inspector/inspector_feed.h"
#include "sightline/rviz/inspector_widget.h"

namespace sightline_rviz {

/// The panel's widget with a feed from ROS: all of the panel that needs no rviz. ROS must be initialised; the
/// private parameter `save_service` of the process names the flight recorder's service
/// (/flight_recorder/save).
class InspectorWindow : public QWidget {
  Q_OBJECT
 public:
  explicit InspectorWindow(QWidget* parent = nullptr);

  InspectorWidget& inspector() { return inspector_; }

 private:
  sightline_ros::InspectorFeed feed_;
  InspectorWidget inspector_;
  QTimer save_timer_;
};

}  // namespace sightline_rviz
