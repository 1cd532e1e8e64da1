#pragma once

#include <string>

#include "sightline/core/association/gate.h"
#include "sightline/core/estimators/estimators.h"
#include "sightline/core/tracking/local_tracker.h"
#include "sightline/core/tracking/tracklet_builder.h"
#include "sightline/ros/params/param_reader.h"

/// Loaders of the parameter structs that make a local tracker. Each reads the keys of its own level, named as
/// the fields; defaults, units and meaning are at the structs. They throw ParamError.
namespace sightline_ros {

sightline::core::GateParams loadGateParams(const ParamReader& reader,
                                           sightline::core::GateParams defaults = {});
sightline::core::LifecycleParams loadLifecycleParams(const ParamReader& reader,
                                                     sightline::core::LifecycleParams defaults = {});
sightline::core::DetectionParams loadDetectionParams(const ParamReader& reader,
                                                     sightline::core::DetectionParams defaults = {});
sightline::core::SensorHealthParams loadSensorHealthParams(const ParamReader& reader,
                                                           sightline::core::SensorHealthParams defaults = {});

/// The guard's own and, at the same level, those of the watch over each sensor.
sightline::core::GuardParams loadGuardParams(const ParamReader& reader,
                                             sightline::core::GuardParams defaults = {});
sightline::core::TwblsParams loadTwblsParams(const ParamReader& reader,
                                             sightline::core::TwblsParams defaults = {});
sightline::core::TwblsConsistentParams loadTwblsConsistentParams(
    const ParamReader& reader, sightline::core::TwblsConsistentParams defaults = {});
sightline::core::NogaParams loadNogaParams(const ParamReader& reader,
                                           sightline::core::NogaParams defaults = {});
sightline::core::NogaConsistentParams loadNogaConsistentParams(
    const ParamReader& reader, sightline::core::NogaConsistentParams defaults = {});
sightline::core::KalmanParams loadKalmanParams(const ParamReader& reader,
                                               sightline::core::KalmanParams defaults = {});
sightline::core::ImmParams loadImmParams(const ParamReader& reader, sightline::core::ImmParams defaults = {});

/// `estimator` (a name of core::estimatorTable()) and a sub-namespace of settings for each, named as it is.
sightline::core::EstimatorParams loadEstimatorParams(const ParamReader& reader,
                                                     sightline::core::EstimatorParams defaults = {});

/// All of the above with `gate`, `lifecycle`, `detection` and `guard`, and the tracker's own.
sightline::core::LocalTrackerParams loadLocalTrackerParams(const ParamReader& reader,
                                                           sightline::core::LocalTrackerParams defaults = {});

/// `enabled`, `interval`, `span`, `nodes`.
sightline::core::TrackletParams loadTrackletParams(const ParamReader& reader,
                                                   sightline::core::TrackletParams defaults = {});

/// Its name in core::estimatorTable().
std::string nameOf(sightline::core::EstimatorKind kind);

}  // namespace sightline_ros
