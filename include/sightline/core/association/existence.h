#pragma once

#include <tuple>

namespace sightline::core {

/// How targets come and go in view, as rates of chance. Times in units of the track's time, see
/// LifecycleParams.
struct PresenceParams {
  double mean_life = 300.0;    ///< until a target in view leaves for good [units], > 0
  double mean_shown = 600.0;   ///< until it is hidden, by a cloud or by fading [units], > 0
  double mean_hidden = 1.0;    ///< until a hidden one is seen again, if it is there still [units], > 0
  double mean_patience = 2.0;  ///< until a hidden one leaves for good [units], > 0

  friend bool operator==(const PresenceParams& a, const PresenceParams& b) {
    return std::tie(a.mean_life, a.mean_shown, a.mean_hidden, a.mean_patience) ==
           std::tie(b.mean_life, b.mean_shown, b.mean_hidden, b.mean_patience);
  }
};

/// The probability that a track follows a target, by all that was seen and not seen of it: integrated
/// existence, in the form with targets that exist and cannot be seen for a while (D. Musicki, R. Evans, S.
/// Stankovic, IEEE Trans. Automatic Control 39(6), 1994: Markov chain two). So a target that is missed a few
/// times in a row is soon as likely gone as hidden, and is known again at its next sighting.
///
/// Where its odds at the start are those of a new target against clutter, it is the sequential probability
/// ratio test of a track at the same time: of tracks made of clutter alone no more than the share (odds at
/// the start) / (odds asked for) is ever believed.
class Existence {
 public:
  /// `odds`: of a target against clutter at the start, > 0 and finite.
  explicit Existence(double odds);

  /// Time goes by [units of time].
  void pass(double duration, const PresenceParams& presence);

  /// A scan in which a target that can be seen would have given what was seen `ratio` times as often as
  /// clutter does: 1 - P_D where nothing was seen, 1 - P_D + P_D N(innovation; 0, S) / clutter density for a
  /// sighting. One scan counts for a factor of 10^4 at most.
  void weigh(double ratio);

  double probability() const { return seen_ + hidden_; }  ///< that there is a target, in (0, 1]

  /// Its odds over those at the start [1].
  double gain() const;

 private:
  double odds_at_start_;
  double seen_, hidden_ = 0.0, none_;  // probabilities; the sum is 1
};

}  // namespace sightline::core
