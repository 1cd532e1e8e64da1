#pragma once

#include <QCheckBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QTabWidget>
#include <QTableView>
#include <QTimer>
#include <QWidget>
#include <functional>
#include <optional>

#include "sightline/ros/display/display_colours.h"
#include "sightline/ros/inspector/inspector_model.h"
#include "sightline/rviz/text_table.h"
#include "sightline/rviz/track_plots.h"
#include "sightline/rviz/track_table.h"

namespace sightline_rviz {

/// The panel's contents: a table of all tracks, and of the selected one plots, sightings, support and the
/// health of sensors. It reads a model that somebody else fills.
class InspectorWidget : public QWidget {
  Q_OBJECT
 public:
  static constexpr int kPlotPeriod = 33;          ///< between two pictures of the plots [ms]
  static constexpr int kPicturesOfTables = 6;     ///< of the plots to one of the tables: five a second
  static constexpr std::size_t kMostLines = 200;  ///< of sightings and verdicts

  using Model = sightline_ros::InspectorModel;
  /// Calls what it is given with the model, while nobody else uses it.
  using Access = std::function<void(const std::function<void(Model&)>&)>;

  InspectorWidget(Access access, const sightline_ros::SensorColours& colours, QWidget* parent = nullptr);

  /// As if a person had clicked the track in the table; nullopt: none is selected.
  void select(const std::optional<sightline_ros::TrackKey>& key);

  /// The selected track as last shown; nullopt when none is selected or it is over.
  const std::optional<sightline_ros::TrackRow>& selectedRow() const { return selected_row_; }

  /// The rows as last shown, in the table's order of arrival, without those that the filter hides.
  std::vector<sightline_ros::TrackRow> shownRows() const;

  /// Puts a further tab beside those of the tables.
  void addTab(QWidget* widget, const QString& title) { tabs_->addTab(widget, title); }

  bool follows() const { return follow_->isChecked(); }
  bool isAlone() const { return alone_->isChecked(); }

  /// What became of the last minute: see SaveRequest::words.
  void setSaveWords(const QString& words, bool is_under_way);

  void refresh();        ///< plots, and tables now and then
  void refreshTables();  ///< tables now

 Q_SIGNALS:
  /// The selected track or `isAlone` changed.
  void selectionChanged(const std::optional<sightline_ros::TrackKey>& key);
  void saveWanted();

 private:
  QWidget* buttons();
  QWidget* plots();
  QWidget* tables();
  QTableView* view(QAbstractItemModel* model, const QList<int>& widths);
  void onRowClicked();
  void showWords();
  void showRows(const std::vector<sightline_ros::TrackRow>& rows);
  void showDetail(const std::optional<sightline_ros::TrackDetail>& detail);
  void showSightings(const std::vector<sightline_ros::SightingLine>& lines);
  void showSupport(const std::vector<sightline_ros::SupportRow>& rows);
  void showSensors(const std::vector<sightline_ros::SensorRow>& rows);
  void showChanges(const std::deque<sightline_ros::VerdictChange>& changes);
  std::vector<QRgb> coloursOf(const std::vector<std::string>& sensors) const;

  Access access_;
  sightline_ros::SensorColours colours_;
  std::optional<sightline_ros::TrackKey> selected_;
  std::optional<sightline_ros::TrackRow> selected_row_;
  int pictures_ = 0;

  QPushButton* freeze_ = nullptr;
  QPushButton* follow_ = nullptr;
  QPushButton* alone_ = nullptr;
  QPushButton* save_ = nullptr;
  QLabel* words_ = nullptr;  // of saving, and what the model has to say
  QLineEdit* filter_ = nullptr;
  TrackTable* tracks_ = nullptr;
  SortedTracks* sorted_ = nullptr;
  QTableView* track_view_ = nullptr;
  QLabel* headline_ = nullptr;
  QLabel* legend_ = nullptr;
  NisPlot* nis_ = nullptr;
  InnovationPlot* innovations_ = nullptr;
  SpreadPlot* spread_ = nullptr;
  QTabWidget* tabs_ = nullptr;
  TextTable* sightings_ = nullptr;
  TextTable* support_ = nullptr;
  TextTable* sensors_ = nullptr;
  TextTable* changes_ = nullptr;
  QString save_words_, notice_;  // what words_ shows
  QTimer timer_;
  bool is_selecting_ = false;  // by `select`, not by a person
};

}  // namespace sightline_rviz
