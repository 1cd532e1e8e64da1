#include "sightline/rviz/knob_panel.h"

#include <QApplication>
#include <QCheckBox>
#include <QLineEdit>
#include <QTest>
#include <atomic>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

using namespace sightline_rviz;
using sightline_ros::Knob;
using sightline_ros::KnobBoard;
using sightline_ros::KnobValue;
using sightline_ros::textOf;

const char* const kNode = "/groups/local_tracker";

template <typename Entry, typename Value>
void add(std::vector<Entry>& entries, const std::string& name, const Value& value) {
  entries.emplace_back();
  entries.back().name = name;
  entries.back().value = value;
}

/// A node that takes every wish, but for a gate above 0.99.
class KnobPanelTest : public testing::Test {
 protected:
  KnobPanelTest() : board_([this](const auto& node, const auto& wanted) { return answer(node, wanted); }) {
    describe();
    panel_.resize(400, 300);
    panel_.show();
    panel_.refresh();
  }

  void describe() {
    dynamic_reconfigure::ConfigDescription description;
    add(description.min.doubles, "gate/probability", 0.0);
    add(description.max.doubles, "gate/probability", 1.0);
    add(description.dflt.doubles, "gate/probability", 0.5);
    add(description.min.doubles, "dwell", 0.0);
    add(description.max.doubles, "dwell", std::numeric_limits<double>::max());
    add(description.dflt.doubles, "dwell", 2.0);
    add(description.dflt.bools, "guard/enabled", true);
    add(description.dflt.strs, "rule", "tracklets");
    add(description.dflt.ints, "hits", 3);
    add(description.min.ints, "hits", 1);
    add(description.max.ints, "hits", 6);
    description.groups.resize(1);
    for (const char* name : {"gate/probability", "dwell", "guard/enabled", "rule", "hits"}) {
      description.groups[0].parameters.emplace_back();
      description.groups[0].parameters.back().name = name;
      description.groups[0].parameters.back().description = "what it is for";
    }
    description.groups[0].parameters[3].edit_method =
        "{'enum_description': 'rule', 'enum': [{'name': 'tracklets', 'value': 'tracklets'}, {'name': 'best', "
        "'value': 'best'}]}";
    in_force_ = description.dflt;
    board_.take(kNode, description);
    board_.take(kNode, in_force_);
  }

  std::optional<dynamic_reconfigure::Config> answer(const std::string& node,
                                                    const dynamic_reconfigure::Config& wanted) {
    EXPECT_EQ(node, kNode);
    ++wishes_;
    if (is_silent_) return std::nullopt;
    for (const auto& entry : wanted.doubles)
      for (auto& known : in_force_.doubles)
        if (known.name == entry.name && entry.value <= (known.name == "gate/probability" ? 0.99 : 1e9))
          known.value = entry.value;
    for (const auto& entry : wanted.bools) in_force_.bools[0].value = entry.value;
    for (const auto& entry : wanted.strs) in_force_.strs[0].value = entry.value;
    for (const auto& entry : wanted.ints) in_force_.ints[0].value = entry.value;
    return in_force_;
  }

  bool isAnswered(int wishes) {
    for (int i = 0; i < 1000 && (wishes_ < wishes || board_.isUnderWay()); ++i) QTest::qWait(10);
    panel_.refresh();
    return wishes_ == wishes && !board_.isUnderWay();
  }

  template <typename Widget>
  Widget* find(const char* name) {
    return panel_.findChild<Widget*>(name);
  }
  QString words() { return find<QLabel>("knob_words")->text(); }
  std::string valueOf(const std::string& key) {
    for (const Knob& knob : board_.knobsOf(kNode))
      if (knob.key == key) return textOf(knob.value);
    return "";
  }
  void type(const char* name, const QString& words) {
    find<QLineEdit>(name)->setText(words);
    QTest::keyClick(find<QLineEdit>(name), Qt::Key_Return);
  }

  dynamic_reconfigure::Config in_force_;
  std::atomic<int> wishes_{0};
  std::atomic<bool> is_silent_{false};
  KnobBoard board_;
  KnobPanel panel_{board_};
};

