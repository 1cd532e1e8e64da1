#include "sightline/core/estimators/noga_bank.h"

#include <algorithm>

namespace sightline::core {
namespace {

/// Whether one's process noise is that of the other times the ratio of their densities, and all else is
/// equal.
bool differInNoiseAlone(const ResponseModel& one, const ResponseModel& other) {
  return one.kind == ResponseModel::Kind::fading && other.kind == one.kind && other.fade == one.fade &&
         one.q > 0.0;
}

}  // namespace

/// A step of one channel: position, rate and acceleration are `F` times those before, and the derivative by
/// kappa is F's last column; kappa goes on, or is drawn anew.
struct ResponseBank::Transition {
  Lanes F[3][3];      // by rate, acceleration and kappa; a position moves the position alone, and by itself
  Lanes keeps_kappa;  // 1 or 0
  Lanes kappa;        // after
  Lanes kappa_variance;  // that is added
  Lanes Q[3][3];         // process noise of the other three, for an amplitude of 1 rad, upper triangle
};

ResponseBank::Block::Block() {
  for (Channel& one : channel) {
    for (Lanes& lanes : one.mean) lanes.setZero();
    for (Lanes& lanes : one.covariance.values) lanes.setZero();
    one.noise.setOnes();  // lanes without a model are divided by it
  }
  for (auto& row : cross)
    for (Lanes& lanes : row) lanes.setZero();
}

ResponseBelief ResponseBank::belief(int model) const {
  const Block& block = blocks_[static_cast<std::size_t>(model / kLanes)];
  const int lane = model % kLanes;
  ResponseBelief belief;
  for (int c = 0; c < 2; ++c) {
    const Channel& channel = block.channel[c];
    for (int i = 0; i < 4; ++i) {
      belief.mean[c](i) = channel.mean[i](lane);
      for (int j = 0; j < 4; ++j) belief.covariance[c](i, j) = channel.covariance(i, j)(lane);
    }
    belief.noise(c) = channel.noise(lane);
  }
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) belief.cross(i, j) = block.cross[i][j](lane);
  return belief;
}

void ResponseBank::setBelief(int model, const ResponseBelief& belief) {
  Block& block = blocks_[static_cast<std::size_t>(model / kLanes)];
  const int lane = model % kLanes;
  for (int c = 0; c < 2; ++c) {
    Channel& channel = block.channel[c];
    for (int i = 0; i < 4; ++i) {
      channel.mean[i](lane) = belief.mean[c](i);
      for (int j = i; j < 4; ++j) channel.covariance(i, j)(lane) = belief.covariance[c](i, j);
    }
    channel.noise(lane) = belief.noise(c);
  }
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) block.cross[i][j](lane) = belief.cross(i, j);
}

/// The block's part of an array of one number a model; zero beyond the last model.
ResponseBank::Lanes ResponseBank::lanesOf(const ModeArray& array, int block) {
  Lanes lanes = Lanes::Zero();
  const Eigen::Index first = Eigen::Index(block) * kLanes;
  const Eigen::Index count = std::min<Eigen::Index>(kLanes, array.size() - first);
  for (Eigen::Index i = 0; i < count; ++i) lanes(i) = array(first + i);
  return lanes;
}

/// The first N components.
template <int N>
ResponseBelief ResponseBank::mix(const ModeArray& weights, bool is_coupled) const {  // (S-6)
  Lanes mean[2][N], covariance[2][N][N], cross[N][N];
  for (int c = 0; c < 2; ++c) {
    for (int i = 0; i < N; ++i) {
      mean[c][i].setZero();
      for (int j = i; j < N; ++j) covariance[c][i][j].setZero();
    }
  }
  for (auto& row : cross)
    for (Lanes& lanes : row) lanes.setZero();

  Lanes shares[kMaxModes / kLanes];
  for (int b = 0; b < blocks(); ++b) {
    const Lanes w = shares[b] = lanesOf(weights, b);
    for (int c = 0; c < 2; ++c)
      for (int i = 0; i < N; ++i) mean[c][i] += w * blocks_[static_cast<std::size_t>(b)].channel[c].mean[i];
  }
  ResponseBelief all;
  all.noise = noise(weights);
  for (int c = 0; c < 2; ++c)
    for (int i = 0; i < N; ++i) all.mean[c](i) = mean[c][i].sum();
  for (int b = 0; b < blocks(); ++b) {
    const Block& block = blocks_[static_cast<std::size_t>(b)];
    const Lanes& w = shares[b];
    Lanes offset[2][N];
    for (int c = 0; c < 2; ++c) {
      for (int i = 0; i < N; ++i) offset[c][i] = block.channel[c].mean[i] - all.mean[c](i);
      for (int i = 0; i < N; ++i)
        for (int j = i; j < N; ++j)
          covariance[c][i][j] += w * (block.channel[c].covariance(i, j) + offset[c][i] * offset[c][j]);
    }
    if (!is_coupled) continue;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) cross[i][j] += w * (block.cross[i][j] + offset[0][i] * offset[1][j]);
  }
  for (int i = 0; i < N; ++i) {
    for (int c = 0; c < 2; ++c)
      for (int j = i; j < N; ++j)
        all.covariance[c](i, j) = all.covariance[c](j, i) = covariance[c][i][j].sum();
    if (!is_coupled) continue;
    for (int j = 0; j < N; ++j) all.cross(i, j) = cross[i][j].sum();
  }
  return all;
}

