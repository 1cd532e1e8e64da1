#include "sightline/core/ordering/stamp_watch.h"

#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/times.h"

namespace {

using sightline::core::durationOf;
using sightline::core::StampGate;
using sightline::core::StampJudgement;
using sightline::core::StampWatch;
using sightline::core::StampWatchParams;
using sightline::core::Time;
using sightline::test::at;

constexpr double kLag = 0.5;  // [s], the default

/// Lets a watch judge scans and keeps what it said.
class Witness {
 public:
  explicit Witness(const StampWatchParams& params = {}) : watch_(params) {}

  StampJudgement take(const std::string& sensor, double stamp) {
    return keep(watch_.take(next_++, sensor, at(stamp)), sensor);
  }
  StampJudgement takeByClock(const std::string& sensor, double stamp, double clock) {
    return keep(watch_.take(next_++, sensor, at(stamp), at(clock)), sensor);
  }

  bool isUsed(const StampJudgement& judgement) const {
    return std::any_of(judgement.verdicts.begin(), judgement.verdicts.end(),
                       [&](const auto& verdict) { return verdict.scan == next_ - 1 && !verdict.refusal; });
  }

  /// Whether a notice has these words.
  bool said(const std::string& words) const {
    return std::any_of(notices.begin(), notices.end(),
                       [&](const std::string& notice) { return notice.find(words) != std::string::npos; });
  }

  std::string textOn(const std::string& sensor) const {
    for (const auto& watched : watch_.sensors()) {
      if (watched.sensor == sensor) return watched.text;
    }
    return "(unknown)";
  }

  std::size_t held() const { return watch_.held(); }

  std::vector<std::string> notices;
  std::vector<std::string> dropped;  // sensors
  int went_back = 0;

 private:
  StampJudgement keep(StampJudgement judgement, const std::string& sensor) {
    notices.insert(notices.end(), judgement.notices.begin(), judgement.notices.end());
    for (const auto& verdict : judgement.verdicts) {
      if (verdict.refusal) dropped.push_back(sensor);
    }
    went_back += judgement.went_back ? 1 : 0;
    return judgement;
  }

  StampWatch watch_;
  std::uint64_t next_ = 0;
};

constexpr double kPeriod = 0.033;  // [s]
const std::vector<std::string> kThree{"a", "b", "c"};

/// Three sensors of 30 Hz from `from` to `to`, the first of which is off by `off`.
void runThree(Witness& witness, double from, double to, double off = 0.0) {
  for (int k = 0; from + kPeriod * k < to; ++k) {
    for (std::size_t s = 0; s < kThree.size(); ++s) {
      witness.take(kThree[s], from + kPeriod * k + 0.01 * static_cast<double>(s) + (s == 0 ? off : 0.0));
    }
  }
}

TEST(StampWatch, RefusesParametersThatCannotBe) {
  StampWatchParams params;
  params.max_lag = -1.0;
  EXPECT_THROW(StampWatch{params}, std::invalid_argument);
  params = {};
  params.scans_back = 0;
  EXPECT_THROW(StampWatch{params}, std::invalid_argument);
}

TEST(StampWatch, UsesEveryScanThatArrivesWithinTheLagWhateverTheOrder) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> latency(0.0, 0.99 * kLag);
  for (int run = 0; run < 50; ++run) {
    struct Arrival {
      double received, stamp;
      std::string sensor;
    };
    std::vector<Arrival> arrivals;
    const auto send = [&](double stamp, const std::string& sensor) {
      arrivals.push_back({stamp + latency(random), stamp, sensor});
    };
    for (int k = 0; k < 200; ++k) {
      const double pause = k > 120 ? 45.0 : 0.0;  // all are silent for a while
      for (const auto& sensor : kThree) send(kPeriod * k + pause, sensor);
      if (k % 40 == 0) send(kPeriod * k + pause + 0.011, "slow");
      if (k > 60) send(kPeriod * k + pause + 0.005, "joins later");
    }
    std::sort(arrivals.begin(), arrivals.end(),
              [](const Arrival& a, const Arrival& b) { return a.received < b.received; });
    StampGate<double> gate{StampWatchParams{}};
    std::multiset<double> used;
    const auto keep = [&](const StampGate<double>::Result& result) {
      EXPECT_FALSE(result.went_back);
      EXPECT_TRUE(result.notices.empty()) << result.notices.front();
      for (const auto& passed : result.passed) {
        EXPECT_FALSE(passed.refusal);
        used.insert(passed.item);
      }
    };
    for (const Arrival& arrival : arrivals) keep(gate.take(arrival.sensor, at(arrival.stamp), arrival.stamp));
    keep(gate.finish());
    EXPECT_EQ(used.size(), arrivals.size());
  }
}

