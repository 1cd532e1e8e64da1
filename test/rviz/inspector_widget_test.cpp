#include "sightline/rviz/inspector_widget.h"

#include <QApplication>
#include <QTest>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "sightline/rviz/palette.h"

#include "support/inspected.h"

namespace {

using namespace sightline_rviz;
using sightline::Association;
using sightline::test::at;
using sightline::test::decisionOn;
using sightline::test::decisionsOf;
using sightline::test::reportOf;
using sightline::test::sourceOf;
using sightline::test::tracksOf;
using sightline_ros::InspectorModel;
using sightline_ros::TrackKey;

const TrackKey kGlobal{"/fusion/tracks", 10};

/// A window on a model that the test fills; it is shown, and drawn when the test says so.
class InspectorWidgetTest : public testing::Test {
 protected:
  InspectorWidgetTest() : colours_({"eye"}) {
    widget_.resize(640, 900);
    widget_.show();
  }

  /// Global track 10 of left/1 and right/2. left/1 takes a sighting of the eye 1 mrad off, and refuses one 4
  /// mrad off; left/3 has a sigma of 7 mrad.
  void feed(double time) {
    auto left = tracksOf("left", time, {1, 3}, 2e-3);
    left->tracks[1].covariance[0] = 49e-6;
    model_.take("/groups/left/tracks", left, at(time));
    model_.take("/groups/right/tracks", tracksOf("right", time, {2}, 3e-3), at(time));
    model_.take("/fusion/tracks", tracksOf("fusion", time, {10}, 1e-3), at(time));
    model_.take("/fusion/report", reportOf(time, 10, {sourceOf("left", 1, 0.75), sourceOf("right", 2, 0.25)}),
                at(time));
    model_.take("/groups/left/associations",
                decisionsOf("eye", time - 0.5,
                            {decisionOn(1, Association::ACCEPTED, 1.0, 0.0),
                             decisionOn(1, Association::OUTSIDE_GATE, 4.0, 0.0)}),
                at(time));
  }

  QTableView* table(const char* name) { return widget_.findChild<QTableView*>(name); }
  QPushButton* button(const char* name) { return widget_.findChild<QPushButton*>(name); }
  QString headline() { return widget_.findChild<QLabel*>("headline")->text(); }

  /// What a table shows in a cell.
  QString cell(const char* name, int row, int column) {
    const auto* model = table(name)->model();
    return model->data(model->index(row, column), Qt::DisplayRole).toString();
  }

  /// A click as by a hand, on the row that shows this track.
  bool clickTrack(const TrackKey& key) {
    const auto rows = widget_.shownRows();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].key != key) continue;
      QTableView* view = table("tracks");
      const QModelIndex index = view->model()->index(static_cast<int>(i), TrackTable::kId);
      QTest::mouseClick(view->viewport(), Qt::LeftButton, Qt::NoModifier, view->visualRect(index).center());
      return true;
    }
    return false;
  }

  /// Pixels of a colour in what a widget draws.
  template <typename Widget>
  int pixelsOf(QRgb colour) {
    const QImage image = widget_.findChild<Widget*>()->grab().toImage().convertToFormat(QImage::Format_RGB32);
    int count = 0;
    for (int row = 0; row < image.height(); ++row) {
      for (int column = 0; column < image.width(); ++column)
        count += image.pixel(column, row) == colour ? 1 : 0;
    }
    return count;
  }

  QRgb eye() const { return palette::rgbOf(colours_.of("eye")); }

  InspectorModel model_;
  sightline_ros::SensorColours colours_;
  InspectorWidget widget_{[this](const std::function<void(InspectorModel&)>& use) { use(model_); }, colours_};
};

TEST_F(InspectorWidgetTest, AClickSelectsATrackAndItsStoryIsShown) {
  feed(100.0);
  widget_.refreshTables();
  ASSERT_TRUE(clickTrack(kGlobal));
  EXPECT_EQ(model_.selected(), kGlobal);
  EXPECT_EQ(headline(), "global track 10 on /fusion/tracks: confirmed, exists 0.99, sigma 1 mrad");

  ASSERT_EQ(table("sightings")->model()->rowCount(), 2);
  EXPECT_EQ(cell("sightings", 0, 0), "0.50");
  EXPECT_EQ(cell("sightings", 0, 1), "eye");
  EXPECT_EQ(cell("sightings", 0, 2), "left/1");
  EXPECT_EQ(cell("sightings", 0, 3), "refused");
  EXPECT_EQ(cell("sightings", 0, 4), "distance squared 16 is beyond the gate's 9");
  EXPECT_EQ(cell("sightings", 1, 3), "taken");

  ASSERT_EQ(table("support")->model()->rowCount(), 2);
  EXPECT_EQ(cell("support", 0, 0), "left");
  EXPECT_EQ(cell("support", 0, 2), "0.750");
  EXPECT_TRUE(widget_.findChild<NisPlot*>()->note().startsWith("mean 1.00 of 1"))
      << "of the one that was taken";
}

