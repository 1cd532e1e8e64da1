#include "sightline/core/smoothing/smoothing_bank.h"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "support/simulated.h"

namespace sightline::core {
namespace {

EstimatorParams paramsOf(EstimatorKind kind) {
  EstimatorParams params;
  params.kind = kind;
  return params;
}

TEST(SmoothingBank, IsTheOwnBankOfNoga) {
  const NogaConsistentParams bank = smoothingBankOf(paramsOf(EstimatorKind::noga));
  EXPECT_EQ(bank.models.size(), defaultResponseModels().size());
  EXPECT_TRUE(bank.noise.enabled);
}

TEST(SmoothingBank, OfAKalmanFilterFiltersAsItDoes) {
  for (const double density : {0.0, 0.3}) {
    EstimatorParams params = paramsOf(EstimatorKind::kalman);
    params.kalman.process_noise = density;
    const auto kalman = makeEstimator(params);
    NogaConsistentEstimator bank(smoothingBankOf(params));
    int count = 0;
    for (const Measurement& sighting : test::sightingsOf(test::sinusoid, 0.08, 1, 3.0)) {
      kalman->update(sighting);
      bank.update(sighting);
      if (++count < 3) continue;
      EXPECT_TRUE(kalman->stateAt(sighting.time)->mean.isApprox(bank.stateAt(sighting.time)->mean, 1e-9));
      EXPECT_TRUE(
          kalman->stateAt(sighting.time)->covariance.isApprox(bank.stateAt(sighting.time)->covariance, 1e-9));
    }
  }
}

TEST(SmoothingBank, OfAnImmFiltersNearlyAsItDoes) {
  const EstimatorParams params = paramsOf(EstimatorKind::imm);
  const auto imm = makeEstimator(params);
  NogaConsistentEstimator bank(smoothingBankOf(params));
  for (const Measurement& sighting : test::sightingsOf(test::sinusoid, 0.08, 1, 5.0)) {
    imm->update(sighting);
    bank.update(sighting);
    if (test::timeOf(sighting) < 1.0) continue;
    EXPECT_NEAR(imm->stateAt(sighting.time)->mean(0), bank.stateAt(sighting.time)->mean(0), 0.1 * 0.08);
  }
}

TEST(SmoothingBank, OfTwblsHasItsWhiteAccelerations) {
  const EstimatorParams params = paramsOf(EstimatorKind::twbls);
  const NogaConsistentParams bank = smoothingBankOf(params);
  ASSERT_EQ(bank.models.size(), params.twbls_consistent.process_noises.size());
  for (const ResponseModel& model : bank.models) EXPECT_EQ(model.kind, ResponseModel::Kind::straight);
}

TEST(SmoothingBank, RefusesTheFormsThatHaveNoModelAndDensitiesOfBothKinds) {
  EstimatorParams params = paramsOf(EstimatorKind::noga);
  params.noga_form = EstimatorForm::paper;
  try {
    smoothingBankOf(params);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("consistent"), std::string::npos) << error.what();
  }
  params = paramsOf(EstimatorKind::twbls);
  params.twbls_form = EstimatorForm::paper;
  EXPECT_THROW(smoothingBankOf(params), std::invalid_argument);
  params = paramsOf(EstimatorKind::imm);
  params.imm.models[1].noise.density = 1e-3;
  EXPECT_THROW(smoothingBankOf(params), std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
