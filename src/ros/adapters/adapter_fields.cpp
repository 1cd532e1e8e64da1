// Messages whose fields are named in the configuration: point clouds, and types not known at build time.
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "sightline/core/model/angle_range.h"
#include "sightline/core/model/sphere.h"
#include "sightline/ros/adapters/adapter_messages.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// The value of a field by its name or path. Throws FieldError.
using Value = std::function<double(const std::string& field)>;

double valueOf(const Quantity& quantity, const Value& value) {
  return quantity.field.empty() ? quantity.offset : quantity.scale * value(quantity.field) + quantity.offset;
}

/// An azimuth and what is added to it make an azimuth again, wherever between -pi and pi that is. What is no
/// azimuth by itself (degrees for radians) does not become one.
double azimuthOf(const Quantity& quantity, const Value& value) {
  if (quantity.field.empty()) return core::wrapAngle(quantity.offset);
  const double azimuth = quantity.scale * value(quantity.field);
  if (quantity.offset == 0.0 || !core::isAzimuth(azimuth)) return azimuth;
  return core::wrapAngle(azimuth + quantity.offset);
}

bool statesSpread(const Quantity& quantity) {
  return !quantity.variance.empty() || !quantity.sigma.empty();
}

/// In the square of rad, m or px. A negative sigma stays negative: it means "not known", as a negative
/// variance; a number that stands for "not known" in the field's unit becomes infinite.
double varianceOf(const Quantity& quantity, const Value& value) {
  const double stated = value(quantity.variance.empty() ? quantity.sigma : quantity.variance);
  if (standsForUnknown(stated)) return kInfinite;
  if (!quantity.variance.empty()) return quantity.scale * quantity.scale * stated;
  const double sigma = std::abs(quantity.scale) * stated;
  return std::abs(sigma) * sigma;
}

/// nullopt when no axis has a field for it. An axis without one has the configured sigma, given as that of
/// the axis.
template <int kAxes>
std::optional<Eigen::Matrix<double, kAxes, kAxes>> covarianceOf(const FieldMap& map, const Value& value,
                                                                const std::optional<Eigen::Vector2d>& sigma) {
  Eigen::Matrix<double, kAxes, 1> variances;
  bool is_stated = false;
  for (int i = 0; i < kAxes; ++i) {
    const Quantity& axis = map.axes[static_cast<std::size_t>(i)];
    is_stated = is_stated || statesSpread(axis);
    variances(i) = statesSpread(axis) ? varianceOf(axis, value)
                   : sigma && i < 2   ? (*sigma)(i) * (*sigma)(i)
                                      : Reading::kNotKnown;
  }
  if (!is_stated) return std::nullopt;
  return Eigen::Matrix<double, kAxes, kAxes>(variances.asDiagonal());
}

double snrOf(const FieldMap& map, const Value& value) {
  if (map.snr.empty()) return Reading::kNotKnown;
  const double snr = value(map.snr);
  return map.snr_in_db ? std::pow(10.0, snr / 20.0) : snr;
}

void addSighting(Reading& reading, const AdapterTopic& topic, const Value& value, const PixelRays* rays) {
  const FieldMap& map = topic.fields;
  const double snr = snrOf(map, value);
  const auto axis = [&](std::size_t i) { return valueOf(map.axes[i], value); };
  switch (map.form) {
    case FieldMap::Form::angles: {
      const Eigen::Vector2d angles(azimuthOf(map.axes[0], value), axis(1));
      return reading.addAngles(angles, covarianceOf<2>(map, value, reading.sigmaOfAngles(angles.y())), snr);
    }
    case FieldMap::Form::point:
      return reading.addPoint({axis(0), axis(1), axis(2)}, covarianceOf<3>(map, value, std::nullopt), snr);
    case FieldMap::Form::pixel:
      return reading.addPixel({axis(0), axis(1)}, covarianceOf<2>(map, value, topic.sigma_px), rays, snr);
    case FieldMap::Form::corners:
      return reading.addBox({axis(0), axis(2)}, {axis(1), axis(3)}, rays, snr);
  }
}

template <typename Number>
double numberAt(const std::uint8_t* place) {
  Number number;
  std::memcpy(&number, place, sizeof(number));
  return static_cast<double>(number);
}

double pointFieldAt(const std::uint8_t* place, std::uint8_t datatype) {
  using sensor_msgs::PointField;
  switch (datatype) {
    case PointField::INT8:
      return numberAt<std::int8_t>(place);
    case PointField::UINT8:
      return numberAt<std::uint8_t>(place);
    case PointField::INT16:
      return numberAt<std::int16_t>(place);
    case PointField::UINT16:
      return numberAt<std::uint16_t>(place);
    case PointField::INT32:
      return numberAt<std::int32_t>(place);
    case PointField::UINT32:
      return numberAt<std::uint32_t>(place);
    case PointField::FLOAT32:
      return numberAt<float>(place);
    default:
      return numberAt<double>(place);
  }
}

