#include "sightline/rviz/knob_panel.h"

#include <QAbstractItemView>
#include <QCheckBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "sightline/rviz/texts.h"

namespace sightline_rviz {
namespace {

using sightline_ros::Knob;
using sightline_ros::KnobValue;

double numberIn(const KnobValue& value) {
  if (const int* whole = std::get_if<int>(&value)) return *whole;
  const double* number = std::get_if<double>(&value);
  return number != nullptr ? *number : 0.0;
}

/// A number of the kind that the knob has.
KnobValue numberLike(const KnobValue& kind, double number) {
  if (std::holds_alternative<int>(kind)) return static_cast<int>(std::lround(number));
  return number;
}

bool hasSameKeys(const std::vector<Knob>& knobs, const std::vector<Knob>& others) {
  return std::equal(knobs.begin(), knobs.end(), others.begin(), others.end(),
                    [](const Knob& a, const Knob& b) { return a.key == b.key; });
}

}  // namespace

SliderScale::SliderScale(const Knob& knob) : low_(knob.low), high_(knob.high) {
  constexpr double kReach = 10.0;  // by which the slider goes beyond the default, up and down
  const double fallback = numberIn(knob.fallback);
  is_logarithmic_ = !std::isfinite(low_) || !std::isfinite(high_);
  if (!is_logarithmic_) return;
  const double middle = fallback > 0.0 ? fallback : 1.0;
  high_ = std::min(high_, kReach * middle);
  low_ = std::max(low_, middle / kReach);
  is_logarithmic_ = low_ < high_;
  if (!is_logarithmic_) low_ = high_ - 1.0;
}

int SliderScale::stepOf(double value) const {
  const double share = is_logarithmic_ ? std::log(std::max(value, low_) / low_) / std::log(high_ / low_)
                                       : (value - low_) / (high_ - low_);
  return static_cast<int>(std::lround(kSteps * std::clamp(share, 0.0, 1.0)));
}

double SliderScale::valueOf(int step) const {
  const double share = static_cast<double>(step) / kSteps;
  const double value = is_logarithmic_ ? low_ * std::pow(high_ / low_, share) : low_ + share * (high_ - low_);
  return std::clamp(QString::number(value, 'g', is_logarithmic_ ? 3 : 4).toDouble(), low_, high_);
}

KnobPanel::KnobPanel(sightline_ros::KnobBoard& board, QWidget* parent) : QWidget(parent), board_(board) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(2, 2, 2, 2);
  nodes_ = new QComboBox;
  nodes_->setObjectName("knob_nodes");
  area_ = new QScrollArea;
  area_->setWidgetResizable(true);
  area_->setFrameShape(QFrame::NoFrame);
  words_ = new QLabel("parameters that may change in flight: no tracker or fusion is heard");
  words_->setObjectName("knob_words");
  words_->setWordWrap(true);
  words_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  layout->addWidget(nodes_);
  layout->addWidget(area_, 1);
  layout->addWidget(words_);
  connect(nodes_, &QComboBox::currentTextChanged, this,
          [this](const QString& name) { showNode(name.toStdString()); });
  connect(&timer_, &QTimer::timeout, this, [this] {
    if (isVisible()) refresh();
  });
  timer_.start(kPeriod);
}

void KnobPanel::refresh() {
  for (const std::string& node : board_.nodes()) {
    if (nodes_->findText(text(node)) >= 0) continue;
    if (nodes_->count() == 0) words_->setText("move a slider, or type a number and press Enter");
    nodes_->addItem(text(node));
  }
  const std::vector<Knob> knobs = board_.knobsOf(shown_);
  std::vector<Knob> shown;
  for (const Control& control : controls_) shown.push_back(control.knob);
  if (!hasSameKeys(knobs, shown)) showNode(shown_);
  for (std::size_t i = 0; i < controls_.size() && i < knobs.size(); ++i) controls_[i].show(knobs[i].value);
  const std::string words = board_.words();
  if (!words.empty()) words_->setText(text(words));
}

