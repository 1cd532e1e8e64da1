#include "sightline/core/fusion/contributors.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>

#include <Eigen/Cholesky>

namespace sightline::core {
namespace {

/// How much surer, in the log of the determinant, a newcomer must be to displace one that contributed: half
/// the variance in each of the four components.
const double kLoyalty = 4.0 * std::log(2.0);

/// A local track's sensors, and its tracker's name, sorted.
std::vector<std::string> originsOf(const Supporter& supporter) {
  std::vector<std::string> origins = supporter.local.track.sources;
  origins.push_back(supporter.key.tracker);
  std::sort(origins.begin(), origins.end());
  return origins;
}

/// The first sensor that two supporters have in common; empty when there is none.
std::string sharedOrigin(const Supporter& a, const Supporter& b) {
  const std::vector<std::string> of_a = originsOf(a), of_b = originsOf(b);
  std::vector<std::string> shared;
  std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(shared));
  return shared.empty() ? "" : shared.front();
}

void leaveOutCoasting(const GlobalTrack& track, double coasting_age, Contributors& choice) {
  const auto silence = [&track](std::size_t number) {
    return seconds(track.time() - track.supporters()[number].local.track.last_sighting);
  };
  const auto too_old = [&](std::size_t number) {
    return track.supporters()[number].local.track.status == TrackStatus::coasting &&
           silence(number) > coasting_age;
  };
  if (std::all_of(choice.used.begin(), choice.used.end(), too_old)) return;
  std::vector<std::size_t> kept;
  for (const std::size_t number : choice.used) {
    if (!too_old(number)) {
      kept.push_back(number);
      continue;
    }
    std::ostringstream why;
    why << "last sighting " << silence(number) << " s ago (coasting_age " << coasting_age << " s)";
    choice.left_out.emplace_back(number, Refusal{"coasting", why.str()});
  }
  choice.used = kept;
}

void leaveOutSharedSensors(const GlobalTrack& track, Contributors& choice) {
  const auto& supporters = track.supporters();
  std::vector<std::pair<double, std::size_t>> surest_first;
  for (const std::size_t number : choice.used) {
    const double preference = supporters[number].contributed ? kLoyalty : 0.0;
    surest_first.emplace_back(uncertainty(supporters[number].state) - preference, number);
  }
  std::stable_sort(surest_first.begin(), surest_first.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::size_t> kept;
  for (const auto& [_, number] : surest_first) {
    std::optional<Refusal> why;
    for (const std::size_t surer : kept) {
      const std::string shared = sharedOrigin(supporters[number], supporters[surer]);
      if (!shared.empty()) {
        why = Refusal{"shared sensor", shared + " is in the track of " + supporters[surer].key.tracker +
                                           " too, and its sightings would count twice"};
      }
    }
    if (why) {
      choice.left_out.emplace_back(number, *why);
    } else {
      kept.push_back(number);
    }
  }
  choice.used = kept;
}

}  // namespace

double uncertainty(const AngularState& state) {
  const Eigen::LLT<Eigen::Matrix4d> factor(state.covariance);
  const double log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  const bool is_determined = factor.info() == Eigen::Success && std::isfinite(log_determinant);
  return is_determined ? log_determinant : std::numeric_limits<double>::infinity();
}

bool nameTheirSensors(const GlobalTrack& track, const std::vector<std::size_t>& numbers) {
  return std::none_of(numbers.begin(), numbers.end(), [&track](std::size_t number) {
    return track.supporters()[number].local.track.sources.empty();
  });
}

Contributors chooseContributors(const GlobalTrack& track, double coasting_age, bool allow_shared_sensors) {
  const auto by_key = [&track](std::size_t a, std::size_t b) {
    return track.supporters()[a].key < track.supporters()[b].key;
  };
  Contributors choice{track.usable(), {}};
  std::sort(choice.used.begin(), choice.used.end(), by_key);
  leaveOutCoasting(track, coasting_age, choice);
  if (!allow_shared_sensors) leaveOutSharedSensors(track, choice);
  for (std::size_t i = 0; i < track.supporters().size(); ++i) {
    if (const auto& why = track.supporters()[i].unusable) choice.left_out.emplace_back(i, *why);
  }
  std::sort(choice.used.begin(), choice.used.end(), by_key);
  std::sort(choice.left_out.begin(), choice.left_out.end(),
            [&by_key](const auto& a, const auto& b) { return by_key(a.first, b.first); });
  return choice;
}

}  // namespace sightline::core
