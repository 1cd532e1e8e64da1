#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sightline/core/fusion/fusion_report.h"
#include "sightline/core/model/track.h"
#include "sightline/core/positions/position_track.h"

namespace sightline_fuzz {

/// Something that must hold and does not.
struct Fault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct TrialLimits {
  double longest_call = 4.0;            ///< processor time [s]
  std::size_t most_memory = 3u << 30u;  ///< on the heap [bytes]
};

/// The calls of one fuzz case, each of them watched: what is thrown, how long it takes, what it allocates.
class Trial {
 public:
  explicit Trial(const TrialLimits& limits = {}) : limits_(limits) {}

  /// Throws Fault when the call throws, takes too long, or leaves too much on the heap.
  void call(const std::string& what, const std::function<void()>& call);

  /// The same, of a call that may refuse its input by an exception of this type.
  template <typename Refusal>
  void callThatRefuses(const std::string& what, const std::function<void()>& refusing) {
    call(what, [&] {
      try {
        refusing();
      } catch (const Fault&) {
        throw;
      } catch (const Refusal&) {
        ++refusals_;
      }
    });
  }

  std::uint64_t calls() const { return calls_; }
  std::uint64_t refusals() const { return refusals_; }
  double longest() const { return longest_; }  ///< call so far [s]

 private:
  TrialLimits limits_;
  std::uint64_t calls_ = 0, refusals_ = 0;
  double longest_ = 0.0;
};

/// Throws Fault with these words unless `holds`.
void require(bool holds, const std::string& words);

/// Finite, symmetric, positive semidefinite: to rounding, in units of its own standard deviations.
void requireCovariance(const Eigen::MatrixXd& covariance, const std::string& whose);

/// What is published of an angular track: state, gate, existence, times.
void requireSound(const sightline::core::Track& track);

/// Tracks in ascending order of their ids, each sound.
void requireSound(const std::vector<sightline::core::Track>& tracks);
void requireSound(const sightline::core::FusionReport& report);
void requireSound(const sightline::core::PositionOutput& output);

/// All that is in them, to the last bit.
std::string bytesOf(const std::vector<sightline::core::Track>& tracks);
std::string bytesOf(const sightline::core::PositionOutput& output);

}  // namespace sightline_fuzz