TEST(StampWatch, HoldsNothingOfOneSensorAlone) {
  Witness witness;
  for (const double stamp : {0.0, 0.03, 60.0, 60.03, 7200.0, 7201.0})
    EXPECT_TRUE(witness.isUsed(witness.take("a", stamp))) << stamp;
  EXPECT_TRUE(witness.notices.empty());
}

TEST(StampWatch, HoldsNothingOfSlowSensorsOnceTheirRateIsKnown) {
  Witness witness;
  for (int k = 0; k < 10; ++k) {
    for (const char* sensor : {"radar", "sonar"}) {
      const bool is_used = witness.isUsed(witness.take(sensor, 2.0 * k + (*sensor == 's' ? 0.9 : 0.0)));
      EXPECT_TRUE(is_used || k < 4) << sensor << " " << k;
    }
  }
  EXPECT_EQ(witness.held(), 0u);
  EXPECT_TRUE(witness.dropped.empty());
}

class Step : public testing::TestWithParam<double> {};

TEST_P(Step, ForwardOfOneClockCostsThatSensorAloneUntilItReturns) {
  Witness witness;
  runThree(witness, 0.0, 5.0);
  runThree(witness, 5.0, 10.0, GetParam());
  EXPECT_EQ(witness.notices.size(), 1u);
  EXPECT_TRUE(witness.said("stamps of a are ")) << witness.notices.at(0);
  EXPECT_TRUE(witness.said(" ahead of the others'")) << witness.notices.at(0);
  EXPECT_NE(witness.textOn("a"), "");
  EXPECT_EQ(witness.textOn("b"), "");
  EXPECT_GT(witness.dropped.size(), 140u);
  EXPECT_TRUE(witness.isUsed(witness.take("b", 10.0)));
  EXPECT_TRUE(witness.isUsed(witness.take("a", 10.01)));
  EXPECT_TRUE(witness.said("stamps of a agree with the others' again"));
  EXPECT_EQ(witness.textOn("a"), "");
  EXPECT_EQ(witness.went_back, 0);
}

TEST_P(Step, BackOfOneClockIsSaidAndTimeGoesOnForTheOthers) {
  Witness witness;
  runThree(witness, 4000.0, 4005.0);
  runThree(witness, 4005.0, 4010.0, -GetParam());
  EXPECT_EQ(witness.went_back, 0);
  EXPECT_EQ(witness.notices.size(), 1u);
  EXPECT_TRUE(witness.said(" behind the others'"));
  EXPECT_TRUE(witness.isUsed(witness.take("b", 4010.0)));
  witness.take("a", 4010.01);
  EXPECT_TRUE(witness.said("stamps of a agree with the others' again"));
}

TEST_P(Step, BackOfAllStartsAnewOnceAndAtOnce) {
  Witness witness;
  runThree(witness, 4000.0, 4005.0);
  runThree(witness, 4005.0 - GetParam(), 4006.0 - GetParam());
  EXPECT_EQ(witness.went_back, 1);
  EXPECT_EQ(witness.notices.size(), 1u);
  EXPECT_TRUE(witness.said("stamps went back by "));
  EXPECT_TRUE(witness.isUsed(witness.take("a", 4006.0 - GetParam())));
}

TEST_P(Step, BackOfTheOnlySensorStartsAnew) {
  Witness witness;
  for (int k = 0; k < 100; ++k) witness.take("a", 4000.0 + kPeriod * k);
  for (int k = 0; k < 10; ++k) witness.take("a", 4003.3 - GetParam() + kPeriod * k);
  EXPECT_EQ(witness.went_back, 1);
}

INSTANTIATE_TEST_SUITE_P(Seconds, Step, testing::Values(0.7, 10.0, 3600.0));

TEST(StampWatch, ASensorAheadFromTheStartIsTheOddOneOut) {
  for (const double off : {0.7, 3600.0}) {
    Witness witness;
    runThree(witness, 0.0, 5.0, off);
    EXPECT_EQ(witness.went_back, 1) << "its stamps came first";
    EXPECT_TRUE(witness.said("stamps of a are "));
    EXPECT_TRUE(witness.isUsed(witness.take("b", 5.0)));
    EXPECT_TRUE(witness.isUsed(witness.take("c", 5.0)));
    EXPECT_FALSE(witness.isUsed(witness.take("a", 5.0 + off)));
  }
}

TEST(StampWatch, AfterAPauseOfAllEverythingIsUsedAndNothingSaid) {
  Witness witness;
  runThree(witness, 0.0, 5.0);
  runThree(witness, 65.0, 70.0);
  EXPECT_TRUE(witness.notices.empty()) << witness.notices.front();
  EXPECT_TRUE(witness.dropped.empty());
  EXPECT_EQ(witness.held(), 0u);
}

TEST(StampWatch, ASensorGoesOnAloneOnceTheOthersAreSilent) {
  Witness witness;
  runThree(witness, 0.0, 5.0);
  bool is_used = false;
  for (int k = 0; k < 100; ++k) is_used = witness.isUsed(witness.take("a", 100.0 + kPeriod * k));
  EXPECT_TRUE(is_used);
  EXPECT_TRUE(witness.dropped.empty()) << "what was held is used, too";
}