std::size_t sizeOf(std::uint8_t datatype) {
  static constexpr std::array<std::size_t, 9> sizes = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return datatype < sizes.size() ? sizes[datatype] : 0;
}

/// Reads the points of a cloud that is well formed.
class CloudReader {
 public:
  explicit CloudReader(const sensor_msgs::PointCloud2& cloud) : cloud_(cloud) {
    const std::size_t rows = cloud.height, row = cloud.row_step;
    if (cloud.is_bigendian) throw FieldError("the cloud is big-endian, which is not read here");
    if (std::size_t{cloud.width} * cloud.point_step > row || rows * row > cloud.data.size()) {
      throw FieldError("the cloud's sizes do not agree: " + std::to_string(cloud.data.size()) +
                       " bytes of data for height " + std::to_string(rows) + " times row_step " +
                       std::to_string(row) + ", width " + std::to_string(cloud.width) + " times point_step " +
                       std::to_string(cloud.point_step));
    }
  }

  const sensor_msgs::PointField& field(const std::string& name) const {
    std::string names;
    for (const auto& field : cloud_.fields) {
      names += (names.empty() ? "" : ", ") + field.name;
      if (field.name != name) continue;
      const std::size_t size = sizeOf(field.datatype);
      if (size == 0 || field.offset + size > cloud_.point_step)
        throw FieldError("the cloud's field \"" + name + "\" does not lie within its points");
      return field;
    }
    throw FieldError("field \"" + name + "\" does not exist: the cloud has " +
                     (names.empty() ? "none" : names));
  }

  double value(std::size_t point, const std::string& name) const {
    const auto& wanted = field(name);
    const std::size_t row = point / cloud_.width, column = point % cloud_.width;
    const std::size_t offset = row * cloud_.row_step + column * cloud_.point_step + wanted.offset;
    return pointFieldAt(cloud_.data.data() + offset, wanted.datatype);
  }

 private:
  const sensor_msgs::PointCloud2& cloud_;
};

/// Whether a point of a cloud that is not dense is a return that did not come.
bool isMissing(const FieldMap& map, const Value& value) {
  for (const Quantity& axis : map.axes) {
    if (std::isnan(valueOf(axis, value))) return true;
  }
  return false;
}

}  // namespace

Reading read(const sensor_msgs::PointCloud2& message, const AdapterTopic& topic, const PixelRays* rays) {
  Reading reading(topic, message.header);
  const std::size_t count = std::size_t{message.width} * message.height;
  try {
    const CloudReader cloud(message);
    for (std::size_t i = 0; i < count; ++i) {
      // Not detections; counting them is enough to say so.
      if (reading.offered() > static_cast<std::size_t>(topic.max_sightings)) break;
      const Value value = [&](const std::string& field) { return cloud.value(i, field); };
      if (!message.is_dense && isMissing(topic.fields, value)) continue;
      addSighting(reading, topic, value, rays);
    }
  } catch (const FieldError& problem) {
    reading.refuse("malformed", problem.what());
  }
  return reading;
}

Reading read(const Bytes& message, const MessageLayout& layout, const AdapterTopic& topic,
             const PixelRays* rays) {
  const FieldMap& map = topic.fields;
  const MessageLayout::Place whole = layout.whole();
  std::vector<MessageLayout::Place> places = {whole};
  if (!map.each.empty()) places = layout.elements(message, layout.find(message, whole, map.each));
  // Of an empty list no element has a header: the message's own one serves, if there is one.
  std::string path = map.header;
  if (places.empty() && layout.has(path) && !layout.exists(message, whole, path)) path = "header";
  std_msgs::Header header;
  const bool has_header = layout.has(path);
  if (has_header) {
    header.stamp = layout.time(message, whole, path + ".stamp");
    header.frame_id = layout.text(message, whole, path + ".frame_id");
  }
  if (!topic.camera_info.empty() && rays != nullptr && header.frame_id.empty()) {
    header.frame_id = rays->frame();
  }
  Reading reading(topic, header);
  if (!has_header && path != map.header && !topic.stamp_on_arrival) {
    reading.refuse("no stamp", "the list " + map.each + " is empty, and with it there is no " + map.header +
                                   ": set stamp: arrival (and frame) for this topic, so that an empty list "
                                   "can mean that nothing was seen");
  }
  for (const MessageLayout::Place& place : places) {
    if (reading.offered() > static_cast<std::size_t>(topic.max_sightings)) break;
    addSighting(
        reading, topic, [&](const std::string& field) { return layout.number(message, place, field); }, rays);
  }
  return reading;
}

}  // namespace sightline_ros