ResponseBelief ResponseBank::mixture(const ModeArray& weights, bool is_coupled) const {
  return mix<4>(weights, is_coupled);
}

AngularState ResponseBank::motion(const ModeArray& weights) const {
  return motionOf(mix<2>(weights, true)).angularState();
}

Eigen::Vector2d ResponseBank::noise(const ModeArray& weights) const {
  Lanes sum[2] = {Lanes::Zero(), Lanes::Zero()};
  for (int b = 0; b < blocks(); ++b)
    for (int c = 0; c < 2; ++c)
      sum[c] += lanesOf(weights, b) * blocks_[static_cast<std::size_t>(b)].channel[c].noise;
  return {sum[0].sum(), sum[1].sum()};
}

ModeArray ResponseBank::noiseOf(int channel) const {
  ModeArray noise(models_);
  for (int model = 0; model < models_; ++model)
    noise(model) = blocks_[static_cast<std::size_t>(model / kLanes)].channel[channel].noise(model % kLanes);
  return noise;
}

void ResponseBank::interact(const ModeArray& own, const ResponseBelief& all, bool is_coupled) {  // (S-6)
  for (int b = 0; b < blocks(); ++b) {
    Block& block = blocks_[static_cast<std::size_t>(b)];
    const Lanes share = lanesOf(own, b), rest = 1.0 - share, both = share * rest;
    Lanes offset[2][4];
    for (int c = 0; c < 2; ++c) {
      Channel& channel = block.channel[c];
      for (int i = 0; i < 4; ++i) {
        offset[c][i] = channel.mean[i] - all.mean[c](i);
        channel.mean[i] = all.mean[c](i) + share * offset[c][i];
      }
      for (int i = 0; i < 4; ++i)
        for (int j = i; j < 4; ++j)
          channel.covariance(i, j) = share * channel.covariance(i, j) + rest * all.covariance[c](i, j) +
                                     both * offset[c][i] * offset[c][j];
      channel.noise = share * channel.noise + rest * all.noise(c);
    }
    if (!is_coupled) continue;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        block.cross[i][j] =
            share * block.cross[i][j] + rest * all.cross(i, j) + both * offset[0][i] * offset[1][j];
  }
}

/// Goes over from seconds to units of time of `unit` seconds: rates per unit, and so on.
void ResponseBank::scaleTime(Block& block, double unit, bool is_coupled) {
  const double scale[4] = {1.0, unit, unit * unit, unit * unit};
  for (Channel& channel : block.channel) {
    for (int i = 0; i < 4; ++i) {
      channel.mean[i] *= scale[i];
      for (int j = i; j < 4; ++j) channel.covariance(i, j) *= scale[i] * scale[j];
    }
  }
  if (!is_coupled) return;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) block.cross[i][j] *= scale[i] * scale[j];
}

ResponseBank::Lanes ResponseBank::squaredAmplitude(const Block& block, int channel,
                                                   const BankAmplitude& amplitude) {
  if (!amplitude.follows_noise) return Lanes::Constant(amplitude.squared(channel));
  return amplitude.squared(channel) * block.channel[channel].noise;
}

