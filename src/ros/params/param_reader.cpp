#include "sightline/ros/params/param_reader.h"

#include <algorithm>
#include <map>
#include <set>

#include "sightline/ros/params/param_text.h"

namespace sightline_ros {

using XmlRpc::XmlRpcValue;

/// Full names of what was asked for; shared by a reader, its copies and its sub-readers.
struct ParamReader::Memory {
  std::set<std::string> read;                ///< leaves
  std::set<std::string> entered;             ///< namespaces and lists of maps
  std::set<std::string> differences;         ///< leaves whose value is not the fallback, or that are absent
  std::map<std::string, ReadParam> scalars;  ///< leaves that have a fallback; `key` is the full name
};

namespace {

bool isNumber(XmlRpcValue& value) {
  return value.getType() == XmlRpcValue::TypeInt || value.getType() == XmlRpcValue::TypeDouble;
}

double asNumber(XmlRpcValue& value) {
  return value.getType() == XmlRpcValue::TypeInt ? static_cast<int>(value) : static_cast<double>(value);
}

ParamError complaint(const std::string& name, const std::string& expected, XmlRpcValue& got,
                     const std::string& remedy = "") {
  return ParamError(name + ": expected " + expected + ", got " + textOf(got) + remedy);
}

double checkedNumber(const std::string& name, XmlRpcValue& value, const Range& range,
                     const std::string& unit) {
  if (!isNumber(value)) {
    throw complaint(name, expectedNumber(range, unit), value, remedyForNumber(value));
  }
  const double number = asNumber(value);
  if (!range.holds(number)) throw complaint(name, expectedNumber(range, unit), value);
  return number;
}

std::string checkedText(const std::string& name, XmlRpcValue& value) {
  if (value.getType() != XmlRpcValue::TypeString) {
    throw complaint(name, "a string", value, " (put it in quotes)");
  }
  return static_cast<std::string>(value);
}

std::string element(const std::string& name, int index) {
  return name + "[" + std::to_string(index) + "]";
}

std::vector<double> checkedNumbers(const std::string& name, XmlRpcValue& value, const Range& each,
                                   const std::string& unit) {
  if (value.getType() != XmlRpcValue::TypeArray) {
    throw complaint(name, "a list, each " + expectedNumber(each, unit), value);
  }
  std::vector<double> numbers;
  for (int i = 0; i < value.size(); ++i) {
    numbers.push_back(checkedNumber(element(name, i), value[i], each, unit));
  }
  return numbers;
}

std::vector<std::string> checkedTexts(const std::string& name, XmlRpcValue& value) {
  if (value.getType() != XmlRpcValue::TypeArray) throw complaint(name, "a list of strings", value);
  std::vector<std::string> texts;
  for (int i = 0; i < value.size(); ++i) texts.push_back(checkedText(element(name, i), value[i]));
  return texts;
}

/// Full names below `tree` that are in neither set, outermost first.
void collectUnread(XmlRpcValue& tree, const std::string& name, const std::set<std::string>& read,
                   const std::set<std::string>& entered, std::vector<std::string>& unread) {
  if (tree.getType() == XmlRpcValue::TypeArray) {
    for (int i = 0; i < tree.size(); ++i) collectUnread(tree[i], element(name, i), read, entered, unread);
    return;
  }
  if (tree.getType() != XmlRpcValue::TypeStruct) return;
  for (auto& [key, value] : tree) {
    const std::string full = name + "/" + key;
    if (read.count(full) > 0) continue;
    if (entered.count(full) > 0) {
      collectUnread(value, full, read, entered, unread);
    } else {
      unread.push_back(full);
    }
  }
}

std::shared_ptr<XmlRpcValue> treeBelow(const ros::NodeHandle& nh) {
  auto tree = std::make_shared<XmlRpcValue>();
  nh.getParam(nh.getNamespace(), *tree);
  return tree;
}

}  // namespace

ParamReader::ParamReader(const ros::NodeHandle& nh)
    : ParamReader(treeBelow(nh), nh.getNamespace(), std::make_shared<Memory>()) {}

ParamReader::ParamReader(const XmlRpcValue& tree, std::string name)
    : ParamReader(std::make_shared<XmlRpcValue>(tree), std::move(name), std::make_shared<Memory>()) {}

ParamReader::ParamReader(std::shared_ptr<XmlRpcValue> tree, std::string name, std::shared_ptr<Memory> memory)
    : tree_(std::move(tree)), name_(std::move(name)), memory_(std::move(memory)) {
  if (tree_->valid() && tree_->getType() != XmlRpcValue::TypeStruct) {
    throw complaint(name_, "a namespace with parameters", *tree_);
  }
}

std::string ParamReader::fullName(const std::string& key) const {
  return name_ + "/" + key;
}

XmlRpcValue* ParamReader::find(const std::string& key) const {
  return tree_->valid() && tree_->hasMember(key) ? &(*tree_)[key] : nullptr;
}

XmlRpcValue& ParamReader::findRequired(const std::string& key, const std::string& expected) const {
  XmlRpcValue* value = find(key);
  if (value == nullptr) throw error(key, "expected " + expected + ", but it is not set (it is required)");
  return *value;
}

void ParamReader::remember(const std::string& key, bool equals_fallback) const {
  memory_->read.insert(fullName(key));
  if (!equals_fallback) memory_->differences.insert(fullName(key));
}

void ParamReader::remember(const std::string& key, ReadParam read) const {
  read.key = fullName(key);
  memory_->scalars[read.key] = std::move(read);
}

ParamReader ParamReader::sub(const std::string& key) const {
  memory_->entered.insert(fullName(key));
  XmlRpcValue* value = find(key);
  return {std::make_shared<XmlRpcValue>(value != nullptr ? *value : XmlRpcValue()), fullName(key), memory_};
}

ParamReader ParamReader::with(const std::string& key, const XmlRpcValue& value) const {
  auto tree = std::make_shared<XmlRpcValue>(*tree_);
  (*tree)[key] = value;
  return {tree, name_, memory_};
}

ParamReader ParamReader::withKey(const std::string& path, const XmlRpcValue& value) const {
  auto tree = std::make_shared<XmlRpcValue>(*tree_);
  XmlRpcValue* place = tree.get();
  std::size_t from = 0;
  for (std::size_t slash = path.find('/'); slash != std::string::npos; slash = path.find('/', from)) {
    place = &(*place)[path.substr(from, slash - from)];
    from = slash + 1;
  }
  (*place)[path.substr(from)] = value;
  return {tree, name_, std::make_shared<Memory>()};
}

std::vector<ParamReader> ParamReader::list(const std::string& key) const {
  memory_->entered.insert(fullName(key));
  std::vector<ParamReader> readers;
  XmlRpcValue* value = find(key);
  if (value == nullptr) {
    memory_->differences.insert(fullName(key));
    return readers;
  }
  if (value->getType() != XmlRpcValue::TypeArray) throw complaint(fullName(key), "a list of maps", *value);
  for (int i = 0; i < value->size(); ++i) {
    if ((*value)[i].getType() != XmlRpcValue::TypeStruct) {
      throw complaint(element(fullName(key), i), "a map of parameters", (*value)[i]);
    }
    readers.push_back({std::make_shared<XmlRpcValue>((*value)[i]), element(fullName(key), i), memory_});
  }
  return readers;
}

bool ParamReader::has(const std::string& key) const {
  return find(key) != nullptr;
}

std::vector<std::string> ParamReader::keys() const {
  std::vector<std::string> keys;
  if (!tree_->valid()) return keys;
  for (const auto& member : *tree_) keys.push_back(member.first);
  return keys;
}

double ParamReader::number(const std::string& key, double fallback, const Range& range,
                           const std::string& unit) const {
  XmlRpcValue* value = find(key);
  const double number = value != nullptr ? checkedNumber(fullName(key), *value, range, unit) : fallback;
  remember(key, value != nullptr && number == fallback);
  remember(key, ReadParam{"", ReadParam::Kind::number, number, fallback, range, unit, {}});
  return number;
}

int ParamReader::integer(const std::string& key, int fallback, int low, int high) const {
  XmlRpcValue* value = find(key);
  const auto note = [&](int integer) {
    remember(key, ReadParam{"", ReadParam::Kind::integer, integer, fallback, between(low, high), "", {}});
  };
  if (value == nullptr) {
    remember(key, false);
    note(fallback);
    return fallback;
  }
  const std::string expected =
      "a whole number in [" + std::to_string(low) + ", " + std::to_string(high) + "]";
  if (value->getType() != XmlRpcValue::TypeInt) throw complaint(fullName(key), expected, *value);
  const int integer = static_cast<int>(*value);
  if (integer < low || integer > high) throw complaint(fullName(key), expected, *value);
  remember(key, integer == fallback);
  note(integer);
  return integer;
}

bool ParamReader::flag(const std::string& key, bool fallback) const {
  XmlRpcValue* value = find(key);
  const bool is_boolean = value != nullptr && value->getType() == XmlRpcValue::TypeBoolean;
  if (value != nullptr && !is_boolean) throw complaint(fullName(key), "true or false", *value);
  const bool flag = is_boolean ? static_cast<bool>(*value) : fallback;
  remember(key, is_boolean && flag == fallback);
  remember(key, ReadParam{"", ReadParam::Kind::flag, XmlRpcValue(flag), XmlRpcValue(fallback), {}, "", {}});
  return flag;
}

std::string ParamReader::text(const std::string& key, const std::string& fallback) const {
  XmlRpcValue* value = find(key);
  std::string text = value != nullptr ? checkedText(fullName(key), *value) : fallback;
  remember(key, value != nullptr && text == fallback);
  remember(key, ReadParam{"", ReadParam::Kind::text, text, fallback, {}, "", {}});
  return text;
}

std::string ParamReader::choice(const std::string& key, const std::string& fallback,
                                const std::vector<std::string>& choices) const {
  std::string chosen = text(key, fallback);
  if (std::find(choices.begin(), choices.end(), chosen) == choices.end()) {
    throw error(key, "expected one of " + joined(choices, ", ") + ", got the string " +
                         sightline_ros::quoted(chosen));  // not std::quoted
  }
  memory_->scalars.at(fullName(key)).choices = choices;
  return chosen;
}

std::vector<std::string> ParamReader::texts(const std::string& key,
                                            const std::vector<std::string>& fallback) const {
  XmlRpcValue* value = find(key);
  std::vector<std::string> texts = value != nullptr ? checkedTexts(fullName(key), *value) : fallback;
  remember(key, value != nullptr && texts == fallback);
  return texts;
}

std::vector<double> ParamReader::numbers(const std::string& key, const std::vector<double>& fallback,
                                         const Range& each, const std::string& unit) const {
  XmlRpcValue* value = find(key);
  std::vector<double> numbers =
      value != nullptr ? checkedNumbers(fullName(key), *value, each, unit) : fallback;
  remember(key, value != nullptr && numbers == fallback);
  return numbers;
}

double ParamReader::requiredNumber(const std::string& key, const Range& range,
                                   const std::string& unit) const {
  remember(key, true);
  return checkedNumber(fullName(key), findRequired(key, expectedNumber(range, unit)), range, unit);
}

std::string ParamReader::requiredText(const std::string& key) const {
  remember(key, true);
  std::string text = checkedText(fullName(key), findRequired(key, "a string"));
  if (text.empty()) throw error(key, "expected a string that is not empty");
  return text;
}

std::vector<std::string> ParamReader::requiredTexts(const std::string& key) const {
  remember(key, true);
  std::vector<std::string> texts = checkedTexts(fullName(key), findRequired(key, "a list of strings"));
  if (texts.empty())
    throw error(key, "expected a list of strings with at least one element, got an empty list");
  return texts;
}

std::vector<double> ParamReader::requiredNumbers(const std::string& key, const Range& each,
                                                 const std::string& unit) const {
  remember(key, true);
  const std::string expected = "a list, each " + expectedNumber(each, unit);
  std::vector<double> numbers = checkedNumbers(fullName(key), findRequired(key, expected), each, unit);
  if (numbers.empty()) throw error(key, "expected " + expected + ", got an empty list");
  return numbers;
}

ParamError ParamReader::error(const std::string& key, const std::string& complaint) const {
  return ParamError(fullName(key) + ": " + complaint);
}

void ParamReader::finish() const {
  std::vector<std::string> unread;
  collectUnread(*tree_, name_, memory_->read, memory_->entered, unread);
  if (unread.empty()) return;

  std::set<std::string> asked = memory_->read;
  asked.insert(memory_->entered.begin(), memory_->entered.end());
  std::vector<std::string> complaints;
  for (const std::string& name : unread) {
    const std::string meant = nearestName(name, asked);
    complaints.push_back(name + ": nobody reads this parameter" +
                         (meant.empty() ? " (remove it)" : " (did you mean " + meant + "?)"));
  }
  throw ParamError(joined(complaints, "; "));
}

bool ParamReader::isBelow(const std::string& name) const {
  return name.compare(0, name_.size(), name_) == 0 && name.size() > name_.size() && name[name_.size()] == '/';
}

std::vector<ReadParam> ParamReader::readParams() const {
  std::vector<ReadParam> below;
  for (const auto& [name, read] : memory_->scalars) {
    if (!isBelow(name)) continue;
    below.push_back(read);
    below.back().key = name.substr(name_.size() + 1);
  }
  return below;
}

std::vector<std::string> ParamReader::differences() const {
  std::vector<std::string> below;
  for (const std::string& name : memory_->differences)
    if (isBelow(name)) below.push_back(name);
  return below;
}

}  // namespace sightline_ros
