#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/time.h>

namespace sightline_ros {

/// A message that does not hold what its definition, or a field path, says; the message names the path.
struct FieldError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A serialized message.
struct Bytes {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

/// Where fields lie in the serialized messages of one type, from the definition text that comes with every
/// connection. So fields can be read of a message type that this program was not built with.
///
/// A field path has names with dots (or slashes) and indices, for instance `targets[2].pose.position.x` or
/// `targets.2.pose.position.x`; a slash before the first name is ignored.
class MessageLayout {
 public:
  /// `type`: package/Name. `definition`: the full text, with those of the nested types. Throws FieldError, of
  /// one without end too.
  MessageLayout(const std::string& type, const std::string& definition);

  /// A value within a message, or the message itself.
  struct Place {
    std::string type;                       ///< of the value; of one element when it is an array
    std::size_t offset = 0;                 ///< first byte; of an array its first element
    std::optional<std::size_t> array_size;  ///< elements; nullopt = not an array
  };

  Place whole() const { return {type_, 0, std::nullopt}; }

  /// Whether the message type has the field, without a message at hand; indices are not looked at.
  bool has(const std::string& path) const;

  /// Whether this message holds it, too: every index is that of an element. Throws FieldError when the
  /// message ends too early.
  bool exists(const Bytes& message, const Place& from, const std::string& path) const;

  /// The field below `from`. Throws FieldError: no such field, an index beyond the end, a message that ends
  /// too early.
  Place find(const Bytes& message, const Place& from, const std::string& path) const;

  /// The elements of an array, one after the other. Throws FieldError when `array` is none.
  std::vector<Place> elements(const Bytes& message, const Place& array) const;

  /// A number (of any built-in numeric type; bool, time and duration [s] count too). Throws FieldError.
  double number(const Bytes& message, const Place& from, const std::string& path) const;
  std::string text(const Bytes& message, const Place& from, const std::string& path) const;
  ros::Time time(const Bytes& message, const Place& from, const std::string& path) const;

 private:
  struct Field {
    std::string name, type;
    bool is_array = false;
    std::optional<std::size_t> fixed_size;  // of an array; nullopt = its length comes first
  };

  std::optional<Place> findIn(const Bytes& message, const Place& from, const std::string& path,
                              std::string* complaint) const;
  void parse(const std::string& type, const std::string& definition);
  bool settle(const std::string& type, std::vector<std::string> above, std::map<std::string, bool>& known);
  const std::vector<Field>& fieldsOf(const std::string& type) const;
  std::string resolved(const std::string& type, const std::string& inside) const;
  Place at(const Bytes& message, const Field& field, std::size_t offset) const;
  std::size_t endOf(const Bytes& message, const Place& place) const;
  std::size_t endOfOne(const Bytes& message, const std::string& type, std::size_t offset) const;

  std::string type_;
  std::map<std::string, std::vector<Field>> fields_;  // by type, package/Name
};

}  // namespace sightline_ros
