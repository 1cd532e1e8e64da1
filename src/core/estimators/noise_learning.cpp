#include "sightline/core/estimators/noise_learning.h"

#include <stdexcept>

namespace sightline::core {

NoiseLearning::NoiseLearning(const NoiseLearningParams& params)
    : params_(params), weight_(kOneSighting * params.trust) {
  if (!(params.memory > 0.0) || !(params.trust > 0.0) ||
      !(params.min_scale > 0.0 && params.min_scale <= 1.0) || !(params.max_scale >= 1.0) ||
      !std::isfinite(params.max_scale)) {
    throw std::invalid_argument(
        "NoiseLearningParams: memory > 0 s, trust > 0, min_scale in (0, 1] and a finite max_scale >= 1 are "
        "required");
  }
}

void NoiseLearning::enable(bool enabled) {
  params_.enabled = enabled;
  weight_ = kOneSighting * params_.trust;
  counts_ = false;
}

void NoiseLearning::fade(double h) {  // (S-11)
  const double least = kOneSighting * params_.trust;
  weight_ = least + (weight_ - least) * faded(h);
  counts_ = false;
}

void NoiseLearning::next(double h) {  // (S-11)
  fade(h);
  counts_ = sightings_ >= kSightingsOfTheRate;
  if (counts_)
    weight_ += kOneSighting;
  else
    ++sightings_;
}

}  // namespace sightline::core
