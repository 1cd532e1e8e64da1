#pragma once

#include <QComboBox>
#include <QLabel>
#include <QScrollArea>
#include <QSlider>
#include <QTimer>
#include <QWidget>
#include <functional>
#include <string>
#include <vector>

#include "sightline/ros/inspector/knob_board.h"

namespace sightline_rviz {

/// Positions of a slider and the values of a number: linear between two limits; where one of them is missing,
/// by decades round the default.
class SliderScale {
 public:
  static constexpr int kSteps = 1000;

  /// `knob`: a number.
  explicit SliderScale(const sightline_ros::Knob& knob);

  int stepOf(double value) const;
  double valueOf(int step) const;  ///< three digits of it

 private:
  double low_, high_;
  bool is_logarithmic_;
};

/// What may change in flight, with sliders: one node at a time. It reads a board that somebody else fills.
class KnobPanel : public QWidget {
  Q_OBJECT
 public:
  static constexpr int kPeriod = 200;  ///< between two looks at the board [ms]

  explicit KnobPanel(sightline_ros::KnobBoard& board, QWidget* parent = nullptr);

  void refresh();

 private:
  /// One parameter: shows the value in force, unless a person is at it.
  struct Control {
    sightline_ros::Knob knob;
    std::function<void(const sightline_ros::KnobValue&)> show;
  };

  void showNode(const std::string& node);
  QWidget* controlFor(const sightline_ros::Knob& knob, Control& control);
  QWidget* numberFor(const sightline_ros::Knob& knob, Control& control);
  void wish(const std::string& key, const sightline_ros::KnobValue& value);

  sightline_ros::KnobBoard& board_;
  QComboBox* nodes_;
  QScrollArea* area_;
  QLabel* words_;
  std::string shown_;  // node
  std::vector<Control> controls_;
  QTimer timer_;
};

}  // namespace sightline_rviz
