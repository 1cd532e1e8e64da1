// The panel and its tool as rviz loads them: by pluginlib, from what the package exports.
#include <QApplication>
#include <QComboBox>
#include <QTableView>
#include <memory>
#include <rviz/panel.h>
#include <rviz/tool.h>

#include <gtest/gtest.h>

#include <pluginlib/class_loader.hpp>
#include <ros/ros.h>

namespace {

TEST(RvizPlugins, ThePanelIsLoadedAndShowsItsTables) {
  pluginlib::ClassLoader<rviz::Panel> loader("rviz", "rviz::Panel");
  ASSERT_TRUE(loader.isClassAvailable("sightline/TrackInspector"));
  const std::unique_ptr<rviz::Panel> panel(loader.createUnmanagedInstance("sightline/TrackInspector"));
  ASSERT_NE(panel, nullptr);
  panel->resize(600, 900);
  panel->show();
  QApplication::processEvents();
  EXPECT_NE(panel->findChild<QTableView*>("tracks"), nullptr);
  EXPECT_NE(panel->findChild<QComboBox*>("knob_nodes"), nullptr);
  EXPECT_FALSE(panel->grab().isNull());
}

TEST(RvizPlugins, TheToolIsLoaded) {
  pluginlib::ClassLoader<rviz::Tool> loader("rviz", "rviz::Tool");
  ASSERT_TRUE(loader.isClassAvailable("sightline/SelectTrack"));
  const std::unique_ptr<rviz::Tool> tool(loader.createUnmanagedInstance("sightline/SelectTrack"));
  ASSERT_NE(tool, nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "panel_plugin_test");
  const ros::NodeHandle keeps_ros_running;
  if (!qEnvironmentVariableIsSet("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
