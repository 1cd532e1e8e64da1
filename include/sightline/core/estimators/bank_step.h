#pragma once

#include "sightline/core/estimators/mode_chain.h"
#include "sightline/core/estimators/noga_bank.h"
#include "sightline/core/estimators/noise_learning.h"

namespace sightline::core {

/// A step of NOGA's bank from one sighting to the next: all that is needed to take it again, and to come back
/// from what is known later (smoothing). Angles are in the chart of the later sighting.
struct BankStep {
  ResponseBank from;        ///< what each model believes at the earlier time, before the models interact
  ModeChain chain;          ///< at the earlier time
  NoiseLearning learning;   ///< at the earlier time
  BankAmplitude amplitude;  ///< of the process noise
  double h = 0.0;           ///< length [s], >= 0
  double unit = 1.0;        ///< of time [s], > 0
  bool is_coupled = false;  ///< whether covariances of azimuth with elevation are kept
  double passing = 0.0;     ///< density of the most agile straight model's further acceleration [rad^2/s^3]

  double units() const { return h / unit; }
};

}  // namespace sightline::core
