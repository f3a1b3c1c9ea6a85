// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/axis_layout.hpp"

#include <algorithm>
#include <cmath>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report {
namespace {

// Room for one tick label and its neighbour's distance [px].
constexpr double kVerticalPitch_px = 36.0;
constexpr double kHorizontalPitch_px = 40.0;  // labels are measured too
constexpr double kLabelGap_px = 14.0;
constexpr double kMinorDecade_px = 60.0;  // a decade shorter than this has no lines at 2 to 9
constexpr double kMostTicks = 60.0;       // a step below span/60 is taken as a mistake

constexpr double kDenseEnough = 10.0;

double most_ticks(double length_px, bool horizontal) {
  const double pitch_px = horizontal ? kHorizontalPitch_px : kVerticalPitch_px;
  return std::clamp(std::floor(length_px / pitch_px), 2.0, kDenseEnough);
}

// Smallest of 1, 2, 5 times a power of ten that is at least `least`.
double nice_step(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

double degree_step(double least_deg) {
  for (const double step_deg : {15.0, 45.0, 90.0, 180.0, 360.0}) {
    if (step_deg >= least_deg * (1.0 - 1e-9)) return step_deg;
  }
  return 360.0 * std::ceil(least_deg / 360.0);
}

double automatic_step(const Axis& axis, double span, double ticks) {
  if (axis.tick_step && *axis.tick_step > 0.0 && span / *axis.tick_step <= kMostTicks) {
    return *axis.tick_step;
  }
  return axis.scale == Scale::kDegrees ? degree_step(span / ticks) : nice_step(span / ticks);
}

// Decimals that distinguish neighbouring ticks.
int decimals_of(double step) {
  const int decimals = static_cast<int>(std::ceil(-std::log10(step) - 1e-9));
  const bool needs_more = std::abs(step * std::pow(10.0, decimals) -
                                   std::round(step * std::pow(10.0, decimals))) > 1e-6;
  return std::max(0, needs_more ? decimals + 1 : decimals);
}

std::string tick_label(double value, double step) {
  const double size = std::abs(value);
  if (size < step * 1e-6) return "0";
  return size >= 1e6 || step < 1e-4 ? short_number(value) : number(value, decimals_of(step));
}

std::vector<AxisTick> linear_ticks(double low, double high, double step) {
  std::vector<AxisTick> ticks;
  const auto first = static_cast<long>(std::ceil(low / step - 1e-9));
  const auto last = static_cast<long>(std::floor(high / step + 1e-9));
  for (long i = first; i <= last; ++i) {
    const double at = static_cast<double>(i) * step;
    ticks.push_back({at, tick_label(at, step)});
  }
  return ticks;
}

double widest_label_px(const std::vector<AxisTick>& ticks, double font_size_px) {
  double widest_px = 0.0;
  for (const AxisTick& tick : ticks) {
    widest_px = std::max(widest_px, text_width_px(tick.label, font_size_px));
  }
  return widest_px;
}

void add_linear_ticks(AxisLayout& layout, const Axis& axis, double length_px, bool horizontal,
                      double font_size_px) {
  const double span = layout.high - layout.low;
  double step = automatic_step(axis, span, most_ticks(length_px, horizontal));
  layout.major = linear_ticks(layout.low, layout.high, step);
  while (horizontal && !axis.tick_step && layout.major.size() > 2 &&
         widest_label_px(layout.major, font_size_px) + kLabelGap_px > step / span * length_px) {
    step = axis.scale == Scale::kDegrees ? degree_step(step * 1.5) : nice_step(step * 1.5);
    layout.major = linear_ticks(layout.low, layout.high, step);
  }
}

// Ticks at `factors` times every `every`-th power of ten; ticks in between are minor.
void add_decade_ticks(AxisLayout& layout, double length_px, bool horizontal) {
  const double decades = std::log10(layout.high / layout.low);
  const double pitch_px = horizontal ? 40.0 : 24.0;  // labels such as "0.2" or "10⁻⁵"
  const bool one_two_five = length_px / decades * std::log10(2.0) >= pitch_px * 0.75;
  // All labels of an axis are of one kind.
  const bool powers = layout.low < 0.9e-3 || layout.high > 1.1e5;
  const int every = std::max(1, static_cast<int>(std::ceil(pitch_px * decades / length_px)));
  const int first = static_cast<int>(std::floor(std::log10(layout.low) - 1e-9));
  const int last = static_cast<int>(std::ceil(std::log10(layout.high) + 1e-9));
  for (int power = first; power <= last; ++power) {
    for (int factor = 1; factor <= 9; ++factor) {
      const double at =
          power < 0 ? factor / std::pow(10.0, -power) : factor * std::pow(10.0, power);
      if (at < layout.low * (1.0 - 1e-9) || at > layout.high * (1.0 + 1e-9)) continue;
      const bool major =
          factor == 1 ? power % every == 0 : one_two_five && (factor == 2 || factor == 5);
      if (major) {
        layout.major.push_back({at, powers ? power_of_ten(factor, power) : short_number(at)});
      } else if (length_px / decades >= kMinorDecade_px || factor == 1) {
        layout.minor.push_back(at);
      }
    }
  }
}

// Positive, finite, and different: a single value gets a neighbourhood.
void open_up(AxisLayout& layout) {
  if (layout.logarithmic) {
    if (!(layout.low > 0.0)) layout.low = layout.high > 0.0 ? layout.high / 1e3 : 0.1;
    if (!(layout.high > layout.low)) {
      layout.high = layout.low * 2.0;
      layout.low /= 2.0;
    }
    return;
  }
  const double centre = 0.5 * (layout.low + layout.high);
  // Below this spread the plot would show the rounding of the numbers.
  const double least = std::max(std::abs(centre) * 1e-9, 1e-300);
  if (!(layout.high - layout.low > least)) {
    const double half = centre == 0.0 ? 1.0 : std::abs(centre) * 0.1;
    layout.low = centre - half;
    layout.high = centre + half;
  }
}

void leave_room(AxisLayout& layout, const Axis& axis, const Extent& extent, bool tight) {
  // A phase axis ends at the next multiple of its step anyway.
  const double untight = axis.scale == Scale::kDegrees ? 0.02 : 0.06;
  const double share = tight ? (extent.marks ? 0.03 : 0.0) : untight;
  double room_low = share;
  if (extent.from_zero && layout.low == 0.0) room_low = 0.0;
  const double room_high = extent.from_zero && layout.high == 0.0 ? 0.0 : share;
  if (layout.logarithmic) {
    const double ratio = layout.high / layout.low;
    if (!axis.low) layout.low /= std::pow(ratio, room_low);
    if (!axis.high) layout.high *= std::pow(ratio, room_high);
    return;
  }
  const double span = layout.high - layout.low;
  if (!axis.low) layout.low -= span * room_low;
  if (!axis.high) layout.high += span * room_high;
}

}  // namespace

double AxisLayout::fraction(double value) const {
  return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

bool AxisLayout::drawable(double value) const {
  return std::abs(value) <= kLargestValue && (!logarithmic || value > 0.0);
}

AxisLayout lay_out_axis(const Axis& axis, const Extent& extent, double length_px, bool horizontal,
                        bool tight, double font_size_px) {
  AxisLayout layout;
  layout.logarithmic = axis.scale == Scale::kLogarithmic;
  if (!extent.empty()) {
    layout.low = extent.low;
    layout.high = extent.high;
  } else if (layout.logarithmic) {
    layout.low = 0.1;
    layout.high = 10.0;
  }
  if (axis.low && layout.drawable(*axis.low)) layout.low = *axis.low;
  if (axis.high && layout.drawable(*axis.high)) layout.high = *axis.high;
  open_up(layout);
  leave_room(layout, axis, extent, tight);
  if (axis.scale == Scale::kDegrees) {
    const double step_deg =
        automatic_step(axis, layout.high - layout.low, most_ticks(length_px, horizontal));
    if (!axis.low) layout.low = step_deg * std::floor(layout.low / step_deg);
    if (!axis.high) layout.high = step_deg * std::ceil(layout.high / step_deg);
  }
  if (!axis.ticks.empty()) {
    for (AxisTick tick : axis.ticks) {
      if (!layout.drawable(tick.at) || tick.at < layout.low || tick.at > layout.high) continue;
      layout.categories = layout.categories || !tick.label.empty();
      if (tick.label.empty()) tick.label = short_number(tick.at);
      layout.major.push_back(tick);
    }
    return layout;
  }
  if (layout.logarithmic) {
    add_decade_ticks(layout, length_px, horizontal);
    if (layout.major.size() >= 2) return layout;
    layout.minor.clear();  // less than a decade: even steps are clearer
  }
  add_linear_ticks(layout, axis, length_px, horizontal, font_size_px);
  return layout;
}

}  // namespace stillhand::report
