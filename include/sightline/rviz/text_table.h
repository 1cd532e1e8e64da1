#pragma once

#include <QAbstractTableModel>
#include <QString>
#include <QStringList>
#include <vector>

namespace sightline_rviz {

/// Rows of text under a header, each in a colour; a text that does not fit is its own tool tip.
class TextTable : public QAbstractTableModel {
  Q_OBJECT
 public:
  struct Row {
    QStringList cells;
    QRgb colour = 0xffffffff;
  };

  TextTable(const QStringList& header, QObject* parent) : QAbstractTableModel(parent), header_(header) {}

  void show(const std::vector<Row>& rows);

  int rowCount(const QModelIndex& parent = QModelIndex()) const override;
  int columnCount(const QModelIndex& parent = QModelIndex()) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  QStringList header_;
  std::vector<Row> rows_;
};

}  // namespace sightline_rviz
