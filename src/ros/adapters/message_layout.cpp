#include "sightline/ros/adapters/message_layout.h"

#include <algorithm>
#include <cstring>
#include <regex>
#include <sstream>
#include <utility>

namespace sightline_ros {
namespace {

constexpr std::ptrdiff_t kMostDigits = 9;  // of the size of an array in a definition
constexpr std::size_t kMostLevels = 32;    // of types within types

/// Bytes of a built-in type of fixed size; 0 for the others.
std::size_t sizeOfBuiltin(const std::string& type) {
  static const std::map<std::string, std::size_t> sizes = {
      {"bool", 1},   {"int8", 1},    {"uint8", 1},   {"byte", 1},   {"char", 1},
      {"int16", 2},  {"uint16", 2},  {"int32", 4},   {"uint32", 4}, {"int64", 8},
      {"uint64", 8}, {"float32", 4}, {"float64", 8}, {"time", 8},   {"duration", 8}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0 : found->second;
}

/// ROS serializes little-endian, as the machines it runs on.
template <typename Value>
Value read(const Bytes& message, std::size_t offset) {
  if (offset > message.size || message.size - offset < sizeof(Value)) {
    throw FieldError("the message ends after " + std::to_string(message.size) +
                     " bytes, earlier than its definition says");
  }
  Value value;
  std::memcpy(&value, message.data + offset, sizeof(Value));
  return value;
}

double numberAt(const Bytes& message, const std::string& type, std::size_t offset) {
  if (type == "float64") return read<double>(message, offset);
  if (type == "float32") return static_cast<double>(read<float>(message, offset));
  if (type == "int8" || type == "byte") return read<std::int8_t>(message, offset);
  if (type == "uint8" || type == "char" || type == "bool") return read<std::uint8_t>(message, offset);
  if (type == "int16") return read<std::int16_t>(message, offset);
  if (type == "uint16") return read<std::uint16_t>(message, offset);
  if (type == "int32") return read<std::int32_t>(message, offset);
  if (type == "uint32") return read<std::uint32_t>(message, offset);
  if (type == "int64") return static_cast<double>(read<std::int64_t>(message, offset));
  if (type == "uint64") return static_cast<double>(read<std::uint64_t>(message, offset));
  if (type == "time")
    return read<std::uint32_t>(message, offset) + 1e-9 * read<std::uint32_t>(message, offset + 4);
  if (type == "duration")
    return read<std::int32_t>(message, offset) + 1e-9 * read<std::int32_t>(message, offset + 4);
  throw FieldError("is of type " + type + ", not a number");
}

/// A step of a path: a name, and perhaps an index, as name[0] or as name.0.
struct Step {
  std::string name;
  std::optional<std::size_t> index;
};

Step stepOf(const std::string& word, const std::string& path) {
  static const char* const letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  const std::size_t bracket = word.find('[');
  Step step{word.substr(0, bracket), std::nullopt};
  bool is_fine = !step.name.empty() && step.name.find_first_not_of(letters) == std::string::npos;
  if (is_fine && bracket != std::string::npos) {
    const std::string digits = word.substr(bracket + 1, word.size() - bracket - 2);
    is_fine = word.back() == ']' && !digits.empty() && digits.size() < 10 &&
              digits.find_first_not_of("0123456789") == std::string::npos;
    if (is_fine) step.index = std::stoul(digits);
  }
  if (!is_fine)
    throw FieldError("field path \"" + path + "\" is malformed: write it like targets[0].position.x");
  return step;
}

bool isIndex(const std::string& word) {
  return !word.empty() && word.size() < 10 && word.find_first_not_of("0123456789") == std::string::npos;
}

/// Slashes serve as dots, as in names of topics and parameters, and a first one says nothing.
std::vector<Step> stepsOf(const std::string& path) {
  std::vector<Step> steps;
  for (std::size_t start = !path.empty() && path.front() == '/' ? 1 : 0; start <= path.size();) {
    const std::size_t end = std::min(path.find_first_of("./", start), path.size());
    const std::string word = path.substr(start, end - start);
    if (isIndex(word) && !steps.empty() && !steps.back().index) {
      steps.back().index = std::stoul(word);
    } else {
      steps.push_back(stepOf(word, path));
    }
    start = end + 1;
  }
  return steps;
}

FieldError within(const std::string& path, const std::string& complaint) {
  return FieldError("field \"" + path + "\" " + complaint);
}

std::string packageOf(const std::string& type) {
  return type.substr(0, type.find('/'));
}

}  // namespace

MessageLayout::MessageLayout(const std::string& type, const std::string& definition) : type_(type) {
  // Nested types follow after lines of equals signs, each beginning with "MSG: package/Name".
  std::istringstream lines(definition);
  std::string current = type, text;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("MSG: ", 0) == 0) {
      parse(current, text);
      current = line.substr(5, line.find_last_not_of(" \r") - 4);
      text.clear();
    } else if (line.rfind("===", 0) != 0) {
      text += line + '\n';
    }
  }
  parse(current, text);
  std::map<std::string, bool> known;
  settle(type, {}, known);
}