void ResponseBank::step(const std::vector<ResponseModel>& models, double h, double unit,
                        const BankAmplitude& amplitude, bool is_coupled) {
  for (int b = 0; b < blocks(); ++b) {
    Block& block = blocks_[static_cast<std::size_t>(b)];
    if (unit != 1.0) scaleTime(block, unit, is_coupled);
    Transition transitions[2];
    findTransitions(b, models, h, transitions);
    for (int c = 0; c < 2; ++c)
      advance(block.channel[c], transitions[c], squaredAmplitude(block, c, amplitude));
    if (is_coupled) advanceCross(block, transitions[0], transitions[1]);
    if (unit != 1.0) scaleTime(block, 1.0 / unit, is_coupled);
  }
}

void ResponseBank::addWhiteAcceleration(int model, double density, double h) {
  const Eigen::Matrix2d noise = whiteAccelerationNoise(h, density);
  const int lane = model % kLanes;
  for (Channel& channel : blocks_[static_cast<std::size_t>(model / kLanes)].channel)
    for (int i = 0; i < 2; ++i)
      for (int j = i; j < 2; ++j) channel.covariance(i, j)(lane) += noise(i, j);
}

/// The steps of both channels of a block, by the models.
void ResponseBank::findTransitions(int block, const std::vector<ResponseModel>& models, double h,
                                   Transition* transitions) const {
  const ResponseModel* last = nullptr;
  core::Transition one;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int number = std::min(block * kLanes + lane, models_ - 1);  // beyond the last one: any will do
    const ResponseModel& model = models[static_cast<std::size_t>(number)];
    for (int c = 0; c < 2; ++c) {
      const Lanes* mean = blocks_[static_cast<std::size_t>(block)].channel[c].mean;
      if (c == 0 || model.kind == ResponseModel::Kind::harmonic) {
        const bool is_scaled = last != nullptr && differInNoiseAlone(*last, model);
        if (is_scaled)
          one.Q.topLeftCorner<3, 3>() *= model.q / last->q;
        else
          one = transitionOf(model, {mean[0](lane), mean[1](lane), mean[2](lane), mean[3](lane)}, h);
        last = &model;
      }
      Transition& lanes = transitions[c];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) lanes.F[i][j](lane) = one.F(i, j + 1);
        for (int j = i; j < 3; ++j) lanes.Q[i][j](lane) = one.Q(i, j);
      }
      lanes.keeps_kappa(lane) = one.F(3, 3);
      lanes.kappa(lane) = one.mean(3);
      lanes.kappa_variance(lane) = one.Q(3, 3);
    }
  }
}

void ResponseBank::advance(Channel& channel, const Transition& t, const Lanes& amplitude_squared) {
  const Lanes rate = channel.mean[1], acceleration = channel.mean[2];
  channel.mean[0] += t.F[0][0] * rate + t.F[0][1] * acceleration;
  channel.mean[1] = t.F[1][0] * rate + t.F[1][1] * acceleration;
  channel.mean[2] = t.F[2][0] * rate + t.F[2][1] * acceleration;
  channel.mean[3] = t.kappa;

  SymmetricLanes& P = channel.covariance;
  Lanes FP[3][4];
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 3; ++i) {
      FP[i][j] = t.F[i][0] * P(1, j) + t.F[i][1] * P(2, j) + t.F[i][2] * P(3, j);
    }
    FP[0][j] += P(0, j);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      P(i, j) =
          FP[i][1] * t.F[j][0] + FP[i][2] * t.F[j][1] + FP[i][3] * t.F[j][2] + amplitude_squared * t.Q[i][j];
    }
    P(i, 3) = FP[i][3] * t.keeps_kappa;
  }
  P(0, 0) += FP[0][0];
  P(3, 3) = P(3, 3) * t.keeps_kappa + t.kappa_variance;
}

void ResponseBank::advanceCross(Block& block, const Transition& azimuth, const Transition& elevation) {
  Lanes FC[4][4];
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 3; ++i) {
      FC[i][j] = azimuth.F[i][0] * block.cross[1][j] + azimuth.F[i][1] * block.cross[2][j] +
                 azimuth.F[i][2] * block.cross[3][j];
    }
    FC[0][j] += block.cross[0][j];
    FC[3][j] = azimuth.keeps_kappa * block.cross[3][j];
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 3; ++j) {
      block.cross[i][j] =
          FC[i][1] * elevation.F[j][0] + FC[i][2] * elevation.F[j][1] + FC[i][3] * elevation.F[j][2];
    }
    block.cross[i][0] += FC[i][0];
    block.cross[i][3] = FC[i][3] * elevation.keeps_kappa;
  }
}

}  // namespace sightline::core
