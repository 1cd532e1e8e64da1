// Accuracy on the paper's benchmark (azimuth = sin t, elevation = cos t, expected 33 Hz), one line for each
// form of each estimator, beside the reference figures of an independent numpy implementation (100 runs,
// other seeds).
//
// Figures over t in (1, 10] s and both channels, in units of sigma; +- is the 95 % band over runs. `z` is the
// difference to the reference in standard errors of both together: the reference has 100 runs, ours N.

#include <cstdio>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/LU>

#include "sightline/core/estimators/estimators.h"

#include "paper_benchmark.h"
#include "tables.h"

namespace sightline::bench {
namespace {

using namespace core;

constexpr double kReferenceRuns = 100.0;

/// The sighting itself as estimate, held as prediction.
class Raw final : public Method {
 public:
  void begin() override { last_.reset(); }
  void answer(const Measurement& sighting, Answer (&answers)[2]) override {
    for (int channel = 0; channel < 2; ++channel) {
      if (last_) answers[channel].prediction = last_->position(channel);
      answers[channel].estimate = sighting.position(channel);
      answers[channel].estimate_variance = sighting.covariance(channel, channel);
    }
    last_ = sighting;
  }

 private:
  std::optional<Measurement> last_;
};

/// TWBLS as the paper prints it: (6) weights the rows of F but not Y, (5) predicts from the last raw
/// sighting.
class LiteralTwbls final : public Method {
 public:
  explicit LiteralTwbls(TimeWeight weight) : weight_(weight) {}
  void begin() override { window_.clear(), determined_ = false; }
  void answer(const Measurement& sighting, Answer (&answers)[2]) override {
    if (determined_) {
      const double h = seconds(sighting.time - window_.back().time);
      for (int channel = 0; channel < 2; ++channel)
        answers[channel].prediction = window_.back().position(channel) + h * rate_(channel);
    }
    window_.push_back(sighting);
    while (window_.size() > 20 || seconds(sighting.time - window_.front().time) >= 0.6) window_.pop_front();
    determined_ = window_.size() >= 2;
    if (!determined_) return;
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero(), right = Eigen::Matrix2d::Zero();
    for (const Measurement& past : window_) {
      const double s = seconds(sighting.time - past.time);
      const double w = weight_ == TimeWeight::linear        ? std::max(0.0, 1.0 - s / 0.63)
                       : weight_ == TimeWeight::exponential ? std::exp(-s)
                                                            : 1.0;
      const Eigen::Vector2d row(w * s, w);
      normal += row * row.transpose();
      right += row * past.position.transpose();
    }
    const Eigen::Matrix2d C = normal.fullPivLu().solve(right);  // column = channel
    for (int channel = 0; channel < 2; ++channel) {
      rate_(channel) = -C(0, channel);
      answers[channel].rate = rate_(channel);
      answers[channel].estimate = C(1, channel);
    }
  }

 private:
  TimeWeight weight_;
  std::deque<Measurement> window_;
  bool determined_ = false;
  Eigen::Vector2d rate_ = Eigen::Vector2d::Zero();
};

/// TWBLS of the core with the fit's estimate and (8)-(9C), predicted from the raw sighting (5).
class RawAnchoredTwbls final : public Method {
 public:
  explicit RawAnchoredTwbls(TwblsParams params) : params_(params) { params_.anchor = TwblsAnchor::raw; }
  void begin() override { estimator_ = std::make_unique<TwblsEstimator>(params_); }
  void answer(const Measurement& sighting, Answer (&answers)[2]) override {
    const auto expected = estimator_->stateAt(sighting.time);
    estimator_->update(sighting);
    for (int channel = 0; channel < 2; ++channel) {
      if (expected) answers[channel].prediction = expected->mean(channel);
      if (const auto& fit = estimator_->fit(channel)) {
        answers[channel].estimate = fit->C(1);
        answers[channel].estimate_variance = fit->E(1) * fit->E(1);
        answers[channel].rate = -fit->C(0);
      }
    }
  }

