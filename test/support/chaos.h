#pragma once

#include <algorithm>
#include <bond/Status.h>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <signal.h>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/SightingArray.h>

#include "support/fusion_watch.h"
#include "support/node_process.h"
#include "support/scans.h"
#include "support/waiting.h"

/// Two sensors that see one target, and what the fusions of chaos_trackers.launch say of it. Parameters of
/// the test: /chaos/nodes and /chaos/nodelets (which of them there are), /chaos/long (the long list of
/// events, for bench/chaos).
class Chaos : public testing::Test {
 public:
  /// Where the target is: (azimuth, elevation) [rad].
  static Eigen::Vector2d truthAt(ros::Time stamp) {
    const double time = std::fmod(stamp.toSec(), 1e5);
    return {0.3 + 0.2 * std::sin(0.7 * time), 0.15 * std::cos(0.5 * time)};
  }

 protected:
  static constexpr double kSigma = 1e-3;  // of the sightings [rad]
  static constexpr double kInterval = 1.0 / 30.0;
  static constexpr double kMostSigmas =
      6.0;  // of a settled track from the target [1]; 1.5e-8 of honest ones are further

  enum class Id { kept, any };
  enum class Loss { none, any };

  void SetUp() override {
    for (const std::string form : {"nodes", "nodelets"})
      if (nh_.param("/chaos/" + form, true)) forms_.push_back(form);
    is_long_ = nh_.param("/chaos/long", false);
    for (const std::string& form : forms_) {
      watches_.push_back(
          std::make_unique<FusionWatch>(nh_, form, [](ros::Time stamp) { return truthAt(stamp); }));
    }
    ASSERT_TRUE(until([this] {
      return west_.getNumSubscribers() == forms_.size() && east_.getNumSubscribers() == forms_.size();
    })) << "a tracker is missing";
    if (is_long_) expectBonds();  // loaders that were held up may be loading their nodelets again
    settleFromNow();
    ASSERT_TRUE(until([this] { return areSettled(); })) << "the target is not found at all; " << describe();
  }

  /// Waits until the manager and the loaders of its nodelets hear of each other (bond): a loader whose
  /// manager ends before that, while it loads, may wait for an answer for good (doc/sensors.md).
  void expectBonds() {
    if (forms_.back() != "nodelets") return;
    std::map<std::string, std::set<std::string>> ends;  // of each bond
    const ros::Subscriber bonds = nh_.subscribe<bond::Status>(
        "/nodelets/manager/bond", 100,
        [&](const bond::Status::ConstPtr& status) { ends[status->id].insert(status->instance_id); });
    EXPECT_TRUE(until([&] {
      return std::count_if(ends.begin(), ends.end(), [](const auto& it) { return it.second.size() == 2; }) >=
             3;
    })) << "the loaders have no bonds with the manager";
  }

  /// Plays the sensors until the condition holds.
  bool until(const std::function<bool()>& condition, double patience = kPatience) {
    return eventually(
        condition, [this] { play(); }, ros::WallDuration(0.002), patience);
  }

