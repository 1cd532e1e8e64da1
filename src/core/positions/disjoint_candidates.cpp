#include "sightline/core/positions/disjoint_candidates.h"

#include <algorithm>
#include <map>

#include "sightline/core/association/clusters.h"

namespace sightline::core {
namespace {

constexpr int kMostSteps = 20000;  // of the exact search in one group

/// Exact search with a bound, in one cluster; best first, so that what is found early is good.
struct Search {
  const std::vector<Candidate>& candidates;
  const std::vector<double>& values;
  const std::vector<int>& order;  // by falling value
  std::vector<double> rest;       // sum of the values from here on
  std::vector<int> chosen, best;
  double best_sum = -1.0;
  int steps = 0;

  void run(std::size_t at, double sum) {
    if (sum > best_sum) {
      best_sum = sum;
      best = chosen;
    }
    if (at == order.size() || sum + rest[at] <= best_sum || ++steps > kMostSteps) return;
    const Candidate& next = candidates[static_cast<std::size_t>(order[at])];
    const bool fits = std::all_of(chosen.begin(), chosen.end(), [&](int other) {
      return areDisjoint(next, candidates[static_cast<std::size_t>(other)]);
    });
    if (fits) {
      chosen.push_back(order[at]);
      run(at + 1, sum + values[static_cast<std::size_t>(order[at])]);
      chosen.pop_back();
    }
    run(at + 1, sum);
  }
};

}  // namespace

bool areDisjoint(const Candidate& a, const Candidate& b) {
  auto i = a.members.begin();
  auto j = b.members.begin();
  while (i != a.members.end() && j != b.members.end()) {
    if (*i == *j) return false;
    if (*i < *j)
      ++i;
    else
      ++j;
  }
  return true;
}

bool isWithin(const Candidate& a, const Candidate& b) {
  return std::includes(b.members.begin(), b.members.end(), a.members.begin(), a.members.end());
}

std::vector<std::vector<int>> groupsOf(const std::vector<Candidate>& candidates) {
  std::map<ViewKey, int> numbers;
  std::vector<GatedPair> pairs;
  std::vector<int> owner;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (const ViewKey& key : candidates[i].members) {
      const int number = numbers.emplace(key, static_cast<int>(numbers.size())).first->second;
      pairs.push_back({static_cast<int>(i), number, 0.0});
      owner.push_back(static_cast<int>(i));
    }
  }
  std::vector<std::vector<int>> groups;
  for (const std::vector<int>& cluster : clusters(pairs)) {
    std::vector<int> group;
    for (const int pair : cluster) group.push_back(owner[static_cast<std::size_t>(pair)]);
    groups.push_back(occurring(group));
  }
  return groups;
}

std::vector<int> bestOfGroup(const std::vector<Candidate>& candidates, const std::vector<double>& values,
                             const std::vector<int>& group) {
  std::vector<int> order;
  for (const int i : group)
    if (values[static_cast<std::size_t>(i)] > 0.0) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const double x = values[static_cast<std::size_t>(a)], y = values[static_cast<std::size_t>(b)];
    return x != y ? x > y
                  : candidates[static_cast<std::size_t>(a)].members <
                        candidates[static_cast<std::size_t>(b)].members;
  });
  Search search{candidates, values, order, std::vector<double>(order.size() + 1, 0.0), {}, {}, -1.0, 0};
  for (std::size_t i = order.size(); i-- > 0;)
    search.rest[i] = search.rest[i + 1] + values[static_cast<std::size_t>(order[i])];
  search.run(0, 0.0);
  return search.best;
}

}  // namespace sightline::core
