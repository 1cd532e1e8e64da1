#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "sightline/core/fusion/fusion_report.h"
#include "sightline/core/fusion/global_track.h"
#include "sightline/core/fusion/rules/fusion_rules.h"

/// What is said of a global track after a fusion.
namespace sightline::core {

/// Each source's share in the fused position, summing to one: by the position block of its gain.
std::vector<double> positionShares(const std::vector<Eigen::Matrix4d>& gains);

/// Says that `used` made the track's state, with these shares; `reporting` is the tracker whose report caused
/// the fusion.
void describeFusion(const GlobalTrack& track, const std::vector<std::size_t>& used,
                    const std::vector<double>& shares, const std::string& reporting, FusedTrack& description);

/// Says that nobody did, and the state is a prediction.
void describeCoasting(const GlobalTrack& track, FusedTrack& description);

/// Lists the supporters that were not used, each with the reason.
void describeLeftOut(const GlobalTrack& track,
                     const std::vector<std::pair<std::size_t, std::string>>& left_out,
                     FusedTrack& description);

}  // namespace sightline::core
