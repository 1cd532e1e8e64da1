#include "sightline/ros/params/reconfiguration.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/fusion/track_fusion_params.h"
#include "sightline/core/tracking/local_tracker_params.h"
#include "sightline/ros/params/track_fusion_params.h"
#include "sightline/ros/params/tracker_params.h"

#include "support/paths.h"

namespace {

namespace core = sightline::core;
using sightline_ros::ChangeableParam;
using sightline_ros::ParamError;
using sightline_ros::ParamReader;
using sightline_ros::ReadParam;
using sightline_ros::Reconfiguration;
using XmlRpc::XmlRpcValue;

ParamReader shippedReader(const std::string& file) {
  return ParamReader::fromYaml(sightline::test::sourceDirectory() + "/config/" + file);
}

/// Values of the same kind that are not the one in force; some may be refused by the loader.
std::vector<XmlRpcValue> otherValues(const ReadParam& param) {
  XmlRpcValue value = param.value;
  std::vector<XmlRpcValue> others;
  if (param.kind == ReadParam::Kind::number) {
    const double number = value;
    for (const double other : {0.9 * number, 1.1 * number, number + 0.1, number - 0.1, number + 1.0}) {
      if (other != number) others.emplace_back(other);
    }
  } else if (param.kind == ReadParam::Kind::integer) {
    others = {XmlRpcValue(static_cast<int>(value) - 1), XmlRpcValue(static_cast<int>(value) + 1)};
  } else if (param.kind == ReadParam::Kind::flag) {
    others.emplace_back(!static_cast<bool>(value));
  } else {
    for (const std::string& choice : param.choices)
      if (choice != static_cast<std::string>(value)) others.emplace_back(choice);
  }
  return others;
}

/// Whether the core takes another value of the parameter in flight.
template <typename Load>
bool changesInFlight(const ParamReader& shipped, const ReadParam& param, Load load) {
  for (const XmlRpcValue& other : otherValues(param)) {
    try {
      const auto wanted = load(shipped.withKey(param.key, other));
      return !core::whyNotInFlight(load(shipped), wanted);
    } catch (const ParamError&) {
      continue;  // out of its range
    }
  }
  ADD_FAILURE() << param.key << ": no other value was found";
  return false;
}

template <typename Load>
void expectTheTableIsWhatTheCoreAllows(const std::string& file, const std::vector<ChangeableParam>& table,
                                       Load load) {
  const ParamReader shipped = shippedReader(file);
  load(shipped);
  std::set<std::string> listed, allowed;
  for (const ChangeableParam& entry : table) {
    EXPECT_TRUE(listed.insert(entry.key).second) << entry.key << " is listed twice";
    EXPECT_FALSE(entry.description.empty());
  }
  const std::vector<ReadParam> read = shipped.readParams();
  EXPECT_GT(read.size(), 2 * table.size());
  for (const ReadParam& param : read) {
    // A list of maps is loaded as a whole; its elements have no name of their own here.
    if (param.key.find('[') != std::string::npos) continue;
    if (changesInFlight(shipped, param, load)) allowed.insert(param.key);
  }
  EXPECT_EQ(listed, allowed);
}

TEST(Reconfiguration, TheTableOfTheTrackerIsWhatTheCoreAllowsOfEveryParameterInTheFile) {
  expectTheTableIsWhatTheCoreAllows(
      "local_tracker.yaml", sightline_ros::changeableTrackerParams(),
      [](const ParamReader& reader) { return sightline_ros::loadLocalTrackerParams(reader); });
}

TEST(Reconfiguration, TheTableOfTheFusionIsWhatTheCoreAllowsOfEveryParameterInTheFile) {
  expectTheTableIsWhatTheCoreAllows(
      "track_fusion.yaml", sightline_ros::changeableFusionParams(),
      [](const ParamReader& reader) { return sightline_ros::loadTrackFusionParams(reader); });
}

/// A tracker's parameters that may change, with the last ones that were applied.
class ReconfigurationOfATracker : public testing::Test {
 protected:
  XmlRpcValue valueOf(const std::string& key) const {
    for (const ReadParam& param : reconfiguration_.params())
      if (param.key == key) return param.value;
    ADD_FAILURE() << key;
    return {};
  }

  std::string refusalOf(const std::map<std::string, XmlRpcValue>& wanted) {
    const int applied = applied_;
    const auto result = reconfiguration_.change(wanted);
    EXPECT_TRUE(result.changes.empty());
    EXPECT_EQ(applied_, applied);
    return result.refusal.value_or("");
  }

