#include "sightline/ros/components/station_views.h"

#include <algorithm>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/station_pose.h"

namespace sightline_ros {

namespace core = sightline::core;

StationViews::StationViews(const ParamReader& reader) {
  for (const ParamReader& entry : reader.list("fields_of_view")) {
    const std::string tracker = entry.requiredText("tracker");
    View view;
    view.frame = entry.text("frame", "");
    if (!view.frame.empty() && view.frame.front() == '/') {
      throw entry.error("frame",
                        "expected a frame name without leading slash, got the string \"" + view.frame + "\"");
    }
    view.half_widths.x() =
        entry.requiredNumber("azimuth_half_width", Range{0.0, core::kPi, true, false}, "rad");
    view.half_widths.y() =
        entry.requiredNumber("elevation_half_width", Range{0.0, core::kPi / 2.0, true, false}, "rad");
    std::vector<View>& of_tracker = views_[tracker];
    const bool is_there = std::any_of(of_tracker.begin(), of_tracker.end(),
                                      [&](const View& other) { return other.frame == view.frame; });
    if (is_there) {
      throw entry.error("tracker", "the field of view of \"" + tracker + "\" in frame \"" + view.frame +
                                       "\" is given twice");
    }
    of_tracker.push_back(view);
  }
}

const std::string& StationViews::frameOf(const View& view, const std_msgs::Header& header) {
  return view.frame.empty() ? header.frame_id : view.frame;
}

bool StationViews::areSettled(const std::string& tracker, const std_msgs::Header& header,
                              const std::string& metric_frame, const tf2::BufferCore& transforms) const {
  const auto found = views_.find(tracker);
  if (found == views_.end()) return true;
  return std::all_of(found->second.begin(), found->second.end(), [&](const View& view) {
    const std::string& frame = frameOf(view, header);
    return !transforms.canTransform(metric_frame, frame, ros::Time(0)) ||
           isPoseKnown(frame, header.stamp, metric_frame, transforms);
  });
}

StationViews::Found StationViews::at(const std::string& tracker, const std_msgs::Header& header,
                                     const std::string& metric_frame,
                                     const tf2::BufferCore& transforms) const {
  Found out;
  const auto found = views_.find(tracker);
  if (found == views_.end()) return out;
  for (const View& view : found->second) {
    const std::string& frame = frameOf(view, header);
    if (!isPoseKnown(frame, header.stamp, metric_frame, transforms)) {
      out.refusals.push_back(
          {"no field of view", "tf does not lead from " + frame + " to " + metric_frame +
                                   " at the stamps of \"" + tracker +
                                   "\": what it looks at counts as not known (correct the frame in "
                                   "fields_of_view, or publish its transform)"});
      continue;
    }
    core::FieldOfView field;
    field.R_sensor_tracking =
        poseOf(frame, header.stamp, metric_frame, transforms).R_metric_station.transpose();
    field.half_widths = view.half_widths;
    out.views.push_back(field);
  }
  if (!out.refusals.empty()) out.views.clear();  // the others may not hold what the missing one does
  return out;
}

}  // namespace sightline_ros
