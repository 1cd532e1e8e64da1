#include "sightline/rviz/track_inspector_panel.h"

#include <Ogre.h>
#include <QVBoxLayout>
#include <cmath>
#include <limits>
#include <rviz/frame_manager.h>
#include <rviz/properties/property.h>
#include <rviz/tool_manager.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <rviz/visualization_manager.h>

#include <pluginlib/class_list_macros.hpp>
#include <ros/param.h>

#include "sightline/core/model/sphere.h"

namespace sightline_rviz {
namespace {

using sightline_ros::TrackKind;
using sightline_ros::TrackRow;

constexpr int kFollowPeriod = 33;  // [ms]
constexpr double kReach = 25.0;    // from a click to the track that it means, at most [pixel]

/// On the screen, from the upper left corner [pixel]; nullopt behind the camera.
std::optional<QPointF> pixelOf(const Ogre::Vector3& point, const Ogre::Viewport& viewport) {
  const Ogre::Camera& camera = *viewport.getCamera();
  const Ogre::Vector4 clip = camera.getProjectionMatrix() *
                             (camera.getViewMatrix() * Ogre::Vector4(point.x, point.y, point.z, 1.0F));
  if (!(clip.w > 0.0F)) return std::nullopt;
  return QPointF(0.5 * (1.0 + clip.x / clip.w) * viewport.getActualWidth(),
                 0.5 * (1.0 - clip.y / clip.w) * viewport.getActualHeight());
}

/// Established before tentative, and global before local where they lie on each other.
double handicapOf(const TrackRow& row) {
  double pixels = row.kind == TrackKind::local ? 8.0 : 0.0;
  if (row.status == sightline::Track::TENTATIVE) pixels += 8.0;
  return pixels;
}

}  // namespace

TrackInspectorPanel::TrackInspectorPanel(QWidget* parent) : rviz::Panel(parent) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(&window_);
  connect(&follow_timer_, &QTimer::timeout, this, [this] { follow(); });
}

void TrackInspectorPanel::onInitialize() {
  rviz::ToolManager* tools = vis_manager_->getToolManager();
  for (int index = 0; index < tools->numTools(); ++index) listenTo(tools->getTool(index));
  connect(tools, &rviz::ToolManager::toolAdded, this, [this](rviz::Tool* tool) { listenTo(tool); });
  follow_timer_.start(kFollowPeriod);
}

void TrackInspectorPanel::listenTo(rviz::Tool* tool) {
  auto* select = dynamic_cast<SelectTrackTool*>(tool);
  if (select != nullptr)
    connect(select, &SelectTrackTool::clicked, this, [this](const Click& click) { selectAt(click); });
}

void TrackInspectorPanel::readRadius() {
  radius_ = ros::param::param("/track_display/radius", radius_);
}

/// Where a track is drawn, in the fixed frame; nullopt without a transform.
std::optional<Ogre::Vector3> TrackInspectorPanel::placeOf(const TrackRow& row) const {
  Ogre::Vector3 origin;
  Ogre::Quaternion turn;
  if (!vis_manager_->getFrameManager()->getTransform(row.frame, ros::Time(), origin, turn))
    return std::nullopt;
  const double scale = row.kind == TrackKind::position ? 1.0 : radius_;
  const Eigen::Vector3f point = (scale * row.place).cast<float>();
  return origin + turn * Ogre::Vector3(point.x(), point.y(), point.z());
}

void TrackInspectorPanel::selectAt(const Click& click) {
  readRadius();
  std::optional<sightline_ros::TrackKey> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const TrackRow& row : window_.inspector().shownRows()) {
    const auto place = placeOf(row);
    const auto pixel = place ? pixelOf(*place, *click.viewport) : std::nullopt;
    if (!pixel) continue;
    const double distance = std::hypot(pixel->x() - click.pixel.x(), pixel->y() - click.pixel.y());
    if (distance > kReach || distance + handicapOf(row) >= least) continue;
    least = distance + handicapOf(row);
    nearest = row.key;
  }
  if (nearest) window_.inspector().select(nearest);
}

/// A direction is looked at from where the camera is; of the view Orbit, whose camera stands opposite to what
/// it looks at, through the middle.
void TrackInspectorPanel::follow() {
  const auto& row = window_.inspector().selectedRow();
  rviz::ViewController* view = vis_manager_->getViewManager()->getCurrent();
  const bool follows = window_.inspector().follows() && row && view != nullptr;
  if (follows && !was_following_) readRadius();
  was_following_ = follows;
  if (!follows) return;
  const auto place = placeOf(*row);
  if (!place) return;
  if (row->kind == TrackKind::position || view->getClassId() != "rviz/Orbit") return view->lookAt(*place);
  const Eigen::Vector2d angles =
      sightline::core::anglesOf(Eigen::Vector3d(place->x, place->y, place->z).normalized());
  view->subProp("Yaw")->setValue(angles.x() + sightline::core::kPi);
  view->subProp("Pitch")->setValue(-angles.y());
}

}  // namespace sightline_rviz

PLUGINLIB_EXPORT_CLASS(sightline_rviz::TrackInspectorPanel, rviz::Panel)