TEST(StampWatch, AStampThatAClockVouchesForIsNotHeld) {
  Witness witness;
  runThree(witness, 0.0, 5.0);
  EXPECT_TRUE(witness.isUsed(witness.takeByClock("a", 65.0, 65.01)));
  EXPECT_FALSE(witness.isUsed(witness.takeByClock("a", 165.0, 1e9)))
      << "a clock of another time vouches for nothing";
}

TEST(StampWatch, OneStrayStampIsDroppedAndTheSensorUsedOn) {
  Witness witness;
  runThree(witness, 0.0, 5.0);
  EXPECT_FALSE(witness.isUsed(witness.take("a", 3600.0)));
  EXPECT_TRUE(witness.isUsed(witness.take("a", 5.01)));
  EXPECT_EQ(witness.dropped.size(), 1u);
  EXPECT_TRUE(witness.isUsed(witness.take("b", 5.02)));
  EXPECT_TRUE(witness.isUsed(witness.take("a", 5.04)));
}

TEST(StampWatch, AFewStaleScansAreNoLoop) {
  Witness witness;
  runThree(witness, 10.0, 15.0);
  for (int k = 0; k < 4; ++k) witness.take("a", 10.0 + kPeriod * k);
  runThree(witness, 15.0, 20.0);
  EXPECT_EQ(witness.went_back, 0);
  EXPECT_TRUE(witness.notices.empty());
}

TEST(StampWatch, ASensorThatIsOnlyLateIsNotAccused) {
  Witness witness;
  runThree(witness, 0.0, 5.0);
  // b is held up by 0.6 s, then its scans come in a burst.
  for (int k = 0; k < 18; ++k) witness.take("a", 5.0 + kPeriod * k);
  for (int k = 0; k < 18; ++k) witness.take("b", 5.0 + kPeriod * k);
  runThree(witness, 5.6, 8.0);
  EXPECT_TRUE(witness.notices.empty()) << witness.notices.front();
}

/// Sensors of 30 Hz; the stamps of the first are anywhere in the last three seconds.
class OneErraticOf : public testing::TestWithParam<int> {};

TEST_P(OneErraticOf, IsLeftOutAlone) {
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
    for (const bool has_clock : {true, false}) {
      Witness witness;
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> age(0.0, 3.0);
      int dropped = 0;
      for (int k = 0; k < 55 * 30; ++k) {
        const double now = 100.0 + kPeriod * k;
        const auto take = [&](const std::string& sensor, double stamp) {
          return has_clock ? witness.takeByClock(sensor, stamp, now) : witness.take(sensor, stamp);
        };
        take("a", now - age(random));
        for (int other = 1; other < GetParam(); ++other) {
          const bool is_used = witness.isUsed(take("b" + std::to_string(other), now + 1e-3 * other));
          // Without a clock nobody knows at the start which of two is right.
          if (has_clock || k > 90) dropped += is_used ? 0 : 1;
        }
      }
      EXPECT_EQ(witness.went_back, 0) << "seed " << seed << " clock " << has_clock;
      EXPECT_EQ(dropped, 0) << "seed " << seed << " clock " << has_clock;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, OneErraticOf, testing::Values(2, 3, 6));

TEST(StampWatch, ASensorThatStartsAgainIsFollowedOnceTheOthersAreSilent) {
  Witness witness;
  runThree(witness, 4000.0, 4005.0);
  for (int k = 0; k < 120; ++k) witness.take("a", 10.0 + kPeriod * k);
  EXPECT_EQ(witness.went_back, 1);
  EXPECT_TRUE(witness.isUsed(witness.take("a", 14.0)));
}

TEST(StampWatch, RemembersNoMoreThanSoManySensors) {
  StampWatch watch{StampWatchParams{}};
  for (std::uint64_t k = 0; k < 10000; ++k) {
    watch.take(2 * k, "here", at(0.001 * static_cast<double>(k)));
    watch.take(2 * k + 1, "sensor " + std::to_string(k), at(0.001 * static_cast<double>(k)));
  }
  const auto sensors = watch.sensors();
  EXPECT_LE(sensors.size(), 256u);
  EXPECT_TRUE(
      std::any_of(sensors.begin(), sensors.end(), [](const auto& it) { return it.sensor == "here"; }));
}

TEST(StampWatch, HoldsNoMoreThanItsLimit) {
  StampWatchParams params;
  params.max_held = 10;
  params.alive = 1e6;
  Witness witness(params);
  witness.take("a", 0.0);
  witness.take("b", 0.0);
  for (int k = 0; k < 50; ++k) witness.take("a", 100.0 + kPeriod * k);
  EXPECT_EQ(witness.held(), 10u);
  EXPECT_EQ(witness.dropped.size(), 40u);
}

}  // namespace
