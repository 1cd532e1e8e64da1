#include <QApplication>
#include <QTimer>
#include <string>

#include <ros/init.h>

#include "sightline/rviz/inspector_window.h"

/// The panel as a window of its own, without rviz.
int main(int argc, char** argv) {
  ros::init(argc, argv, "track_inspector");
  QApplication application(argc, argv);
  const ros::NodeHandle keeps_ros_running;
  sightline_rviz::InspectorWindow window;
  window.setWindowTitle("sightline: track inspector");
  window.resize(640, 900);
  window.show();
  QTimer end;
  QObject::connect(&end, &QTimer::timeout, &application, [] {
    if (!ros::ok()) QApplication::quit();
  });
  end.start(200);
  return QApplication::exec();
}