TEST_F(KnobPanelTest, EveryKindOfParameterHasItsControlWithTheValueInForce) {
  EXPECT_EQ(find<QComboBox>("knob_nodes")->currentText(), kNode);
  EXPECT_EQ(find<QLineEdit>("gate/probability")->text(), "0.5");
  EXPECT_EQ(find<QSlider>("gate/probability slider")->value(), SliderScale::kSteps / 2);
  EXPECT_TRUE(find<QCheckBox>("guard/enabled")->isChecked());
  EXPECT_EQ(find<QComboBox>("rule")->currentText(), "tracklets");
  EXPECT_EQ(find<QComboBox>("rule")->count(), 2);
  EXPECT_EQ(find<QLineEdit>("hits")->text(), "3");
}

TEST_F(KnobPanelTest, ASliderTurnedByHandIsOneWishAndTheNodesAnswerIsShown) {
  auto* slider = find<QSlider>("gate/probability slider");
  QTest::keyClick(slider, Qt::Key_PageUp);
  ASSERT_TRUE(isAnswered(1));
  EXPECT_EQ(valueOf("gate/probability"), "0.55");
  EXPECT_EQ(find<QLineEdit>("gate/probability")->text(), "0.55");
  EXPECT_EQ(words(), "gate/probability is 0.55");
}

TEST_F(KnobPanelTest, ARefusedWishIsSaidAndItsReasonWhenTheNodeTellsIt) {
  type("gate/probability", "0.999");
  ASSERT_TRUE(isAnswered(1));
  EXPECT_TRUE(words().startsWith("refused: gate/probability = 0.999; it stays 0.5")) << words().toStdString();
  EXPECT_EQ(find<QLineEdit>("gate/probability")->text(), "0.5");
  diagnostic_msgs::DiagnosticArray diagnostics;
  diagnostics.status.resize(1);
  diagnostics.status[0].name = "groups/local_tracker: tracking";
  diagnostics.status[0].values.resize(1);
  diagnostics.status[0].values[0].key = "changes refused in flight";
  diagnostics.status[0].values[0].value = "1, the last: the gate must be below 0.99";
  board_.take(diagnostics);
  panel_.refresh();
  EXPECT_EQ(words(), "refused: the gate must be below 0.99");
}

TEST_F(KnobPanelTest, WhatIsNoNumberIsNotAskedFor) {
  type("gate/probability", "much");
  EXPECT_EQ(words(), "refused: gate/probability takes a number, got \"much\"");
  type("hits", "2.5");
  EXPECT_EQ(words(), "refused: hits takes a whole number, got \"2.5\"");
  EXPECT_EQ(wishes_, 0);
  type("hits", "5");
  ASSERT_TRUE(isAnswered(1));
  EXPECT_EQ(valueOf("hits"), "5");
}

TEST_F(KnobPanelTest, SwitchesAndChoicesAreWishesToo) {
  find<QCheckBox>("guard/enabled")->click();
  ASSERT_TRUE(isAnswered(1));
  EXPECT_EQ(valueOf("guard/enabled"), "false");
  find<QComboBox>("rule")->setCurrentIndex(1);
  Q_EMIT find<QComboBox>("rule")->activated(1);
  ASSERT_TRUE(isAnswered(2));
  EXPECT_EQ(valueOf("rule"), "best");
}

TEST_F(KnobPanelTest, WhatOthersChangeIsShownAndANodeThatIsGoneIsSaid) {
  in_force_.doubles[1].value = 7.0;
  board_.take(kNode, in_force_);
  panel_.refresh();
  EXPECT_EQ(find<QLineEdit>("dwell")->text(), "7");
  is_silent_ = true;
  type("dwell", "3");
  ASSERT_TRUE(isAnswered(1));
  EXPECT_EQ(words(), "not changed: /groups/local_tracker does not answer; does it still run?");
}

TEST(SliderScale, GoesThereAndBackAndStaysWithinTheLimits) {
  Knob knob;
  knob.value = knob.fallback = 2.0;
  knob.low = 0.0;
  knob.high = 4.0;
  EXPECT_EQ(SliderScale(knob).stepOf(2.0), SliderScale::kSteps / 2);
  EXPECT_NEAR(SliderScale(knob).valueOf(250), 1.0, 1e-9);
  knob.high = std::numeric_limits<double>::infinity();
  const SliderScale open(knob);
  EXPECT_NEAR(open.valueOf(0), 0.2, 1e-9);
  EXPECT_NEAR(open.valueOf(SliderScale::kSteps), 20.0, 1e-9);
  EXPECT_NEAR(open.valueOf(open.stepOf(2.0)), 2.0, 0.01);
  EXPECT_EQ(open.stepOf(1e6), SliderScale::kSteps);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (!qEnvironmentVariableIsSet("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
