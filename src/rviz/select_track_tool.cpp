#include "sightline/rviz/select_track_tool.h"

#include <rviz/display_context.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <rviz/viewport_mouse_event.h>

#include <pluginlib/class_list_macros.hpp>

namespace sightline_rviz {
namespace {

constexpr int kStill = 4;  // by which the mouse may move in a click [pixel]

}  // namespace

SelectTrackTool::SelectTrackTool() {
  shortcut_key_ = 't';
}

void SelectTrackTool::activate() {
  setStatus("Click a track to inspect it; drag to move the camera.");
}

int SelectTrackTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  const QPoint pixel(event.x, event.y);
  if (event.leftDown()) pressed_ = pixel;
  if (event.leftUp() && (pixel - pressed_).manhattanLength() <= kStill)
    Q_EMIT clicked({pixel, event.viewport});
  rviz::ViewController* view = context_->getViewManager()->getCurrent();
  if (view != nullptr) view->handleMouseEvent(event);
  return Render;
}

}  // namespace sightline_rviz

PLUGINLIB_EXPORT_CLASS(sightline_rviz::SelectTrackTool, rviz::Tool)