  ParamReader reader_ = shippedReader("local_tracker.yaml");
  core::LocalTrackerParams params_ = sightline_ros::loadLocalTrackerParams(reader_);
  double max_future_ = reader_.number("max_future", 0.1, sightline_ros::atLeast(0.0), "s");  // the node's own
  int applied_ = 0;
  Reconfiguration reconfiguration_{reader_, sightline_ros::changeableTrackerParams(),
                                   [this](const ParamReader& reader) {
                                     const auto wanted = sightline_ros::loadLocalTrackerParams(reader);
                                     auto refusal = core::whyNotInFlight(params_, wanted);
                                     if (refusal) return refusal;
                                     params_ = wanted;
                                     ++applied_;
                                     return refusal;
                                   }};
};

TEST_F(ReconfigurationOfATracker, ChangesAreAppliedAtOnceAndSaidWithTheValuesBefore) {
  const auto result = reconfiguration_.change({{"gate/probability", 0.9}, {"association", "jpda"}});
  EXPECT_FALSE(result.refusal);
  EXPECT_EQ(applied_, 1);
  EXPECT_EQ(params_.gate.probability, 0.9);
  EXPECT_EQ(params_.association, core::AssociationMethod::jpda);
  ASSERT_EQ(result.changes.size(), 2u);
  EXPECT_EQ(result.changes[0].key, "association");
  EXPECT_EQ(result.changes[1].key, "gate/probability");
  EXPECT_EQ(sightline_ros::shortText(result.changes[1].from), "0.9995");
  EXPECT_EQ(sightline_ros::shortText(result.changes[1].to), "0.9");
  EXPECT_TRUE(valueOf("gate/probability") == XmlRpcValue(0.9));
  reconfiguration_.change({{"gate/shape", "rectangle"}});
  EXPECT_EQ(params_.gate.probability, 0.9) << "what was changed before stays";
}

TEST_F(ReconfigurationOfATracker, ValuesInForceAreNoChange) {
  std::map<std::string, XmlRpcValue> all;
  for (const ReadParam& param : reconfiguration_.params()) all[param.key] = param.value;
  const auto result = reconfiguration_.change(all);
  EXPECT_FALSE(result.refusal);
  EXPECT_TRUE(result.changes.empty());
  EXPECT_EQ(applied_, 0);
}

TEST_F(ReconfigurationOfATracker, LimitsThatDependOnEachOtherAreCheckedTogether) {
  EXPECT_NE(refusalOf({{"lifecycle/confirm_hits", 8}}), "");
  EXPECT_FALSE(
      reconfiguration_.change({{"lifecycle/confirm_hits", 8}, {"lifecycle/confirm_scans", 10}}).refusal);
  EXPECT_EQ(params_.lifecycle.confirm_hits, 8);
}

TEST_F(ReconfigurationOfATracker, RefusalsNameTheParameterTheValueAndTheReasonAndChangeNothing) {
  const std::string range = refusalOf({{"gate/probability", 1.0}, {"association", "jpda"}});
  EXPECT_NE(range.find("gate/probability = 1"), std::string::npos) << range;
  EXPECT_NE(range.find("(0, 1)"), std::string::npos) << range;
  EXPECT_EQ(params_.association, core::AssociationMethod::nearest);
  EXPECT_NE(refusalOf({{"association", "best"}}).find("nearest, jpda"), std::string::npos);
  EXPECT_NE(refusalOf({{"gate/probability", "0.9"}}).find("a number"), std::string::npos);
  EXPECT_NE(refusalOf({{"estimator", "kalman"}}).find("start the node again"), std::string::npos);
  EXPECT_NE(refusalOf({{"max_future", 1.0}}).find("start the node again"), std::string::npos);
  EXPECT_NE(refusalOf({{"gate/probabilty", 0.9}}).find("did you mean gate/probability"), std::string::npos);
}

TEST_F(ReconfigurationOfATracker, AWholeNumberServesAsANumber) {
  EXPECT_FALSE(reconfiguration_.change({{"lifecycle/coast_silence", 1}}).refusal);
  EXPECT_EQ(params_.lifecycle.coast_silence, 1.0);
  EXPECT_TRUE(valueOf("lifecycle/coast_silence") == XmlRpcValue(1.0)) << "its kind stays";
}

TEST(ReconfigurationTable, AParameterThatNobodyReadIsAFaultOfTheProgram) {
  const ParamReader reader(XmlRpcValue(), "node");
  EXPECT_THROW(Reconfiguration(reader, {{"gate/probability", ""}}, nullptr), std::logic_error);
}

}  // namespace
