#include "sightline/rviz/text_table.h"

#include <QColor>

namespace sightline_rviz {

void TextTable::show(const std::vector<Row>& rows) {
  const int before = rowCount(), now = static_cast<int>(rows.size());
  if (now < before) beginRemoveRows(QModelIndex(), now, before - 1);
  if (now > before) beginInsertRows(QModelIndex(), before, now - 1);
  rows_ = rows;
  if (now < before) endRemoveRows();
  if (now > before) endInsertRows();
  if (now > 0) Q_EMIT dataChanged(index(0, 0), index(now - 1, columnCount() - 1));
}

int TextTable::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(rows_.size());
}

int TextTable::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : header_.size();
}

QVariant TextTable::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount()) return {};
  const Row& row = rows_[static_cast<std::size_t>(index.row())];
  if (role == Qt::DisplayRole || role == Qt::ToolTipRole) return row.cells.value(index.column());
  if (role == Qt::ForegroundRole) return QColor(row.colour);
  return {};
}

QVariant TextTable::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  return header_.value(section);
}

}  // namespace sightline_rviz