 private:
  TwblsParams params_;
  std::unique_ptr<TwblsEstimator> estimator_;
};

struct Row {
  std::string name;
  std::unique_ptr<Method> method;
  double estimate_reference[2], prediction_reference[2];  // for sigma 8 % and 15 %, in sigma; NaN = none
};

std::unique_ptr<Method> core(EstimatorParams params) {
  return std::make_unique<EstimatorMethod>([params] { return makeEstimator(params); });
}

TwblsParams paperWindow(TimeWeight weight) {
  TwblsParams params;
  params.max_sightings = 20;
  params.min_sightings = 2;
  params.time_weight = weight;
  params.covariance = TwblsCovariance::sandwich;
  params.initial_rate_sigma = 1e6;  // as the reference: no prior
  return params;
}

EstimatorParams twbls(const TwblsParams& params) {
  EstimatorParams estimator;
  estimator.kind = EstimatorKind::twbls;
  estimator.twbls_form = EstimatorForm::paper;
  estimator.twbls = params;
  return estimator;
}

std::vector<Row> rows() {
  const double none = std::nan("");
  TwblsParams short_memory = paperWindow(TimeWeight::exponential), by_count = paperWindow(TimeWeight::none);
  short_memory.decay = 0.2;
  short_memory.max_sightings = 60;
  short_memory.window = 1e9;
  by_count.window = 1e9;
  std::vector<Row> table;
  const auto add = [&](const char* name, std::unique_ptr<Method> method, double e8, double p8, double e15,
                       double p15) {
    table.push_back({name, std::move(method), {e8, e15}, {p8, p15}});
  };
  add("raw sighting (prediction = hold)", std::make_unique<Raw>(), 1.003, 1.044, 0.998, 1.009);
  add("TWBLS literal (6), none, raw anchor", std::make_unique<LiteralTwbls>(TimeWeight::none), 0.492, 1.023,
      0.456, 1.015);
  add("TWBLS literal (6), lin, raw anchor", std::make_unique<LiteralTwbls>(TimeWeight::linear), 2.181, 1.684,
      1.264, 1.258);
  add("TWBLS literal (6), exp, raw anchor", std::make_unique<LiteralTwbls>(TimeWeight::exponential), 0.640,
      1.070, 0.542, 1.034);
  add("TWBLS none, raw anchor, (8)-(9)", std::make_unique<RawAnchoredTwbls>(paperWindow(TimeWeight::none)),
      0.492, 1.023, 0.456, 1.015);
  add("TWBLS none, fit anchor", core(twbls(paperWindow(TimeWeight::none))), 0.492, 0.563, 0.456, 0.503);
  add("TWBLS lin, raw anchor, (8)-(9)", std::make_unique<RawAnchoredTwbls>(paperWindow(TimeWeight::linear)),
      0.488, 1.032, 0.471, 1.025);
  add("TWBLS lin, fit anchor", core(twbls(paperWindow(TimeWeight::linear))), 0.488, 0.552, 0.471, 0.519);
  add("TWBLS exp, raw anchor, (8)-(9)",
      std::make_unique<RawAnchoredTwbls>(paperWindow(TimeWeight::exponential)), 0.484, 1.026, 0.456, 1.018);
  add("TWBLS exp, fit anchor", core(twbls(paperWindow(TimeWeight::exponential))), 0.484, 0.552, 0.456, 0.502);
  add("TWBLS exp tau 0.2 s, N = 60", core(twbls(short_memory)), 0.514, 0.599, 0.449, 0.495);
  add("TWBLS none, N = 20 by count only", core(twbls(by_count)), 0.496, 0.569, 0.452, 0.499);

  EstimatorParams estimator, by_default;
  estimator.kind = by_default.kind = EstimatorKind::twbls;
  estimator.twbls_consistent.initial_rate_sigma = 1e6;
  estimator.twbls_consistent.process_noises = {{1e-4, 0.0}, {0.05, 0.0}, {0.5, 0.0}, {3.0, 0.0}};
  add("TWBLS consistent, bank of (S-6)", core(estimator), 0.487, 0.554, 0.432, 0.478);
  add("TWBLS consistent, default", core(by_default), none, none, none, none);

  estimator.kind = EstimatorKind::noga;
  estimator.noga_form = EstimatorForm::paper;
  estimator.noga.covariance = NogaCovariance::printed;
  add("NOGA paper, 18 rows", core(estimator), 0.777, 0.917, 0.731, 0.851);
  estimator.noga.rows = 3;
  add("NOGA paper, 3 rows (heavy tails)", core(estimator), 1.258, 3.543, 1.212, 4.340);
  estimator.noga_form = EstimatorForm::consistent;
  estimator.noga_consistent = bankOfSection43();
  add("NOGA consistent, bank of 4.3", core(estimator), 0.353, 0.384, 0.345, 0.371);
  estimator.noga_consistent = {};
  add("NOGA consistent, default", core(estimator), none, none, none, none);

  estimator.kind = EstimatorKind::kalman;
  estimator.kalman.process_noise = 0.3;
  estimator.kalman.initial_rate_sigma = 2.0;
  add("Kalman filter, q = 0.3", core(estimator), 0.476, 0.542, 0.424, 0.468);
  estimator.kalman = {};
  add("Kalman filter, default", core(estimator), none, none, none, none);

  estimator.kind = EstimatorKind::imm;
  estimator.imm.initial_rate_sigma = 2.0;
  estimator.imm.dwell = 10.0;
  estimator.imm.models = {{1, {0.01, 0.0}}, {1, {0.8, 0.0}}};
  add("IMM CV(.01)+CV(.8) tau 10 s", core(estimator), 0.501, 0.572, 0.438, 0.485);
  estimator.imm = {};
  add("IMM, default", core(estimator), none, none, none, none);
  return table;
}

/// value +- band, reference, difference in standard errors.
void printFigure(const Figure& figure, double unit, double reference, int runs) {
  if (!figure.isKnown()) {
    std::printf(" | %27s", "-");
    return;
  }
  const double value = figure.root() / unit, error = figure.rootStandardError() / unit;
  std::printf(" | %6.3f +-%5.3f", value, 1.96 * error);
  if (std::isnan(reference)) {
    std::printf(" %12s", "");
    return;
  }
  const double rounding = 0.0005 / std::sqrt(3.0);
  const double both = std::sqrt(error * error * (1.0 + runs / kReferenceRuns) + rounding * rounding);
  std::printf(" %6.3f %+5.1f", reference, (value - reference) / both);
}

void printTable(double sigma, int runs, std::vector<Row>& table) {
  const int column = sigma < 0.1 ? 0 : 1;
  std::printf(
      "\n## The paper's benchmark, sigma %.0f %%, %d runs\n%-40s | %-27s | %-27s | %-8s | %-6s | %-6s\n",
      100.0 * sigma, runs, "", "estimate / sigma   ref     z", "prediction / sigma  ref    z", "rate",
      "ANEES", "pred.");
  for (Row& row : table) {
    const Score result = score(*row.method, runs, sigma, 1000);
    std::printf("%-40s", row.name.c_str());
    printFigure(result.estimate, sigma, row.estimate_reference[column], runs);
    printFigure(result.prediction, sigma, row.prediction_reference[column], runs);
    std::printf(" | %8.3f", result.rate.isKnown() ? result.rate.root() : std::nan(""));
    for (const Figure* nees : {&result.estimate_nees, &result.prediction_nees}) {
      std::printf(" | %6.4g", nees->isKnown() ? nees->mean() : std::nan(""));
    }
    std::printf("\n");
  }
}

}  // namespace

void printPaper(const Options& options) {
  std::vector<Row> table = rows();
  for (const double sigma : {0.08, 0.15}) printTable(sigma, 2 * options.runs, table);
}

}  // namespace sightline::bench
