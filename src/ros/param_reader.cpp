#include "sightline/ros/param_reader.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <sstream>

namespace sightline_ros {

using XmlRpc::XmlRpcValue;

/// Full names of what was asked for; shared by a reader, its copies and its sub-readers.
struct ParamReader::Memory {
  std::set<std::string> read;         ///< leaves
  std::set<std::string> entered;      ///< namespaces and lists of maps
  std::set<std::string> differences;  ///< leaves whose value is not the fallback, or that are absent
};

namespace {

/// The shortest decimal text that reads back as `value`, without exponent for ordinary numbers.
std::string shortest(double value) {
  const int digits_before_point =
      std::abs(value) >= 1.0 && std::isfinite(value) ? 1 + static_cast<int>(std::log10(std::abs(value))) : 1;
  char text[64];
  for (int digits = std::min(digits_before_point, 15); digits <= 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  return text;
}

/// The shortest text with sign and point in which YAML sees a number, e.g. 1.0e-03.
std::string withSignAndPoint(double value) {
  char text[64];
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*e", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  return text;
}

std::string inWords(const Range& range) {
  const bool bounded_below = std::isfinite(range.low);
  const bool bounded_above = std::isfinite(range.high);
  if (!bounded_below && !bounded_above) return "";
  if (!bounded_above) return (range.low_open ? " > " : " >= ") + shortest(range.low);
  if (!bounded_below) return (range.high_open ? " < " : " <= ") + shortest(range.high);
  return std::string(" in ") + (range.low_open ? "(" : "[") + shortest(range.low) + ", " +
         shortest(range.high) + (range.high_open ? ")" : "]");
}

std::string expectedNumber(const Range& range, const std::string& unit) {
  return "a number" + inWords(range) + (unit.empty() ? "" : " [" + unit + "]");
}

std::string quoted(const std::string& text) {
  return '"' + text + '"';
}

std::string joined(const std::vector<std::string>& parts, const std::string& separator) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : separator) + part;
  return all;
}

/// What is there, as a phrase: `the string "1e-3"`.
std::string inWords(XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value) ? "true" : "false";
    case XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int>(value));
    case XmlRpcValue::TypeDouble:
      return shortest(static_cast<double>(value));
    case XmlRpcValue::TypeString:
      return "the string " + quoted(static_cast<std::string>(value));
    case XmlRpcValue::TypeArray:
      return "a list of " + std::to_string(value.size());
    case XmlRpcValue::TypeStruct:
      return "a namespace with parameters";
    default:
      return "no value";
  }
}

/// For a string that looks like a number: how to write it so that YAML sees one. Empty otherwise.
std::string remedyForNumber(XmlRpcValue& value) {
  if (value.getType() != XmlRpcValue::TypeString) return "";
  const std::string text = static_cast<std::string>(value);
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(number)) return "";
  return " (write " + shortest(number) + " or " + withSignAndPoint(number) + " with a sign and a point)";
}

bool isNumber(XmlRpcValue& value) {
  return value.getType() == XmlRpcValue::TypeInt || value.getType() == XmlRpcValue::TypeDouble;
}

double asNumber(XmlRpcValue& value) {
  return value.getType() == XmlRpcValue::TypeInt ? static_cast<int>(value) : static_cast<double>(value);
}

ParamError complaint(const std::string& name, const std::string& expected, XmlRpcValue& got,
                     const std::string& remedy = "") {
  return ParamError(name + ": expected " + expected + ", got " + inWords(got) + remedy);
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

/// Number of single-letter edits between two words (Levenshtein).
std::size_t editsBetween(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

/// The asked-for name nearest to `unknown`, when a slip of the pen could explain it. Empty otherwise.
std::string nearest(const std::string& unknown, const std::set<std::string>& asked) {
  const std::string key = unknown.substr(unknown.rfind('/') + 1);
  std::size_t fewest = 1 + std::max<std::size_t>(2, key.size() / 3);
  std::string best;
  for (const std::string& candidate : asked) {
    const std::size_t edits = editsBetween(unknown, candidate);
    if (edits < fewest) {
      fewest = edits;
      best = candidate;
    }
  }
  return best;
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

bool Range::holds(double value) const {
  return std::isfinite(value) && (low_open ? value > low : value >= low) &&
         (high_open ? value < high : value <= high);
}

Range anyNumber() {
  return Range{};
}

Range atLeast(double low) {
  Range range;
  range.low = low;
  return range;
}

Range above(double low) {
  Range range = atLeast(low);
  range.low_open = true;
  return range;
}

Range between(double low, double high) {
  return Range{low, high, false, false};
}

Range inside(double low, double high) {
  return Range{low, high, true, true};
}

ParamReader::ParamReader(const ros::NodeHandle& nh)
    : ParamReader(treeBelow(nh), nh.getNamespace(), std::make_shared<Memory>()) {}

ParamReader::ParamReader(XmlRpcValue tree, std::string name)
    : ParamReader(std::make_shared<XmlRpcValue>(std::move(tree)), std::move(name),
                  std::make_shared<Memory>()) {}

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
  return number;
}

int ParamReader::integer(const std::string& key, int fallback, int low, int high) const {
  XmlRpcValue* value = find(key);
  if (value == nullptr) {
    remember(key, false);
    return fallback;
  }
  const std::string expected =
      "a whole number in [" + std::to_string(low) + ", " + std::to_string(high) + "]";
  if (value->getType() != XmlRpcValue::TypeInt) throw complaint(fullName(key), expected, *value);
  const int integer = static_cast<int>(*value);
  if (integer < low || integer > high) throw complaint(fullName(key), expected, *value);
  remember(key, integer == fallback);
  return integer;
}

bool ParamReader::flag(const std::string& key, bool fallback) const {
  XmlRpcValue* value = find(key);
  if (value == nullptr) {
    remember(key, false);
    return fallback;
  }
  if (value->getType() != XmlRpcValue::TypeBoolean) throw complaint(fullName(key), "true or false", *value);
  const bool flag = static_cast<bool>(*value);
  remember(key, flag == fallback);
  return flag;
}

std::string ParamReader::text(const std::string& key, const std::string& fallback) const {
  XmlRpcValue* value = find(key);
  const std::string text = value != nullptr ? checkedText(fullName(key), *value) : fallback;
  remember(key, value != nullptr && text == fallback);
  return text;
}

std::string ParamReader::choice(const std::string& key, const std::string& fallback,
                                const std::vector<std::string>& choices) const {
  const std::string chosen = text(key, fallback);
  if (std::find(choices.begin(), choices.end(), chosen) == choices.end()) {
    throw error(key, "expected one of " + joined(choices, ", ") + ", got the string " + quoted(chosen));
  }
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
    const std::string meant = nearest(name, asked);
    complaints.push_back(name + ": nobody reads this parameter" +
                         (meant.empty() ? " (remove it)" : " (did you mean " + meant + "?)"));
  }
  throw ParamError(joined(complaints, "; "));
}

std::vector<std::string> ParamReader::differences() const {
  std::vector<std::string> below;
  for (const std::string& name : memory_->differences) {
    const bool element_of =
        name.compare(0, name_.size(), name_) == 0 && name.size() > name_.size() && name[name_.size()] == '/';
    if (element_of) below.push_back(name);
  }
  return below;
}

}  // namespace sightline_ros
