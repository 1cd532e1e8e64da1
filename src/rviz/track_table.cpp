#include "sightline/rviz/track_table.h"

#include <QColor>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "sightline/rviz/palette.h"
#include "sightline/rviz/texts.h"

namespace sightline_rviz {
namespace {

using sightline_ros::TrackKey;
using sightline_ros::TrackKind;
using sightline_ros::TrackRow;

QString textOf(const TrackRow& row, int column) {
  switch (column) {
    case TrackTable::kKind:
      return text(sightline_ros::wordOf(row.kind));
    case TrackTable::kTracker:
      return text(row.tracker);
    case TrackTable::kId:
      return QString::number(row.key.id);
    case TrackTable::kState:
      return text(sightline_ros::stateText(row));
    case TrackTable::kExistence:
      return number(row.existence, 2);
    case TrackTable::kAge:
      return number(row.age, 1);
    case TrackTable::kUnseen:
      return number(row.unseen, 2);
    case TrackTable::kSigma:
      return text(sightline_ros::sigmaText(row.sigma, row.kind));
    default:
      return text(sightline_ros::joined(row.sources));
  }
}

/// What a column is sorted by. Values that are not known come first.
QVariant sortedBy(const TrackRow& row, int column) {
  const auto known = [](double value) { return std::isfinite(value) ? value : -1.0; };
  switch (column) {
    case TrackTable::kKind:
      return row.kind == TrackKind::global ? 0 : row.kind == TrackKind::position ? 1 : 2;
    case TrackTable::kId:
      return row.key.id;
    case TrackTable::kExistence:
      return known(row.existence);
    case TrackTable::kAge:
      return known(row.age);
    case TrackTable::kUnseen:
      return known(row.unseen);
    case TrackTable::kSigma:
      return known(row.sigma);
    default:
      return textOf(row, column);
  }
}

QColor colourOf(const TrackRow& row) {
  if (row.silence > 0.0) return QColor(palette::kBad);
  if (row.status == sightline::Track::CONFIRMED) return QColor(palette::kText);
  return QColor(row.status == sightline::Track::COASTING ? palette::kDoubtful : palette::kFaintText);
}

}  // namespace

void TrackTable::show(const std::vector<TrackRow>& rows) {
  std::set<TrackKey> kept;
  for (const TrackRow& row : rows) kept.insert(row.key);
  for (int last = rowCount() - 1; last >= 0; --last) {
    if (kept.count(rows_[static_cast<std::size_t>(last)].key) > 0) continue;
    beginRemoveRows(QModelIndex(), last, last);
    rows_.erase(rows_.begin() + last);
    endRemoveRows();
  }
  std::map<TrackKey, std::size_t> places;
  for (std::size_t i = 0; i < rows_.size(); ++i) places.emplace(rows_[i].key, i);
  std::vector<TrackRow> fresh;
  for (const TrackRow& row : rows) {
    const auto place = places.find(row.key);
    if (place != places.end())
      rows_[place->second] = row;
    else
      fresh.push_back(row);
  }
  if (!rows_.empty()) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
  if (fresh.empty()) return;
  beginInsertRows(QModelIndex(), rowCount(), rowCount() + static_cast<int>(fresh.size()) - 1);
  rows_.insert(rows_.end(), fresh.begin(), fresh.end());
  endInsertRows();
}

std::optional<int> TrackTable::rowOf(const TrackKey& key) const {
  const auto found =
      std::find_if(rows_.begin(), rows_.end(), [&key](const TrackRow& row) { return row.key == key; });
  if (found == rows_.end()) return std::nullopt;
  return static_cast<int>(found - rows_.begin());
}

int TrackTable::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(rows_.size());
}

int TrackTable::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : kColumns;
}

QVariant TrackTable::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount()) return {};
  const TrackRow& row = rows_[static_cast<std::size_t>(index.row())];
  switch (role) {
    case Qt::DisplayRole:
      return textOf(row, index.column());
    case kSortRole:
      return sortedBy(row, index.column());
    case Qt::ForegroundRole:
      return colourOf(row);
    case Qt::ToolTipRole:
      return text(row.key.topic);
    default:
      return {};
  }
}

QVariant TrackTable::headerData(int section, Qt::Orientation orientation, int role) const {
  static const char* const kNames[kColumns] = {"kind",    "tracker",    "id",    "state",  "exists",
                                               "age [s]", "unseen [s]", "sigma", "sources"};
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole || section >= kColumns) return {};
  return QString(kNames[section]);
}

SortedTracks::SortedTracks(TrackTable* tracks, QObject* parent)
    : QSortFilterProxyModel(parent), tracks_(tracks) {
  setSourceModel(tracks);
  setSortRole(TrackTable::kSortRole);
  setDynamicSortFilter(true);
}

void SortedTracks::setFilter(const QString& words) {
  filter_ = words.toStdString();
  invalidateFilter();
}

bool SortedTracks::filterAcceptsRow(int row, const QModelIndex&) const {
  return sightline_ros::matches(tracks_->rows()[static_cast<std::size_t>(row)], filter_);
}

}  // namespace sightline_rviz