void MessageLayout::parse(const std::string& type, const std::string& definition) {
  // TYPE[SIZE] NAME, and for constants an equals sign behind.
  static const std::regex form("\\s*([\\w/]+)(\\[(\\d*)\\])?\\s+(\\w+)\\s*(=.*)?");
  std::vector<Field>& fields = fields_[type];
  fields.clear();
  std::istringstream lines(definition);
  for (std::string line; std::getline(lines, line);) {
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::smatch parts;
    if (line.back() == '\r') line.pop_back();
    line.erase(line.find_last_not_of(" \t") + 1);
    if (!std::regex_match(line, parts, form)) {
      throw FieldError("the definition of " + type + " has a line that is not understood: \"" + line + "\"");
    }
    if (parts[5].matched) continue;
    Field field{parts[4], resolved(parts[1], type), parts[2].matched, std::nullopt};
    if (parts[3].length() > kMostDigits)
      throw FieldError("the definition of " + type + " has an array of " + parts[3].str() + " elements");
    if (parts[3].length() > 0) field.fixed_size = std::stoul(parts[3]);
    fields.push_back(field);
  }
}

/// Whether a value of the type takes any byte; fields that take none are forgotten, so that walking through a
/// message takes no longer than it is. `above`: the types that contain it; `known`: of those seen before.
bool MessageLayout::settle(const std::string& type, std::vector<std::string> above,
                           std::map<std::string, bool>& known) {
  const auto fields = fields_.find(type);
  if (fields == fields_.end()) return true;  // built in, or not defined, which is said where it is read
  if (const auto seen = known.find(type); seen != known.end()) return seen->second;
  if (std::find(above.begin(), above.end(), type) != above.end())
    throw FieldError("the definition of " + type_ + " does not end: " + type + " contains itself");
  if (above.size() >= kMostLevels)
    throw FieldError("the definition of " + type_ + " is nested deeper than " + std::to_string(kMostLevels) +
                     " types");
  above.push_back(type);
  const auto takes_none = [&](const Field& field) { return !settle(field.type, above, known); };
  auto& all = fields->second;
  all.erase(std::remove_if(all.begin(), all.end(), takes_none), all.end());
  return known[type] = !all.empty();
}

std::string MessageLayout::resolved(const std::string& type, const std::string& inside) const {
  if (type == "Header") return "std_msgs/Header";
  const bool is_builtin = sizeOfBuiltin(type) > 0 || type == "string";
  return is_builtin || type.find('/') != std::string::npos ? type : packageOf(inside) + "/" + type;
}

const std::vector<MessageLayout::Field>& MessageLayout::fieldsOf(const std::string& type) const {
  const auto found = fields_.find(type);
  if (found == fields_.end()) throw FieldError("type " + type + " has no fields");
  return found->second;
}

bool MessageLayout::has(const std::string& path) const {
  std::string type = type_;
  for (const Step& step : stepsOf(path)) {
    const auto fields = fields_.find(type);
    if (fields == fields_.end()) return false;
    bool is_here = false;
    for (const Field& field : fields->second) {
      if (field.name != step.name) continue;
      type = field.type;
      is_here = true;
      break;
    }
    if (!is_here) return false;
  }
  return true;
}

bool MessageLayout::exists(const Bytes& message, const Place& from, const std::string& path) const {
  return has(path) && findIn(message, from, path, nullptr).has_value();
}

MessageLayout::Place MessageLayout::find(const Bytes& message, const Place& from,
                                         const std::string& path) const {
  std::string complaint;
  if (const auto place = findIn(message, from, path, &complaint)) return *place;
  throw within(path, complaint);
}

