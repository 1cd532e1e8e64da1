#pragma once

#include <set>
#include <string>
#include <vector>
#include <xmlrpcpp/XmlRpcValue.h>

#include "sightline/ros/params/param_reader.h"

/// How the parameter reader's messages put things.
namespace sightline_ros {

/// `a number in (0, 1) [rad]`.
std::string expectedNumber(const Range& range, const std::string& unit);

/// What is there, as a phrase: `the string "1e-3"`.
std::string inWords(XmlRpc::XmlRpcValue& value);

/// For a string that looks like a number: how to write it so that YAML sees one. Empty otherwise.
std::string remedyForNumber(XmlRpc::XmlRpcValue& value);

/// The asked-for name nearest to `unknown`, when a slip of the pen could explain it. Empty otherwise.
std::string nearestName(const std::string& unknown, const std::set<std::string>& asked);

std::string quoted(const std::string& text);
std::string joined(const std::vector<std::string>& parts, const std::string& separator);

}  // namespace sightline_ros
