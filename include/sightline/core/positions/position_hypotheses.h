#pragma once

#include <limits>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/field_of_view.h"
#include "sightline/core/model/time.h"
#include "sightline/core/positions/disjoint_candidates.h"
#include "sightline/core/positions/local_view.h"
#include "sightline/core/positions/rays.h"

namespace sightline::core {

/// A station that looks, whether it sees anything or not.
struct LookingStation {
  int station = 0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [m]
  std::vector<FieldOfView> views;  ///< its `tracking` frame is the common one; empty = not known

  /// Probability that it looks at a point [m]: 1/2 where its views are not known.
  double looksAt(const Eigen::Vector3d& point) const;
};

/// Log of the probability that none of the stations has a track of a target at `point` [m], but those that
/// are `seeing` it (by number) and do not count (P-10).
double logMissed(const Eigen::Vector3d& point, const std::vector<LookingStation>& stations,
                 const std::set<int>& seeing, double detection_probability);

struct HypothesisParams {
  double gate = 5.0;                ///< of the plane test and of further rays [standard deviations], > 0
  double max_relative_sigma = 0.3;  ///< of a crossing, as of a position [1], in (0, 1)
  double detection_probability =
      0.9;                        ///< that a station that looks at a target has a track of it [1], in (0, 1)
  double memory = 2.0;            ///< of the scores [s], > 0
  double correlation_time = 0.5;  ///< over which successive scores say the same [s], > 0
  double least_score = 3.0;       ///< log likelihood ratio from which a crossing is a target, >= 0
  double least_margin = 3.0;      ///< ... by which all else must be less likely, >= 0
  double least_fit_margin = 8.0;  ///< log likelihood of the residuals alone by which the rays must fit it
                                  ///< better than other crossings that explain as many tracks, >= 0
  int most_candidates = 20000;    ///< that are scored in one decision; beyond, none are made, >= 1
};

/// Why a crossing is not taken for a target.
enum class CrossingRefusal {
  unlikely,   ///< its tracks are as well or better explained without partners
  ghost,      ///< its tracks are better explained by other crossings
  ambiguous,  ///< others explain its tracks as well: it may be a ghost, and time must tell
};

struct RefusedCrossing {
  Candidate candidate;
  CrossingRefusal reason = CrossingRefusal::unlikely;
};

struct HypothesisDecision {
  std::vector<Candidate> targets;        ///< disjoint, by members
  std::vector<RefusedCrossing> refused;  ///< by members
  bool is_complete = true;               ///< false: more candidates than can be scored
};

/// Which local tracks are one target, and which crossings are ghosts (section 3 of positions: P-10, P-11).
/// Pairs of stations by the plane test (P-3), sorted by the angle about their baseline; each pair extended by
/// the rays of further stations that fit; the best set of disjoint candidates. A value; the outcome does not
/// depend on the order of the views.
class PositionHypotheses {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit PositionHypotheses(const HypothesisParams& params = {});

  /// `views`: local tracks that belong to no position yet; times do not go back.
  HypothesisDecision decide(Time now, std::vector<LocalView> views,
                            const std::vector<LookingStation>& stations);

 private:
  struct Memory {
    double score = 0.0;   // mean
    double misfit = 0.0;  // mean of the chi-square less its degrees of freedom
    int degrees = 0;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // [m], when it fitted last
    Time first{}, last{};                             // `last`: decision in which it was looked at
    Time fitted{};                                    // when it fitted last
  };

  std::vector<Candidate> candidatesOf(const std::vector<LocalView>& views,
                                      const std::vector<LookingStation>& stations, bool& is_complete) const;
  std::optional<Candidate> score(const std::vector<const LocalView*>& members,
                                 const std::vector<LookingStation>& stations, double most_tracks) const;
  void remember(Time now, const std::vector<LocalView>& views, std::vector<Candidate>& candidates);
  void judge(const std::vector<Candidate>& candidates, const std::vector<int>& group,
             HypothesisDecision& decision) const;

  HypothesisParams params_;
  std::map<std::vector<ViewKey>, Memory> memory_;
};

}  // namespace sightline::core