  void playFor(double duration) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(duration);
    until([&] { return ros::WallTime::now() >= end; }, duration + 1.0);
  }

  bool areSettled() const {
    return std::all_of(watches_.begin(), watches_.end(),
                       [](const auto& watch) { return watch->isSettled(); });
  }

  bool allHoldSince(ros::Time stamp) const {
    return std::all_of(watches_.begin(), watches_.end(),
                       [&](const auto& watch) { return watch->holdsSince(stamp); });
  }

  void settleFromNow() {
    const ros::Time now = this->now();
    for (const auto& watch : watches_) watch->settleFrom(now);
  }

  std::string describe() const {
    std::string all;
    for (const auto& watch : watches_) all += (all.empty() ? "" : "; ") + watch->describe();
    return all;
  }

  /// Nodes of a form by full names: those of nodelets are the manager's and their loaders'.
  static std::vector<std::string> nodesOf(const std::string& form) {
    std::vector<std::string> nodes = {"west/local_tracker", "east/local_tracker", "track_fusion"};
    if (form == "nodelets") nodes.push_back("manager");
    for (std::string& node : nodes) node = "/" + form + "/" + node;
    return nodes;
  }

  /// All nodes' processes; of a node that is not there, 0.
  std::map<std::string, pid_t> processes() const {
    std::map<std::string, pid_t> all;
    for (const std::string& form : forms_)
      for (const std::string& node : nodesOf(form)) all[node] = processOf(node).value_or(0);
    return all;
  }

  /// An event begins: notes under which ids the target is held, and which processes there are.
  void begin() {
    ids_.clear();
    for (const auto& watch : watches_) {
      watch->begin();
      ids_.push_back(watch->id());
    }
    processes_ = processes();
    for (const auto& [node, process] : processes_) EXPECT_GT(process, 0) << node << " does not run";
  }

  /// The event is over since `end`, and it is proven to have happened: waits until all fusions hold the
  /// target by both trackers, from messages stamped from now on, and prints a line each of how long that
  /// took. `events`: what happened to each form.
  void expectBack(const std::vector<std::string>& events, const std::vector<ros::WallTime>& ends, Id id,
                  Loss loss = Loss::any) {
    settleFromNow();
    EXPECT_TRUE(until([this] { return areSettled(); })) << events.front() << ": " << describe();
    for (std::size_t i = 0; i < watches_.size(); ++i) {
      const FusionWatch::Outcome outcome = watches_[i]->outcome(ends[i]);
      const std::uint32_t id_now = watches_[i]->seen().back().id;
      const bool is_kept = id_now == ids_[i];
      const bool is_alone = outcome.ids == std::set<std::uint32_t>{ids_[i]};
      std::printf(
          "chaos: %-44s %-9s back %6.2f s, both %6.2f s, id %-9s distance %4.1f sigma, lost %3d of %4d\n",
          events[i].c_str(), watches_[i]->form().c_str(), outcome.back, outcome.both,
          !is_kept   ? "changed,"
          : is_alone ? "kept,"
                     : "returned,",
          outcome.sigmas, outcome.lost, static_cast<int>(watches_[i]->seen().size()));
      if (id == Id::kept) {
        EXPECT_TRUE(is_kept) << events[i] << ", " << watches_[i]->form() << ": " << outcome.ids.size()
                             << " ids, the last " << watches_[i]->seen().back().id << " instead of "
                             << ids_[i];
      }
      if (loss == Loss::none) {
        EXPECT_EQ(outcome.lost, 0) << events[i] << ", " << watches_[i]->form();
      }
      EXPECT_LT(outcome.sigmas, kMostSigmas) << events[i] << ", " << watches_[i]->form();
    }
    std::fflush(stdout);
  }

  void expectBack(const std::string& event, ros::WallTime end, Id id, Loss loss = Loss::any) {
    expectBack(std::vector<std::string>(watches_.size(), event),
               std::vector<ros::WallTime>(watches_.size(), end), id, loss);
  }

  /// No process of a node has ended since `begin`.
  void expectNobodyDied() const {
    for (const auto& [node, process] : processes())
      EXPECT_EQ(process, processes_.at(node)) << node << " has ended or was started again";
  }

  sightline::SightingArray scan(const std::string& sensor, ros::Time stamp) {
    const Eigen::Vector2d truth = truthAt(stamp);
    auto seen =
        scanOf(sensor, 0.0, {{truth.x() + kSigma * normal_(random_), truth.y() + kSigma * normal_(random_)}},
               kSigma);
    seen.header.stamp = stamp;
    return seen;
  }

  /// A scan of as many false sightings, away from the target.
  sightline::SightingArray clutter(const std::string& sensor, int count) {
    std::vector<std::pair<double, double>> angles;
    for (int i = 0; i < count; ++i) angles.emplace_back(2.0 + 0.3 * normal_(random_), 0.2 * normal_(random_));
    auto seen = scanOf(sensor, 0.0, angles, kSigma);
    seen.header.stamp = now();
    return seen;
  }

  /// Scans of both sensors, when they are due.
  virtual void play() {
    const ros::WallTime wall = ros::WallTime::now();
    if ((wall - played_).toSec() < kInterval) return;
    played_ = wall;
    west_.publish(scan("west", now()));
    sightline::SightingArray seen = scan("east", now());
    seen.header.stamp += ros::Duration(east_clock_);
    east_.publish(seen);
  }

  /// The sensors' clock.
  virtual ros::Time now() const { return ros::Time::now(); }

  ros::NodeHandle nh_;
  ros::Publisher west_ = nh_.advertise<sightline::SightingArray>("/sightings/west", 1000);
  ros::Publisher east_ = nh_.advertise<sightline::SightingArray>("/sightings/east", 1000);
  std::vector<std::string> forms_;
  bool is_long_ = false;
  std::vector<std::unique_ptr<FusionWatch>> watches_;
  std::vector<std::uint32_t> ids_;
  std::map<std::string, pid_t> processes_;
  ros::WallTime played_;
  double east_clock_ = 0.0;  // by which the stamps of its sightings are off [s]
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};