void KnobPanel::showNode(const std::string& node) {
  shown_ = node;
  controls_.clear();
  auto* box = new QWidget;
  auto* grid = new QGridLayout(box);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setVerticalSpacing(1);
  grid->setColumnStretch(1, 1);
  int row = 0;
  for (const Knob& knob : board_.knobsOf(node)) {
    auto* name = new QLabel(text(knob.key));
    name->setToolTip(text(knob.description + "; default " + sightline_ros::textOf(knob.fallback)));
    controls_.push_back({knob, {}});
    grid->addWidget(name, row, 0);
    grid->addWidget(controlFor(knob, controls_.back()), row++, 1);
  }
  grid->setRowStretch(row, 1);
  area_->setWidget(box);
}

QWidget* KnobPanel::controlFor(const Knob& knob, Control& control) {
  const std::string key = knob.key;
  if (std::holds_alternative<bool>(knob.value)) {
    auto* check = new QCheckBox;
    check->setObjectName(text(key));
    connect(check, &QCheckBox::clicked, this, [this, key](bool is_on) { wish(key, is_on); });
    control.show = [check](const KnobValue& value) { check->setChecked(std::get<bool>(value)); };
    control.show(knob.value);
    return check;
  }
  if (std::holds_alternative<std::string>(knob.value)) {
    auto* list = new QComboBox;
    list->setObjectName(text(key));
    for (const std::string& choice : knob.choices) list->addItem(text(choice));
    connect(list, QOverload<int>::of(&QComboBox::activated), this,
            [this, key, list](int) { wish(key, list->currentText().toStdString()); });
    control.show = [list](const KnobValue& value) {
      if (!list->view()->isVisible()) list->setCurrentText(text(std::get<std::string>(value)));
    };
    control.show(knob.value);
    return list;
  }
  return numberFor(knob, control);
}

QWidget* KnobPanel::numberFor(const Knob& knob, Control& control) {
  constexpr int kNumberWidth = 76;  // [pixel]
  const std::string key = knob.key;
  const SliderScale scale(knob);
  const KnobValue kind = knob.value;
  auto* box = new QWidget;
  auto* row = new QHBoxLayout(box);
  row->setContentsMargins(0, 0, 0, 0);
  auto* slider = new QSlider(Qt::Horizontal);
  slider->setObjectName(text(key + " slider"));
  slider->setRange(0, SliderScale::kSteps);
  slider->setPageStep(SliderScale::kSteps / 20);
  slider->setTracking(false);  // one wish when it is let go
  auto* number = new QLineEdit;
  number->setObjectName(text(key));
  number->setFixedWidth(kNumberWidth);
  row->addWidget(slider, 1);
  row->addWidget(number);
  connect(slider, &QSlider::sliderMoved, this, [number, scale, kind](int step) {
    number->setText(text(sightline_ros::textOf(numberLike(kind, scale.valueOf(step)))));
  });
  connect(slider, &QSlider::valueChanged, this,
          [this, key, scale, kind](int step) { wish(key, numberLike(kind, scale.valueOf(step))); });
  connect(number, &QLineEdit::returnPressed, this, [this, key, kind, number] {
    bool is_number = false;
    const double typed = number->text().toDouble(&is_number);
    const bool is_whole = std::holds_alternative<int>(kind);
    if (!is_number || (is_whole && typed != std::round(typed)))
      words_->setText(QString("refused: %1 takes a %2number, got \"%3\"")
                          .arg(text(key), is_whole ? "whole " : "", number->text()));
    else
      wish(key, numberLike(kind, typed));
    number->clearFocus();
  });
  control.show = [slider, number, scale](const KnobValue& value) {
    if (!slider->isSliderDown()) {
      const QSignalBlocker silent(slider);
      slider->setValue(scale.stepOf(numberIn(value)));
    }
    if (!slider->isSliderDown() && !number->hasFocus()) number->setText(text(sightline_ros::textOf(value)));
  };
  control.show(knob.value);
  return box;
}

void KnobPanel::wish(const std::string& key, const KnobValue& value) {
  board_.wish(shown_, key, value);
  words_->setText(text(board_.words()));
}

}  // namespace sightline_rviz
