#pragma once

#include <Ogre.h>
#include <QTimer>
#include <memory>
#include <optional>
#include <rviz/panel.h>

#include "sightline/ros/inspector/track_rows.h"
#include "sightline/rviz/inspector_window.h"
#include "sightline/rviz/select_track_tool.h"

namespace sightline_rviz {

/// The panel `sightline/TrackInspector` of rviz. A click with the tool `sightline/SelectTrack` selects the
/// track beneath it.
class TrackInspectorPanel : public rviz::Panel {
  Q_OBJECT
 public:
  explicit TrackInspectorPanel(QWidget* parent = nullptr);

  void onInitialize() override;

 private:
  void listenTo(rviz::Tool* tool);
  void selectAt(const Click& click);
  void follow();
  void readRadius();
  std::optional<Ogre::Vector3> placeOf(const sightline_ros::TrackRow& row) const;

  InspectorWindow window_;
  QTimer follow_timer_;
  double radius_ = 10.0;  // of the sphere that directions are drawn on [m]
  bool was_following_ = false;
};

}  // namespace sightline_rviz