TEST_F(InspectorWidgetTest, PlotsShowWhatWasTakenInTheSensorsColourAndWhatWasRefusedInRed) {
  feed(100.0);
  widget_.select(TrackKey{"/groups/right/tracks", 2});
  EXPECT_EQ(pixelsOf<NisPlot>(eye()), 0) << "no sighting of this track";
  EXPECT_EQ(pixelsOf<InnovationPlot>(palette::kBad), 0);
  widget_.select(kGlobal);
  EXPECT_GE(pixelsOf<NisPlot>(eye()), 1);
  EXPECT_GE(pixelsOf<NisPlot>(palette::kBad), 1);
  EXPECT_GE(pixelsOf<InnovationPlot>(eye()), 1);
  EXPECT_GE(pixelsOf<InnovationPlot>(palette::kBad), 1);
  feed(100.3);
  feed(100.6);
  widget_.refresh();
  EXPECT_GE(pixelsOf<SpreadPlot>(palette::kText), 1) << "the line of sigma";
}

TEST_F(InspectorWidgetTest, WordsOfTheFilterHideOtherRows) {
  feed(100.0);
  widget_.refreshTables();
  EXPECT_EQ(widget_.shownRows().size(), 4u);
  QTest::keyClicks(widget_.findChild<QLineEdit*>("filter"), "LEFT local");
  ASSERT_EQ(widget_.shownRows().size(), 3u) << "all three local ones have a source of that name";
  QTest::keyClicks(widget_.findChild<QLineEdit*>("filter"), " nowhere");
  EXPECT_TRUE(widget_.shownRows().empty());
}

TEST_F(InspectorWidgetTest, AClickOnAHeaderSorts) {
  feed(100.0);
  widget_.refreshTables();
  QTableView* view = table("tracks");
  view->sortByColumn(TrackTable::kSigma, Qt::AscendingOrder);
  EXPECT_EQ(widget_.shownRows().front().key, kGlobal);
  view->sortByColumn(TrackTable::kSigma, Qt::DescendingOrder);
  EXPECT_EQ(widget_.shownRows().front().key, (TrackKey{"/groups/left/tracks", 3}));
  feed(101.0);
  widget_.refreshTables();
  EXPECT_EQ(widget_.shownRows().front().key, (TrackKey{"/groups/left/tracks", 3})) << "it stays sorted";
}

TEST_F(InspectorWidgetTest, TheChoiceOutlivesItsTrackAndARecordingThatBeginsAgain) {
  feed(100.0);
  widget_.refreshTables();
  ASSERT_TRUE(clickTrack(kGlobal));
  model_.tick(at(20.0));
  widget_.refreshTables();
  widget_.refresh();
  EXPECT_EQ(headline(), "track 10 on /fusion/tracks: there is no such track now");
  EXPECT_FALSE(widget_.selectedRow());
  feed(20.5);
  widget_.refreshTables();
  widget_.refresh();
  EXPECT_TRUE(headline().startsWith("global track 10 on /fusion/tracks: confirmed"));
  ASSERT_TRUE(widget_.selectedRow());
  EXPECT_EQ(widget_.selectedRow()->key, kGlobal);
  EXPECT_TRUE(table("tracks")->currentIndex().isValid()) << "its row is marked again";
}

TEST_F(InspectorWidgetTest, FrozenItStaysAsItIsAndAnotherTrackCanBeLookedAt) {
  feed(100.0);
  widget_.refreshTables();
  QTest::mouseClick(button("freeze"), Qt::LeftButton);
  EXPECT_EQ(button("freeze")->text(), "Frozen");
  feed(200.0);
  widget_.refreshTables();
  ASSERT_TRUE(clickTrack({"/groups/left/tracks", 1}));
  EXPECT_EQ(cell("sightings", 0, 0), "0.50");
  EXPECT_EQ(table("sightings")->model()->rowCount(), 2);
  QTest::mouseClick(button("freeze"), Qt::LeftButton);
  feed(201.0);
  widget_.refreshTables();
  EXPECT_EQ(model_.now(), at(201.0));
}

