#include "sightline/rviz/inspector_widget.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QSplitter>
#include <QVBoxLayout>
#include <set>

#include "sightline/rviz/palette.h"
#include "sightline/rviz/texts.h"

namespace sightline_rviz {
namespace {

using sightline_ros::TrackDetail;
using sightline_ros::TrackKey;
using sightline_ros::TrackRow;

constexpr int kRowHeight = 18;  // [pixel]

/// Seconds after the epoch, as logs and /diagnostics give times.
QString timeText(sightline::core::Time time) {
  return number(sightline::core::seconds(time.time_since_epoch()), 1);
}

QString headlineOf(const TrackDetail& detail) {
  const QString name = QString("track %1 on %2").arg(detail.key.id).arg(text(detail.key.topic));
  if (!detail.row) return name + ": there is no such track now";
  const TrackRow& row = *detail.row;
  return QString("%1 %2: %3, exists %4, sigma %5")
      .arg(text(sightline_ros::wordOf(row.kind)), name, text(sightline_ros::stateText(row)),
           number(row.existence, 2), text(sightline_ros::sigmaText(row.sigma, row.kind)));
}

/// The sensors whose sightings the plots show, in their colours.
QString legendOf(const TrackDetail& detail, const std::vector<QRgb>& colours) {
  std::set<std::uint16_t> seen;
  for (const auto& point : detail.sightings) seen.insert(point.sensor);
  QString legend;
  for (const std::uint16_t sensor : seen) {
    legend += QString("<span style='color:%1'>&#9679; %2</span>&nbsp; ")
                  .arg(QColor(colours[sensor]).name(), text(detail.sensors[sensor]).toHtmlEscaped());
  }
  if (!legend.isEmpty())
    legend += QString("<span style='color:%1'>&#10005; refused</span>").arg(QColor(palette::kBad).name());
  return legend;
}

/// Colours of everything in the panel; rviz has none of its own.
QPalette darkPalette() {
  QPalette dark;
  dark.setColor(QPalette::Window, QColor(palette::kGround));
  dark.setColor(QPalette::Base, QColor(palette::kPlotGround));
  dark.setColor(QPalette::AlternateBase, QColor(palette::kGround));
  dark.setColor(QPalette::Button, QColor(palette::kGround));
  for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
    dark.setColor(role, QColor(palette::kText));
  return dark;
}

const char* const kStyle =
    "QWidget { background: #22272f; color: #e6e8ec; font-size: 11px; }"
    "QTableView { background: #10141c; gridline-color: #2b333f; selection-background-color: #2d5f8a; }"
    "QHeaderView::section { background: #2b333f; border: 0; border-right: 1px solid #22272f; padding: 2px "
    "4px; }"
    "QPushButton { background: #2b333f; border: 1px solid #454f5e; border-radius: 3px; padding: 3px 8px; }"
    "QPushButton:checked { background: #2d5f8a; } QPushButton:pressed { background: #1c2129; }"
    "QPushButton:disabled { color: #6a7280; }"
    "QLineEdit { background: #10141c; border: 1px solid #454f5e; border-radius: 3px; padding: 2px 4px; }"
    "QTabBar::tab { background: #2b333f; padding: 3px 8px; } QTabBar::tab:selected { background: #2d5f8a; }"
    "QTabWidget::pane { border: 0; } QTableCornerButton::section { background: #2b333f; }"
    "QSplitter::handle { background: #2b333f; }";

QPushButton* button(const QString& name, const QString& words, const QString& tip, bool is_checkable) {
  auto* made = new QPushButton(words);
  made->setObjectName(name);
  made->setToolTip(tip);
  made->setCheckable(is_checkable);
  return made;
}

}  // namespace

InspectorWidget::InspectorWidget(Access access, const sightline_ros::SensorColours& colours, QWidget* parent)
    : QWidget(parent), access_(std::move(access)), colours_(colours) {
  setPalette(darkPalette());
  setStyleSheet(kStyle);
  auto* splitter = new QSplitter(Qt::Vertical);
  tracks_ = new TrackTable(this);
  sorted_ = new SortedTracks(tracks_, this);
  track_view_ = view(sorted_, {52, 84, 34, 74, 44, 50, 70, 80});
  track_view_->setObjectName("tracks");
  track_view_->setSortingEnabled(true);
  track_view_->sortByColumn(TrackTable::kKind, Qt::AscendingOrder);
  connect(track_view_->selectionModel(), &QItemSelectionModel::currentRowChanged, this,
          [this] { onRowClicked(); });
  splitter->addWidget(track_view_);
  splitter->addWidget(plots());
  splitter->addWidget(tables());
  splitter->setSizes({230, 400, 210});

  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->setSpacing(4);
  layout->addWidget(buttons());
  layout->addWidget(splitter, 1);
  connect(&timer_, &QTimer::timeout, this, [this] {
    if (isVisible()) refresh();
  });
  timer_.start(kPlotPeriod);
}

QWidget* InspectorWidget::buttons() {
  auto* box = new QWidget;
  auto* rows = new QVBoxLayout(box);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(3);
  auto* row = new QHBoxLayout;
  freeze_ = button("freeze", "Freeze", "takes nothing in, so that all can be looked at as it is", true);
  follow_ = button("follow", "Follow", "keeps the selected track in the middle of the view", true);
  alone_ = button("alone", "Alone", "the displays show the selected track alone", true);
  save_ = button("save", "Save the last minute", "asks the flight recorder for a bag", false);
  for (QPushButton* one : {freeze_, follow_, alone_, save_}) row->addWidget(one);
  filter_ = new QLineEdit;
  filter_->setObjectName("filter");
  filter_->setPlaceholderText("filter: words of a row");
  filter_->setClearButtonEnabled(true);
  row->addWidget(filter_, 1);
  words_ = new QLabel;
  words_->setObjectName("words");
  words_->setWordWrap(true);
  words_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  words_->hide();
  rows->addLayout(row);
  rows->addWidget(words_);
  connect(freeze_, &QPushButton::toggled, this, [this](bool is_frozen) {
    access_([is_frozen](Model& model) { model.freeze(is_frozen); });
    freeze_->setText(is_frozen ? "Frozen" : "Freeze");
  });
  connect(alone_, &QPushButton::toggled, this, [this] { Q_EMIT selectionChanged(selected_); });
  connect(save_, &QPushButton::clicked, this, [this] { Q_EMIT saveWanted(); });
  connect(filter_, &QLineEdit::textChanged, this,
          [this](const QString& words) { sorted_->setFilter(words); });
  return box;
}

QWidget* InspectorWidget::plots() {
  auto* box = new QWidget;
  auto* rows = new QVBoxLayout(box);
  rows->setContentsMargins(0, 2, 0, 0);
  rows->setSpacing(2);
  headline_ = new QLabel("select a track: click it in the table or in the picture");
  headline_->setObjectName("headline");
  headline_->setWordWrap(true);
  legend_ = new QLabel;
  legend_->setObjectName("legend");
  legend_->setWordWrap(true);
  rows->addWidget(headline_);
  rows->addWidget(legend_);
  nis_ = new NisPlot(box);
  innovations_ = new InnovationPlot(box);
  spread_ = new SpreadPlot(box);
  rows->addWidget(nis_, 1);
  auto* lower = new QHBoxLayout;
  lower->setSpacing(4);
  lower->addWidget(innovations_, 1);
  lower->addWidget(spread_, 1);
  rows->addLayout(lower, 1);
  return box;
}

QWidget* InspectorWidget::tables() {
  tabs_ = new QTabWidget;
  const auto add = [&](const char* name, const QString& title, const QStringList& header,
                       const QList<int>& widths) {
    auto* table = new TextTable(header, this);
    auto* shown = view(table, widths);
    shown->setObjectName(name);
    tabs_->addTab(shown, title);
    return table;
  };
  sightings_ = add("sightings", "Sightings", {"age [s]", "sensor", "local track", "decision", "why"},
                   {52, 90, 100, 64});
  support_ =
      add("support", "Support", {"source", "id", "weight", "distance squared", "part"}, {100, 34, 60, 100});
  sensors_ = add("sensors", "Sensors",
                 {"sensor", "said by", "verdict", "noise found", "bias", "clock", "detection and input"},
                 {84, 150, 90, 130, 90, 150});
  changes_ = add("verdicts", "Verdicts", {"time [s]", "sensor", "said by", "what changed"}, {90, 90, 120});
  return tabs_;
}

QTableView* InspectorWidget::view(QAbstractItemModel* model, const QList<int>& widths) {
  auto* table = new QTableView;
  table->setModel(model);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setSelectionMode(QAbstractItemView::SingleSelection);
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setWordWrap(false);
  table->verticalHeader()->hide();
  table->verticalHeader()->setSectionResizeMode(QHeaderView::Fixed);
  table->verticalHeader()->setDefaultSectionSize(kRowHeight);
  table->horizontalHeader()->setStretchLastSection(true);
  table->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  table->horizontalHeader()->setHighlightSections(false);
  for (int column = 0; column < widths.size(); ++column) table->setColumnWidth(column, widths[column]);
  return table;
}

void InspectorWidget::onRowClicked() {
  if (is_selecting_) return;
  const QModelIndex index = sorted_->mapToSource(track_view_->currentIndex());
  if (!index.isValid()) return;  // the row is gone, for its track is: it stays selected
  select(tracks_->rows()[static_cast<std::size_t>(index.row())].key);
}

void InspectorWidget::select(const std::optional<TrackKey>& key) {
  const bool is_new = key != selected_;
  selected_ = key;
  access_([&key](Model& model) { model.select(key); });
  if (is_new) Q_EMIT selectionChanged(key);
  refreshTables();
  refresh();
}

std::vector<TrackRow> InspectorWidget::shownRows() const {
  std::vector<TrackRow> rows;
  for (int row = 0; row < sorted_->rowCount(); ++row)
    rows.push_back(
        tracks_->rows()[static_cast<std::size_t>(sorted_->mapToSource(sorted_->index(row, 0)).row())]);
  return rows;
}

void InspectorWidget::setSaveWords(const QString& words, bool is_under_way) {
  save_->setEnabled(!is_under_way);
  save_words_ = words;
  showWords();
}

void InspectorWidget::showWords() {
  const QString between = notice_.isEmpty() || save_words_.isEmpty() ? "" : "\n";
  words_->setText(notice_ + between + save_words_);
  words_->setVisible(!words_->text().isEmpty());
}

void InspectorWidget::refresh() {
  if (pictures_++ % kPicturesOfTables == 0) refreshTables();
  std::optional<TrackDetail> detail;
  access_([&detail](Model& model) { detail = model.detail(); });
  showDetail(detail);
}

void InspectorWidget::refreshTables() {
  std::vector<TrackRow> rows;
  std::vector<sightline_ros::SightingLine> lines;
  std::vector<sightline_ros::SupportRow> support;
  std::vector<sightline_ros::SensorRow> sensors;
  std::deque<sightline_ros::VerdictChange> changes;
  access_([&](Model& model) {
    rows = model.rows();
    lines = model.sightings(kMostLines);
    support = model.support();
    sensors = model.sensors();
    changes = model.verdictChanges();
    notice_ = text(model.notice());
  });
  showWords();
  showRows(rows);
  showSightings(lines);
  showSupport(support);
  showSensors(sensors);
  showChanges(changes);
}

void InspectorWidget::showRows(const std::vector<TrackRow>& rows) {
  is_selecting_ = true;
  tracks_->show(rows);
  const auto row = selected_ ? tracks_->rowOf(*selected_) : std::nullopt;
  const QModelIndex index = row ? sorted_->mapFromSource(tracks_->index(*row, 0)) : QModelIndex();
  if (index.isValid() && track_view_->currentIndex().row() != index.row()) {
    track_view_->setCurrentIndex(index);
    track_view_->scrollTo(index);
  } else if (!index.isValid()) {
    track_view_->selectionModel()->clear();
  }
  is_selecting_ = false;
}

void InspectorWidget::showDetail(const std::optional<TrackDetail>& detail) {
  selected_row_ = detail ? detail->row : std::nullopt;
  const bool can_follow = detail.has_value();
  follow_->setEnabled(can_follow);
  alone_->setEnabled(can_follow);
  if (!detail) return;
  const std::vector<QRgb> colours = coloursOf(detail->sensors);
  headline_->setText(headlineOf(*detail));
  legend_->setText(legendOf(*detail, colours));
  nis_->draw(*detail, colours);
  innovations_->draw(*detail, colours);
  spread_->draw(*detail);
}

void InspectorWidget::showSightings(const std::vector<sightline_ros::SightingLine>& lines) {
  std::vector<TextTable::Row> rows;
  for (const auto& line : lines) {
    rows.push_back(
        {{number(line.age, 2), text(line.sensor), text(line.tracker), text(line.decision), text(line.reason)},
         line.is_taken ? palette::kText : palette::kBad});
  }
  sightings_->show(rows);
}

void InspectorWidget::showSupport(const std::vector<sightline_ros::SupportRow>& support) {
  std::vector<TextTable::Row> rows;
  for (const auto& row : support) {
    rows.push_back({{text(row.tracker), row.id > 0 ? QString::number(row.id) : QString(),
                     number(row.weight, 3), number(row.distance_squared, 2), text(row.words)},
                    row.weight == 0.0 ? palette::kFaintText : palette::kText});
  }
  support_->show(rows);
}

void InspectorWidget::showSensors(const std::vector<sightline_ros::SensorRow>& sensors) {
  std::vector<TextTable::Row> rows;
  for (const auto& row : sensors) {
    const bool is_old = row.silence > sightline_ros::InspectorModel::kForgotten;
    rows.push_back({{text(row.sensor), text(row.by), text(row.verdict), text(row.noise), text(row.bias),
                     text(row.clock), text(row.detection)},
                    is_old           ? palette::kFaintText
                    : row.is_suspect ? palette::kBad
                                     : palette::kText});
  }
  sensors_->show(rows);
}

void InspectorWidget::showChanges(const std::deque<sightline_ros::VerdictChange>& changes) {
  std::vector<TextTable::Row> rows;
  for (auto change = changes.rbegin(); change != changes.rend(); ++change)
    rows.push_back({{timeText(change->time), text(change->sensor), text(change->by), text(change->words)},
                    palette::kText});
  changes_->show(rows);
}

std::vector<QRgb> InspectorWidget::coloursOf(const std::vector<std::string>& sensors) const {
  std::vector<QRgb> colours;
  colours.reserve(sensors.size());
  for (const std::string& sensor : sensors) colours.push_back(palette::rgbOf(colours_.of(sensor)));
  return colours;
}

}  // namespace sightline_rviz
