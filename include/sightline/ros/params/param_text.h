#pragma once

#include <set>
#include <string>
#include <vector>
#include <xmlrpcpp/XmlRpcValue.h>

/// The texts of which the messages about parameters are made.
namespace sightline_ros {

/// The shortest decimal text that reads back as `value`, without exponent for ordinary numbers.
std::string shortestText(double value);

/// A value of a parameter as a phrase: `the string "1e-3"`.
std::string textOf(XmlRpc::XmlRpcValue& value);

/// For a string that looks like a number: how to write it so that YAML reads a number. Empty otherwise.
std::string remedyForNumber(XmlRpc::XmlRpcValue& value);

/// The name of `asked` that is nearest to `unknown`, when a spelling error could explain the difference.
/// Empty otherwise.
std::string nearestName(const std::string& unknown, const std::set<std::string>& asked);

std::string quoted(const std::string& text);
std::string joined(const std::vector<std::string>& parts, const std::string& separator);

}  // namespace sightline_ros
