// YAML files as parameter trees, with scalars typed as roslaunch types them (YAML 1.1 as PyYAML reads it,
// plus deg() and rad()), so that a file gives the same result to a node and to an offline tool.
#include <cmath>
#include <cstdlib>
#include <limits>
#include <regex>

#include <yaml-cpp/yaml.h>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {
namespace {

constexpr std::size_t kMostDepth = 50;      // levels of maps and lists in a file
constexpr std::size_t kMostValues = 20000;  // in a file
constexpr std::size_t kMostLetters = 200;   // of a name that is quoted

using XmlRpc::XmlRpcValue;

constexpr double kRadiansPerDegree = sightline::core::kDegree;

bool matches(const std::string& text, const std::regex& pattern) {
  return std::regex_match(text, pattern);
}

std::string without(const std::string& text, char unwanted) {
  std::string rest;
  for (char letter : text) {
    if (letter != unwanted) rest += letter;
  }
  return rest;
}

XmlRpcValue integerOf(const std::string& name, const std::string& scalar) {
  std::string digits = without(scalar, '_');
  const bool negative = digits[0] == '-';
  if (digits[0] == '-' || digits[0] == '+') digits.erase(0, 1);
  const bool binary = digits.size() > 2 && digits[1] == 'b';
  const long long magnitude =
      binary ? std::strtoll(digits.c_str() + 2, nullptr, 2) : std::strtoll(digits.c_str(), nullptr, 0);
  const long long value = negative ? -magnitude : magnitude;
  if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max()) {
    throw ParamError(name + ": the whole number " + scalar + " does not fit into 32 bits (add a point)");
  }
  return XmlRpcValue(static_cast<int>(value));
}

double infinityOrNan(const std::string& scalar) {
  static const std::regex nan("\\.(nan|NaN|NAN)");
  if (matches(scalar, nan)) return std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  return scalar[0] == '-' ? -infinity : infinity;
}

XmlRpcValue angleOf(const std::string& name, const std::string& scalar) {
  const std::string inner = scalar.substr(4, scalar.size() - 5);
  char* end = nullptr;
  const double angle = std::strtod(inner.c_str(), &end);
  if (inner.empty() || *end != '\0') {
    throw ParamError(name + ": expected a number within the brackets of " + scalar);
  }
  return XmlRpcValue(scalar[0] == 'd' ? angle * kRadiansPerDegree : angle);
}

XmlRpcValue plainScalar(const std::string& name, const std::string& scalar) {
  static const std::regex null("~|null|Null|NULL|");
  static const std::regex yes("yes|Yes|YES|true|True|TRUE|on|On|ON");
  static const std::regex no("no|No|NO|false|False|FALSE|off|Off|OFF");
  static const std::regex integer("[-+]?(0b[0-1_]+|0[0-7_]*|[1-9][0-9_]*|0x[0-9a-fA-F_]+)");
  static const std::regex real(
      "[-+]?[0-9][0-9_]*\\.[0-9_]*([eE][-+][0-9]+)?|[-+]?\\.[0-9][0-9_]*([eE][-+][0-9]+)?");
  static const std::regex infinite("[-+]?\\.(inf|Inf|INF)|\\.(nan|NaN|NAN)");
  static const std::regex angle("(deg|rad)\\([^)]*\\)");
  if (matches(scalar, null)) return XmlRpcValue();
  if (matches(scalar, yes)) return XmlRpcValue(true);
  if (matches(scalar, no)) return XmlRpcValue(false);
  if (matches(scalar, integer)) {
    return integerOf(name, scalar);
  }
  if (matches(scalar, real)) {
    return XmlRpcValue(std::strtod(without(scalar, '_').c_str(), nullptr));
  }
  if (matches(scalar, infinite)) return XmlRpcValue(infinityOrNan(scalar));
  if (matches(scalar, angle)) return angleOf(name, scalar);
  return XmlRpcValue(scalar);
}

/// `depth`: of the node below the root. `left`: how many more values the file may have, with those that
/// aliases repeat.
XmlRpcValue treeOf(const std::string& name, const YAML::Node& node, std::size_t depth, std::size_t& left) {
  if (depth > kMostDepth)
    throw ParamError(name.substr(0, kMostLetters) + "...: nested deeper than " + std::to_string(kMostDepth) +
                     " levels; does an alias (*) stand within what it repeats?");
  if (left-- == 0)
    throw ParamError(name + ": more than " + std::to_string(kMostValues) +
                     " values; do aliases (*) repeat one another?");
  if (node.IsScalar()) {
    const bool in_quotes = node.Tag() == "!";
    return in_quotes ? XmlRpcValue(node.Scalar()) : plainScalar(name, node.Scalar());
  }
  XmlRpcValue tree;
  if (node.IsSequence()) {
    tree.setSize(static_cast<int>(node.size()));
    for (std::size_t i = 0; i < node.size(); ++i) {
      tree[static_cast<int>(i)] = treeOf(name + "[" + std::to_string(i) + "]", node[i], depth + 1, left);
    }
  } else if (node.IsMap()) {
    tree.begin();  // makes it a struct, even when it stays empty
    for (const auto& member : node) {
      const std::string key = member.first.Scalar();
      if (tree.hasMember(key)) throw ParamError(name + "/" + key + ": given twice");
      tree[key] = treeOf(name + "/" + key, member.second, depth + 1, left);
    }
  }
  return tree;
}

XmlRpcValue treeOfFile(const std::string& file) {
  YAML::Node root;
  try {
    root = YAML::LoadFile(file);
  } catch (const YAML::BadFile&) {
    throw ParamError(file + ": cannot be opened (does it exist, and may it be read?)");
  } catch (const YAML::Exception& problem) {
    throw ParamError(file + ": not YAML: " + problem.what());
  }
  std::size_t left = kMostValues;
  return treeOf(file, root, 0, left);
}

bool isMap(const XmlRpcValue& tree) {
  return tree.valid() && tree.getType() == XmlRpcValue::TypeStruct;
}

/// Puts `upper` over `tree`: maps merge, anything else is replaced.
void overlay(XmlRpcValue& tree, XmlRpcValue& upper) {
  if (!isMap(tree) || !isMap(upper)) {
    tree = upper;
    return;
  }
  for (auto& member : upper) overlay(tree[member.first], member.second);
}

}  // namespace

ParamReader ParamReader::fromYaml(const std::string& file) {
  return ParamReader(treeOfFile(file), file);
}

ParamReader ParamReader::fromYamlFiles(const std::vector<std::string>& files) {
  XmlRpcValue tree;
  for (const std::string& file : files) {
    XmlRpcValue upper = treeOfFile(file);
    overlay(tree, upper);
  }
  return ParamReader(tree, files.empty() ? "" : files.back());
}

}  // namespace sightline_ros
