#pragma once

#include <cmath>
#include <limits>

namespace sightline::core {

/// Logarithm of a sum over many terms that are given by their logarithms: neither overflows nor vanishes.
class LogSum {
 public:
  void add(double log_term) {
    if (log_term <= largest_) {
      if (log_term > kImpossible) sum_ += std::exp(log_term - largest_);
    } else {
      sum_ = sum_ * std::exp(largest_ - log_term) + 1.0;
      largest_ = log_term;
    }
  }
  double value() const { return largest_ + std::log(sum_); }  ///< -infinity without terms

 private:
  static constexpr double kImpossible = -std::numeric_limits<double>::infinity();

  double largest_ = kImpossible;
  double sum_ = 0.0;
};

}  // namespace sightline::core