/// nullopt with the complaint when there is none of that name or number.
std::optional<MessageLayout::Place> MessageLayout::findIn(const Bytes& message, const Place& from,
                                                          const std::string& path,
                                                          std::string* complaint) const {
  const auto none = [complaint](const std::string& why) {
    if (complaint != nullptr) *complaint = why;
    return std::nullopt;
  };
  Place place = from;
  for (const Step& step : stepsOf(path)) {
    if (place.array_size) return none("goes through an array: give an index, or name it under `each`");
    const auto fields = fields_.find(place.type);
    if (fields == fields_.end()) return none("goes below a " + place.type);
    std::size_t offset = place.offset;
    bool is_here = false;
    std::string names;
    for (const Field& field : fields->second) {
      const Place next = at(message, field, offset);
      names += (names.empty() ? "" : ", ") + field.name;
      if (field.name == step.name) {
        place = next;
        is_here = true;
        break;
      }
      offset = endOf(message, next);
    }
    if (!is_here) return none("does not exist: " + place.type + " has " + names);
    if (!step.index) continue;
    if (!place.array_size) return none("has an index, but " + step.name + " is no array");
    if (*step.index >= *place.array_size) {
      return none("does not exist: " + step.name + " has " + std::to_string(*place.array_size) + " elements");
    }
    for (std::size_t i = 0; i < *step.index; ++i) place.offset = endOfOne(message, place.type, place.offset);
    place.array_size.reset();
  }
  return place;
}

std::vector<MessageLayout::Place> MessageLayout::elements(const Bytes& message, const Place& array) const {
  if (!array.array_size) throw FieldError("a " + array.type + " is no array");
  std::vector<Place> places;
  std::size_t offset = array.offset;
  for (std::size_t i = 0; i < *array.array_size; ++i) {
    places.push_back({array.type, offset, std::nullopt});
    offset = endOfOne(message, array.type, offset);
  }
  return places;
}

double MessageLayout::number(const Bytes& message, const Place& from, const std::string& path) const {
  const Place place = find(message, from, path);
  if (place.array_size) throw within(path, "is an array: give an index, or name it under `each`");
  try {
    return numberAt(message, place.type, place.offset);
  } catch (const FieldError& problem) {
    throw within(path, problem.what());
  }
}

std::string MessageLayout::text(const Bytes& message, const Place& from, const std::string& path) const {
  const Place place = find(message, from, path);
  if (place.type != "string" || place.array_size) throw within(path, "is not a string but " + place.type);
  const std::size_t size = read<std::uint32_t>(message, place.offset);
  endOf(message, place);
  return std::string(reinterpret_cast<const char*>(message.data) + place.offset + 4, size);
}

ros::Time MessageLayout::time(const Bytes& message, const Place& from, const std::string& path) const {
  const Place place = find(message, from, path);
  if (place.type != "time" || place.array_size) throw within(path, "is not a time but " + place.type);
  return ros::Time(read<std::uint32_t>(message, place.offset),
                   read<std::uint32_t>(message, place.offset + 4));
}

MessageLayout::Place MessageLayout::at(const Bytes& message, const Field& field, std::size_t offset) const {
  Place place{field.type, offset, std::nullopt};
  if (!field.is_array) return place;
  if (field.fixed_size) {
    place.array_size = field.fixed_size;
  } else {
    place.array_size = read<std::uint32_t>(message, offset);
    place.offset += 4;
    if (*place.array_size > message.size) throw FieldError("the message is shorter than its definition says");
  }
  return place;
}

std::size_t MessageLayout::endOf(const Bytes& message, const Place& place) const {
  const std::size_t size = sizeOfBuiltin(place.type);
  std::size_t end = place.offset;
  if (size > 0) {
    const std::size_t count = place.array_size.value_or(1);
    if (count > message.size / size) throw FieldError("the message is too short for an array of its own");
    end += count * size;
  } else {
    for (std::size_t i = 0; i < place.array_size.value_or(1); ++i) end = endOfOne(message, place.type, end);
  }
  if (end > message.size) throw FieldError("the message is shorter than its definition says");
  return end;
}

std::size_t MessageLayout::endOfOne(const Bytes& message, const std::string& type, std::size_t offset) const {
  if (const std::size_t size = sizeOfBuiltin(type)) return offset + size;
  if (type == "string") {
    const std::size_t end = offset + 4 + read<std::uint32_t>(message, offset);
    if (end > message.size) throw FieldError("the message is shorter than its definition says");
    return end;
  }
  for (const Field& field : fieldsOf(type)) offset = endOf(message, at(message, field, offset));
  return offset;
}

}  // namespace sightline_ros
