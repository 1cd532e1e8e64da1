#include "sightline/ros/adapters/adapter_params.h"

#include <algorithm>
#include <map>
#include <set>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/params/param_text.h"

namespace sightline_ros {
namespace {

using Kind = AdapterTopic::Kind;
using Form = FieldMap::Form;

constexpr double kSmallestSigma = 1e-9;  // [rad], as the trackers

const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> kinds = {
      {"geometry_msgs/Vector3Stamped", Kind::direction},
      {"geometry_msgs/PointStamped", Kind::point},
      {"geometry_msgs/PoseStamped", Kind::pose},
      {"geometry_msgs/PoseArray", Kind::poses},
      {"geometry_msgs/PoseWithCovarianceStamped", Kind::pose_with_covariance},
      {"nav_msgs/Odometry", Kind::odometry},
      {"sensor_msgs/RegionOfInterest", Kind::box},
      {"sensor_msgs/PointCloud2", Kind::cloud},
      {"sensor_msgs/LaserScan", Kind::laser},
  };
  return kinds;
}

Kind kindOf(const std::string& type, bool has_camera) {
  const auto known = kinds().find(type);
  if (known == kinds().end()) return Kind::fields;
  return known->second == Kind::point && has_camera ? Kind::pixel : known->second;
}

std::optional<Eigen::Vector2d> loadSigma(const ParamReader& reader, const std::string& key, double highest,
                                         const std::string& unit) {
  if (!reader.has(key)) {
    reader.numbers(key, {}, anyNumber());  // a known key that is not set
    return std::nullopt;
  }
  const std::vector<double> pair =
      reader.requiredNumbers(key, Range{kSmallestSigma, highest, false, false}, unit);
  if (pair.size() != 2) {
    throw reader.error(key, "expected two numbers [" + unit + "], got " + std::to_string(pair.size()));
  }
  return Eigen::Vector2d(pair[0], pair[1]);
}

/// How much one of a unit is, in rad, m or px.
double scaleOf(const ParamReader& reader, Form form) {
  static const std::map<std::string, double> angles = {
      {"rad", 1.0}, {"deg", sightline::core::kPi / 180.0}, {"mrad", 1e-3}};
  static const std::map<std::string, double> lengths = {{"m", 1.0}, {"km", 1e3}, {"cm", 1e-2}, {"mm", 1e-3}};
  static const std::map<std::string, double> pixels = {{"px", 1.0}};
  const auto& units = form == Form::angles ? angles : form == Form::point ? lengths : pixels;
  std::vector<std::string> names;
  for (const auto& unit : units) names.push_back(unit.first);
  const std::string base = form == Form::angles ? "rad" : form == Form::point ? "m" : "px";
  return units.at(reader.choice("unit", base, names));
}

Quantity loadQuantity(const ParamReader& reader, Form form, const std::string& default_field) {
  Quantity quantity;
  quantity.field = default_field.empty() ? reader.requiredText("field") : reader.text("field", default_field);
  const int sign = form == Form::corners ? 1 : reader.integer("sign", 1, -1, 1);
  if (sign == 0) throw reader.error("sign", "expected 1 or -1, got 0");
  quantity.scale = sign * scaleOf(reader, form);
  quantity.offset = reader.number("offset", 0.0, anyNumber(),
                                  form == Form::angles  ? "rad"
                                  : form == Form::point ? "m"
                                                        : "px");
  if (form == Form::corners) return quantity;
  quantity.sigma = reader.text("sigma", "");
  quantity.variance = reader.text("variance", "");
  if (!quantity.sigma.empty() && !quantity.variance.empty()) {
    throw reader.error("variance", "expected either sigma or variance, got both");
  }
  return quantity;
}

/// Which of the three forms is configured; clouds have x, y and z without a word.
Form formOf(const ParamReader& reader, bool is_cloud) {
  const bool angles = reader.has("azimuth") || reader.has("elevation");
  const bool point = reader.has("x") || reader.has("y") || reader.has("z");
  const bool pixel = reader.has("u") || reader.has("v");
  const bool corners = reader.has("xmin") || reader.has("xmax") || reader.has("ymin") || reader.has("ymax");
  const int forms = angles + point + pixel + corners;
  if (forms == 0 && is_cloud) return Form::point;
  if (forms != 1) {
    throw reader.error(
        angles    ? "azimuth"
        : point   ? "x"
        : pixel   ? "u"
        : corners ? "xmin"
                  : "type",
        "expected the fields of a sighting in one form: azimuth (and elevation), or x, y and z, or u and v "
        "with camera_info, or xmin, xmax, ymin and ymax with camera_info; got " +
            std::string(forms == 0 ? "none (types read without them: "
                                   : "several (types read without them: ") +
            [] {
              std::vector<std::string> names;
              for (const auto& kind : kinds()) names.push_back(kind.first);
              return joined(names, ", ");
            }() +
            ")");
  }
  return angles ? Form::angles : point ? Form::point : pixel ? Form::pixel : Form::corners;
}

FieldMap loadFields(const ParamReader& reader, bool is_cloud) {
  FieldMap map;
  map.form = formOf(reader, is_cloud);
  const auto axis = [&](const std::string& key, bool is_optional) {
    const std::string default_field = is_cloud && map.form == Form::point ? key : "";
    if (is_optional && !reader.has(key)) {
      map.axes.push_back({});
    } else {
      map.axes.push_back(loadQuantity(reader.sub(key), map.form, default_field));
    }
  };
  if (map.form == Form::angles) {
    axis("azimuth", false);
    axis("elevation", true);
  } else if (map.form == Form::point) {
    for (const char* key : {"x", "y", "z"}) axis(key, false);
    const auto states_spread = [](const Quantity& q) { return !q.sigma.empty() || !q.variance.empty(); };
    const auto stated = std::count_if(map.axes.begin(), map.axes.end(), states_spread);
    if (stated != 0 && stated != 3) {
      throw reader.error("x", "expected sigma or variance fields for all of x, y and z or for none, got " +
                                  std::to_string(stated));
    }
  } else if (map.form == Form::pixel) {
    for (const char* key : {"u", "v"}) axis(key, false);
  } else {
    for (const char* key : {"xmin", "xmax", "ymin", "ymax"}) axis(key, false);
  }
  if (reader.has("snr")) {
    const ParamReader snr = reader.sub("snr");
    map.snr = snr.requiredText("field");
    map.snr_in_db = snr.choice("unit", "ratio", {"ratio", "dB"}) == "dB";
  }
  if (!is_cloud) {
    map.each = reader.text("each", "");
    map.header = reader.text("header", "header");
  }
  return map;
}

sightline::core::LaserSpotParams loadLaser(const ParamReader& reader) {
  sightline::core::LaserSpotParams params;
  params.gap = reader.number("gap", params.gap, above(0.0), "m");
  params.max_size = reader.number("max_size", params.max_size, above(0.0), "m");
  params.min_beams = reader.integer("min_beams", params.min_beams, 1, 1000000);
  return params;
}

bool carriesCovariance(const AdapterTopic& topic) {
  if (topic.kind == Kind::pose_with_covariance || topic.kind == Kind::odometry) return true;
  if (topic.kind != Kind::cloud && topic.kind != Kind::fields) return false;
  for (const Quantity& axis : topic.fields.axes) {
    if (axis.sigma.empty() && axis.variance.empty()) return false;
  }
  return true;
}

bool isInPixels(const AdapterTopic& topic) {
  const bool by_fields = topic.kind == Kind::cloud || topic.kind == Kind::fields;
  return topic.kind == Kind::pixel || topic.kind == Kind::box ||
         (by_fields && (topic.fields.form == Form::pixel || topic.fields.form == Form::corners));
}

/// Everything that says how well a sighting is known.
void loadNoise(const ParamReader& reader, AdapterTopic& topic) {
  const bool pixels = isInPixels(topic);
  const std::string key = pixels ? "sigma_px" : "sigma";
  std::optional<Eigen::Vector2d>& sigma = pixels ? topic.sigma_px : topic.sigma;
  sigma =
      pixels ? loadSigma(reader, key, 1e4, "px") : loadSigma(reader, key, sightline::core::kPi / 2.0, "rad");
  if (!sigma && !carriesCovariance(topic)) {
    throw reader.error(key,
                       std::string("expected two numbers [") + (pixels ? "px" : "rad") +
                           "], but it is not set (required: these messages say nothing of their accuracy)");
  }
}

void loadCamera(const ParamReader& reader, AdapterTopic& topic) {
  if (!isInPixels(topic)) return;
  topic.camera_info = reader.requiredText("camera_info");
  topic.is_rectified = reader.flag("rectified", false);
  topic.is_optical = true;
}

/// What zeros mean, where messages have vectors or corners. In lists with a fixed number of slots unused
/// ones are zero.
void loadZeros(const ParamReader& reader, AdapterTopic& topic) {
  const bool by_fields = topic.kind == Kind::cloud || topic.kind == Kind::fields;
  const bool has_zeros =
      by_fields ? topic.fields.form == Form::point || topic.fields.form == Form::corners
                : topic.kind != Kind::pixel && topic.kind != Kind::box && topic.kind != Kind::laser;
  if (!has_zeros) return;
  const bool is_list = topic.kind == Kind::cloud || !topic.fields.each.empty();
  topic.zero_is_nothing =
      reader.choice("zeros", is_list ? "nothing" : "refused", {"nothing", "refused"}) == "nothing";
}

AdapterTopic loadTopic(const ParamReader& reader) {
  AdapterTopic topic;
  topic.topic = reader.requiredText("topic");
  topic.type = reader.requiredText("type");
  topic.sensor = reader.requiredText("sensor");
  topic.kind = kindOf(topic.type, reader.has("camera_info"));
  const std::string output = reader.text("output", "");
  topic.output = output.empty() ? "/sensors/" + topic.sensor + "/sightings" : output;
  topic.frame = reader.text("frame", "");
  topic.stamp_on_arrival = reader.choice("stamp", "header", {"header", "arrival"}) == "arrival";
  topic.stamp_offset = reader.number("stamp_offset", 0.0, between(-3600.0, 3600.0), "s");
  if (topic.kind == Kind::cloud || topic.kind == Kind::fields) {
    topic.fields = loadFields(reader, topic.kind == Kind::cloud);
  }
  if (topic.kind == Kind::laser) topic.laser = loadLaser(reader);
  loadZeros(reader, topic);
  loadNoise(reader, topic);
  loadCamera(reader, topic);
  if (!isInPixels(topic)) topic.is_optical = reader.flag("optical", false);
  topic.ifov = reader.number("ifov", topic.ifov, Range{0.0, sightline::core::kPi, true, false}, "rad");
  topic.detection_probability =
      reader.number("detection_probability", topic.detection_probability, Range{0.0, 1.0, true, false});
  topic.clutter_density = reader.number("clutter_density", topic.clutter_density, atLeast(0.0), "1/sr");
  topic.max_sightings = reader.integer("max_sightings", topic.max_sightings, 1, 1000000);
  return topic;
}

}  // namespace

std::vector<AdapterTopic> loadAdapterTopics(const ParamReader& reader) {
  std::vector<AdapterTopic> topics;
  std::set<std::string> sensors, outputs;
  for (const ParamReader& entry : reader.list("topics")) {
    const AdapterTopic topic = loadTopic(entry);
    if (!sensors.insert(topic.sensor).second) {
      throw entry.error("sensor",
                        "\"" + topic.sensor + "\" names an entry before it too: give each its own name");
    }
    if (!outputs.insert(topic.output).second) {
      throw entry.error("output", "\"" + topic.output + "\" is the output of an entry before it too");
    }
    topics.push_back(topic);
  }
  if (topics.empty()) {
    throw reader.error("topics",
                       "expected a list with an entry for each topic, but there is none (see "
                       "config/sighting_adapter.yaml)");
  }
  return topics;
}

}  // namespace sightline_ros
