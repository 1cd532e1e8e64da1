#include "sightline/rviz/inspector_window.h"

#include <QVBoxLayout>
#include <string>
#include <vector>

#include <ros/param.h>

#include "sightline/ros/nodes/track_display_node.h"
#include "sightline/rviz/knob_panel.h"

namespace sightline_rviz {
namespace {

constexpr int kSavePeriod = 200;  // between two looks at what became of saving [ms]

/// Those of the pictures beside the panel.
sightline_ros::SensorColours coloursOfDisplay() {
  const sightline_ros::TrackDisplayParams defaults;
  std::vector<std::string> sightings = defaults.sighting_topics, tracks = defaults.track_topics;
  ros::param::get("/track_display/sighting_topics", sightings);
  ros::param::get("/track_display/track_topics", tracks);
  return sightline_ros::SensorColours(sightline_ros::channelsOf(sightings, tracks));
}

std::string saveService() {
  return ros::param::param<std::string>("~save_service", "/flight_recorder/save");
}

}  // namespace

InspectorWindow::InspectorWindow(QWidget* parent)
    : QWidget(parent),
      feed_(saveService()),
      inspector_([this](const auto& use) { feed_.with(use); }, coloursOfDisplay()) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(&inspector_);
  inspector_.addTab(new KnobPanel(feed_.knobs()), "Knobs");
  connect(&inspector_, &InspectorWidget::selectionChanged, this,
          [this](const std::optional<sightline_ros::TrackKey>& key) {
            feed_.announce(key, inspector_.isAlone());
          });
  connect(&inspector_, &InspectorWidget::saveWanted, this, [this] { feed_.recorder().start(); });
  connect(&save_timer_, &QTimer::timeout, this, [this] {
    inspector_.setSaveWords(QString::fromStdString(feed_.recorder().words()), feed_.recorder().isUnderWay());
  });
  save_timer_.start(kSavePeriod);
}

}  // namespace sightline_rviz