TEST_F(InspectorWidgetTest, ButtonsTellWhatIsWanted) {
  std::optional<TrackKey> chosen;
  bool was_alone = false;
  int saves = 0;
  QObject::connect(&widget_, &InspectorWidget::selectionChanged, [&](const std::optional<TrackKey>& key) {
    chosen = key;
    was_alone = widget_.isAlone();
  });
  QObject::connect(&widget_, &InspectorWidget::saveWanted, [&saves] { ++saves; });
  widget_.refresh();
  EXPECT_FALSE(button("alone")->isEnabled()) << "nothing is selected";
  EXPECT_FALSE(button("follow")->isEnabled());
  feed(100.0);
  widget_.refreshTables();
  ASSERT_TRUE(clickTrack(kGlobal));
  EXPECT_EQ(chosen, kGlobal);
  EXPECT_FALSE(was_alone);
  QTest::mouseClick(button("alone"), Qt::LeftButton);
  EXPECT_TRUE(was_alone);
  QTest::mouseClick(button("follow"), Qt::LeftButton);
  EXPECT_TRUE(widget_.follows());

  QTest::mouseClick(button("save"), Qt::LeftButton);
  EXPECT_EQ(saves, 1);
  widget_.setSaveWords("saving ...", true);
  EXPECT_FALSE(button("save")->isEnabled());
  widget_.setSaveWords("saved /tmp/a.bag", false);
  EXPECT_TRUE(button("save")->isEnabled());
  EXPECT_EQ(widget_.findChild<QLabel*>("words")->text(), "saved /tmp/a.bag");
}

TEST_F(InspectorWidgetTest, TracksThatComeAndGoKeepTheOthersInTheirRows) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t id = 1; id <= 200; ++id) ids.push_back(id);
  model_.take("/a/tracks", tracksOf("a", 100.0, ids), at(100.0));
  widget_.refreshTables();
  EXPECT_EQ(widget_.shownRows().size(), 200u);
  ASSERT_TRUE(clickTrack({"/a/tracks", 3}));
  ids.erase(ids.begin());
  ids.push_back(201);
  model_.take("/a/tracks", tracksOf("a", 101.0, ids), at(101.0));
  widget_.refreshTables();
  const auto rows = widget_.shownRows();
  ASSERT_EQ(rows.size(), 200u);
  EXPECT_EQ(rows.front().key.id, 2u);
  EXPECT_EQ(rows.back().key.id, 201u);
  EXPECT_EQ(table("tracks")->currentIndex().row(), 1) << "the row of track 3 is still the marked one";
}

TEST_F(InspectorWidgetTest, TellsThatThereAreMoreTopicsThanItShows) {
  for (std::size_t i = 0; i <= InspectorModel::kMostTopics; ++i)
    model_.take("/t" + std::to_string(i) + "/tracks", tracksOf("t", 100.0, {1}), at(100.0));
  widget_.refreshTables();
  widget_.setSaveWords("saved /tmp/a.bag", false);
  EXPECT_EQ(widget_.findChild<QLabel*>("words")->text(),
            "more than 128 topics of tracks: further ones are not shown\nsaved /tmp/a.bag");
}

TEST(TrackPlots, TicksAreRoundNumbersWithinTheAxis) {
  EXPECT_EQ((Axis{-60.0, 0.0, false}.ticks()), (std::vector<double>{-60, -50, -40, -30, -20, -10, 0}));
  EXPECT_EQ((Axis{-2.0, 2.0, false}.ticks()), (std::vector<double>{-2, -1, 0, 1, 2}));
  const auto decades = Axis{0.01, 100.0, true}.ticks();
  ASSERT_EQ(decades.size(), 5u);
  EXPECT_NEAR(decades.front(), 0.01, 1e-12);
  EXPECT_NEAR((Axis{0.01, 100.0, true}.share(1.0)), 0.5, 1e-12);
  EXPECT_TRUE((Axis{1.0, 1.0, false}.ticks().empty()));
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (!qEnvironmentVariableIsSet("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
