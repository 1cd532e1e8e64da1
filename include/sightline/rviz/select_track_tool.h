#pragma once

#include <QObject>
#include <QPoint>
#include <rviz/tool.h>

namespace Ogre {
class Viewport;
}

namespace sightline_rviz {

/// Where the mouse was pressed and released without being moved.
struct Click {
  QPoint pixel;  ///< from the upper left corner of `viewport`
  Ogre::Viewport* viewport = nullptr;
};

/// The tool `sightline/SelectTrack` of rviz: moves the camera as the usual tool does, and tells of clicks.
class SelectTrackTool : public rviz::Tool {
  Q_OBJECT
 public:
  SelectTrackTool();

  void activate() override;
  void deactivate() override {}
  int processMouseEvent(rviz::ViewportMouseEvent& event) override;

 Q_SIGNALS:
  void clicked(const sightline_rviz::Click& click);

 private:
  QPoint pressed_;
};

}  // namespace sightline_rviz
