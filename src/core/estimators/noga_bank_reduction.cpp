// How ResponseBank takes a sighting.
#include "sightline/core/estimators/noga_bank.h"

namespace sightline::core {
namespace {

constexpr double kOutlierReach = 20.0;  // sigmas of the innovation over which outliers lie at least: a track
                                        // that has just started must believe its second sighting

}  // namespace

/// A sighting against what each model of a block expects.
struct ResponseBank::Innovation {
  Lanes nu[2];
  Lanes R[2];      // variances of the sighting, by what each model has learnt of the noise ...
  Lanes R_cross;   // ... and covariance
  Lanes D[2];      // variances of the innovation
  Lanes D_cross;   // its covariance, where channels are coupled
  Lanes taken[2];  // share of the sighting that is the target's
};

ModeArray ResponseBank::reduce(const Measurement& measurement, const SoftGate& gate,
                               const NoiseLearning& learning, const BankAmplitude& amplitude,
                               bool is_coupled) {
  const Eigen::Matrix2d& R = measurement.covariance;
  ModeArray log_likelihoods(models_);
  for (int b = 0; b < blocks(); ++b) {
    Block& block = blocks_[static_cast<std::size_t>(b)];
    Innovation innovation;
    for (int c = 0; c < 2; ++c) {
      const Channel& channel = block.channel[c];
      innovation.nu[c] = measurement.position(c) - channel.mean[0];
      innovation.R[c] = R(c, c) * channel.noise;
      innovation.D[c] = channel.covariance(0, 0) + innovation.R[c];
    }
    Lanes log_likelihood[2], outlier_density[2];
    Lanes white[2] = {innovation.nu[0], innovation.nu[1]}, pivot[2] = {innovation.D[0], innovation.D[1]};
    if (is_coupled) {  // D = L diag(pivot) L^T
      innovation.R_cross = R(0, 1) * (block.channel[0].noise * block.channel[1].noise).sqrt();
      innovation.D_cross = block.cross[0][0] + innovation.R_cross;
      const Lanes factor = innovation.D_cross / pivot[0];
      pivot[1] -= factor * innovation.D_cross;
      white[1] -= factor * white[0];
    }
    for (int c = 0; c < 2; ++c) {
      const Lanes distance_squared = white[c].square() / pivot[c];
      log_likelihood[c] = learning.logDensity(distance_squared, Lanes(pivot[c].log()));
      const Lanes widest = (gate.outlier_width * gate.outlier_width * squaredAmplitude(block, c, amplitude))
                               .max(kOutlierReach * kOutlierReach * innovation.D[c]);
      outlier_density[c] = widest.rsqrt();
    }
    Lanes log_mixture;
    if (is_coupled) {
      innovation.taken[0] = innovation.taken[1] = takenShare(
          log_likelihood[0] + log_likelihood[1], outlier_density[0] * outlier_density[1], gate, log_mixture);
      reduceTogether(block, innovation);
    } else {
      Lanes second;
      innovation.taken[0] = takenShare(log_likelihood[0], outlier_density[0], gate, log_mixture);
      innovation.taken[1] = takenShare(log_likelihood[1], outlier_density[1], gate, second);
      log_mixture += second;
      reduceApart(block, innovation);
    }
    for (int lane = 0; lane < kLanes && b * kLanes + lane < models_; ++lane)
      log_likelihoods(b * kLanes + lane) = log_mixture(lane);
    if (measurement.is_certain) learnNoise(block, innovation, learning, is_coupled);
  }
  return log_likelihoods;
}

/// The share of a sighting that is the target's, when outliers are spread evenly.
ResponseBank::Lanes ResponseBank::takenShare(const Lanes& log_likelihood, const Lanes& outlier_density,
                                             const SoftGate& gate, Lanes& log_mixture) {  // (S-28)
  if (gate.outlier_share == 0.0) {
    log_mixture = log_likelihood;
    return Lanes::Ones();
  }
  const Lanes genuine = (1.0 - gate.outlier_share) * log_likelihood.exp();
  const Lanes mixture = genuine + gate.outlier_share * outlier_density;
  log_mixture = mixture.log();
  return genuine / mixture;
}

void ResponseBank::reduceApart(Block& block, const Innovation& innovation) {
  for (int c = 0; c < 2; ++c) {
    Channel& channel = block.channel[c];
    SymmetricLanes& P = channel.covariance;
    const Lanes &nu = innovation.nu[c], &D = innovation.D[c], &taken = innovation.taken[c];
    Lanes K[4];
    for (int i = 0; i < 4; ++i) K[i] = P(0, i) / D;
    // P - K D K^T where the sighting is taken (S-7); what has to do with the position is R / D of what it
    // was, free of the cancellation in 1 - K. The rest is P plus K K^T times this:
    const Lanes spread = taken * ((1.0 - taken) * nu.square() - D);
    for (int i = 1; i < 4; ++i)
      for (int j = i; j < 4; ++j) P(i, j) += spread * K[i] * K[j];
    const Lanes kept =
        1.0 - taken + taken * innovation.R[c] / D + taken * (1.0 - taken) * nu.square() * K[0] / D;
    for (int j = 0; j < 4; ++j) P(0, j) *= kept;
    for (int i = 0; i < 4; ++i) channel.mean[i] += taken * nu * K[i];
  }
}

void ResponseBank::reduceTogether(Block& block, const Innovation& innovation) {
  const Lanes &taken = innovation.taken[0], *nu = innovation.nu, *D = innovation.D;
  const Lanes per_determinant = 1.0 / (D[0] * D[1] - innovation.D_cross.square());
  const Lanes inverse[2][2] = {{D[1] * per_determinant, -innovation.D_cross * per_determinant},
                               {-innovation.D_cross * per_determinant, D[0] * per_determinant}};
  // Covariances of all eight components with the two positions, and the gains.
  Lanes PH[2][4][2], K[2][4][2], shift[2][4];
  for (int i = 0; i < 4; ++i) {
    PH[0][i][0] = block.channel[0].covariance(0, i);
    PH[0][i][1] = block.cross[i][0];
    PH[1][i][0] = block.cross[0][i];
    PH[1][i][1] = block.channel[1].covariance(0, i);
  }
  for (int c = 0; c < 2; ++c) {
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 2; ++k) K[c][i][k] = PH[c][i][0] * inverse[0][k] + PH[c][i][1] * inverse[1][k];
      shift[c][i] = K[c][i][0] * nu[0] + K[c][i][1] * nu[1];
      block.channel[c].mean[i] += taken * shift[c][i];
    }
  }
  // P - K D K^T where the sighting is taken (S-7); the rows of the positions are R D^-1 of what they were,
  // free of the cancellation in 1 - K.
  const Lanes R[2][2] = {{innovation.R[0], innovation.R_cross}, {innovation.R_cross, innovation.R[1]}};
  Lanes kept[2][2];
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 2; ++k) kept[i][k] = R[i][0] * inverse[0][k] + R[i][1] * inverse[1][k];
  const Lanes doubt = taken * (1.0 - taken);
  const auto reduced = [&](const Lanes& P, int c, int i, int d, int j) {
    const Lanes both = doubt * shift[c][i] * shift[d][j];
    if (i == 0)
      return Lanes((1.0 - taken) * P + taken * (kept[c][0] * PH[d][j][0] + kept[c][1] * PH[d][j][1]) + both);
    if (j == 0)
      return Lanes((1.0 - taken) * P + taken * (kept[d][0] * PH[c][i][0] + kept[d][1] * PH[c][i][1]) + both);
    return Lanes(P - taken * (K[c][i][0] * PH[d][j][0] + K[c][i][1] * PH[d][j][1]) + both);
  };
  for (int c = 0; c < 2; ++c) {
    SymmetricLanes& P = block.channel[c].covariance;
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j) P(i, j) = reduced(P(i, j), c, i, c, j);
  }
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) block.cross[i][j] = reduced(block.cross[i][j], 0, i, 1, j);
}

/// Takes the innovations, squared and over what was expected of them, as evidence of the sightings' noise;
/// the angles' covariance grows and shrinks with it, as does every gain's denominator: the gains stay.
void ResponseBank::learnNoise(Block& block, const Innovation& innovation, const NoiseLearning& learning,
                              bool is_coupled) {  // (S-11)
  if (!learning.isLearning()) return;
  Lanes growth[2][4];
  for (int c = 0; c < 2; ++c) {
    Channel& channel = block.channel[c];
    const Lanes& taken = innovation.taken[c];
    const Lanes seen =
        taken * innovation.nu[c].square() / innovation.D[c] + (1.0 - taken);  // an outlier tells nothing
    const Lanes learnt = learning.learnt(channel.noise, seen);
    const Lanes root = (learnt / channel.noise).sqrt();
    channel.noise = learnt;
    for (int i = 0; i < 3; ++i) growth[c][i] = root;
    growth[c][3].setOnes();  // kappa is no angle
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j) channel.covariance(i, j) *= growth[c][i] * growth[c][j];
  }
  if (!is_coupled) return;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) block.cross[i][j] *= growth[0][i] * growth[1][j];
}

}  // namespace sightline::core
