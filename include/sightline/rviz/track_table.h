#pragma once

#include <QAbstractTableModel>
#include <QSortFilterProxyModel>
#include <optional>
#include <string>
#include <vector>

#include "sightline/ros/inspector/track_rows.h"

namespace sightline_rviz {

/// The tracks of all topics as rows of a table; a row keeps its place from one picture to the next.
class TrackTable : public QAbstractTableModel {
  Q_OBJECT
 public:
  enum Column { kKind, kTracker, kId, kState, kExistence, kAge, kUnseen, kSigma, kSources, kColumns };
  static constexpr int kSortRole = Qt::UserRole;  ///< of data by which columns are sorted

  explicit TrackTable(QObject* parent) : QAbstractTableModel(parent) {}

  void show(const std::vector<sightline_ros::TrackRow>& rows);

  const std::vector<sightline_ros::TrackRow>& rows() const { return rows_; }
  std::optional<int> rowOf(const sightline_ros::TrackKey& key) const;

  int rowCount(const QModelIndex& parent = QModelIndex()) const override;
  int columnCount(const QModelIndex& parent = QModelIndex()) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  std::vector<sightline_ros::TrackRow> rows_;
};

/// Sorted by any column, without the rows that the filter's words are not in.
class SortedTracks : public QSortFilterProxyModel {
  Q_OBJECT
 public:
  explicit SortedTracks(TrackTable* tracks, QObject* parent);

  void setFilter(const QString& words);

 protected:
  bool filterAcceptsRow(int row, const QModelIndex& parent) const override;

 private:
  TrackTable* tracks_;
  std::string filter_;
};

}  // namespace sightline_rviz
