// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "apps/libraries/session/core/trial_forces.hpp"
#include "services/core/identification/tracking_metrics.hpp"

/// The table of the numbers of a tracking trial.  summary.json, printed table, CSV and page of lab,
/// study, close-the-loop and compare, and the exports of an experiment, read it; a new number is a
/// new row, and a field in what computes it.
namespace stillhand::session {

/// What a tracking trial gives, whatever ran it.  NaN: not known.
struct TrialNumbers {
  identification::TrackingMetrics metrics;
  TrialForces forces;
  /// Share of the feedthrough force that the motor cancelled, by the rig's truth, Eq. SN-1.
  double cancelled_share = std::numeric_limits<double>::quiet_NaN();
  /// How late the motor's force opposes f', Eq. SN-2.
  double counterforce_delay_s = std::numeric_limits<double>::quiet_NaN();
};

/// Where a number stands in TrialNumbers.
struct Place {
  double identification::TrackingMetrics::* metric = nullptr;
  double TrialForces::* force = nullptr;
  double TrialNumbers::* own = nullptr;

  constexpr Place() = default;
  constexpr Place(double identification::TrackingMetrics::* at) : metric(at) {}
  constexpr Place(double TrialForces::* at) : force(at) {}
  constexpr Place(double TrialNumbers::* at) : own(at) {}
  constexpr auto& in(auto& numbers) const {
    return metric != nullptr  ? numbers.metrics.*metric
           : force != nullptr ? numbers.forces.*force
                              : numbers.*own;
  }
};

/// Who gives a number; flags.
enum In : unsigned {
  kLab = 1,
  kStudy = 2,
  kLoop = 4,
  kCsv = 8,      ///< of the study
  kExport = 16,  ///< of an experiment; a number of TrackingMetrics
  kEverywhere = 31,
};

/// Of a condition in summary.json of lab and loop; the study always has a sample.
enum class Shape {
  kSample,  ///< mean, std, per_subject; each summary has it, and so do printed table and page
  kMean,    ///< mean
  kPlain,   ///< the number itself
};

/// What stands where the motor does not act.
enum class Still {
  kGiven,
  kNull,  ///< in lab and loop; the study leaves it out
  kLeftOut,
};

/// The paper's Tables I and II, means of 12 subjects.
struct Paper {
  double a = 0.0, b = 0.0, c = 0.0;
  double restored_percent = 0.0;  ///< (B - C) / (B - A)
  double p_ab = 1.0, p_bc = 1.0;  ///< of the paired t-tests, 11 degrees of freedom
  double unit = 1.0;              ///< of a to c, in the unit of the title

  /// Of A, B and C, in the unit of the title.
  [[nodiscard]] constexpr std::array<double, 3> means() const noexcept {
    return {unit * a, unit * b, unit * c};
  }
};

/// Assumed size of a unit of the paper's RMS error [mm]; apps/study/METHOD.md, "The paper's unit".
inline constexpr double kPaperUnit_mm = 5.5;
inline constexpr std::array kPaper{Paper{4.04, 9.62, 7.01, 47.0, 1.79e-9, 4.05e-6, kPaperUnit_mm},
                                   Paper{0.48, 0.23, 0.31, 32.0, 1.5e-12, 4.07e-5},
                                   Paper{0.25, 0.10, 0.14, 27.0, 5.67e-7, 0.0047}};

/// One number of a tracking trial.
struct Number {
  const char* key;    ///< in summary.json
  const char* title;  ///< of a row or an axis, with its unit
  Place place;
  unsigned in = kEverywhere;
  Shape shape = Shape::kSample;
  Still still = Still::kGiven;
  int decimals = 2;          ///< of a mean over people; one trial, or a difference, has one more
  double scale = 1.0;        ///< from the place's unit to the title's
  const char* column = "";   ///< title in a CSV; empty: the same
  const char* name = "";     ///< in "restoration" and exports: without a unit
  const char* meaning = "";  ///< for the reader of an export
  const char* judged = "";   ///< in the sentences of `compare`; empty: it does not judge it
  bool lower_is_better = false;
  const Paper* paper = nullptr;  ///< nullptr: it does not have this number

  [[nodiscard]] constexpr double of(const TrialNumbers& numbers) const {
    return scale * place.in(numbers);
  }
  [[nodiscard]] constexpr const char* header() const { return *column != 0 ? column : title; }
  [[nodiscard]] constexpr bool is_judged() const { return *judged != 0; }
  /// Only what the motion makes worse can be restored.
  [[nodiscard]] constexpr bool worse(double from, double to) const {
    return lower_is_better ? to > from : to < from;
  }
  /// "mm"; "-" of a ratio.
  [[nodiscard]] constexpr std::string_view unit() const {
    const std::string_view text = title;
    return text.substr(text.find('[') + 1, text.size() - text.find('[') - 2);
  }
};

/// The paper's three metrics come first.
inline constexpr auto kNumbers = [] {
  using Metrics = identification::TrackingMetrics;
  using enum Shape;
  using enum Still;
  return std::to_array<Number>({
      {"rms_error_mm", "RMS error [mm]", &Metrics::rms_error_mm, kEverywhere, kSample, kGiven, 1,
       1.0, "rms error [mm]", "rms_error", "Root mean square of target minus cursor",
       "tracking error", true, &kPaper[0]},
      {"dwell_ratio", "dwell ratio [-]", &Metrics::dwell_ratio, kEverywhere, kSample, kGiven, 2,
       1.0, "", "dwell_ratio", "Share of the time with the cursor inside the target box",
       "dwell ratio", false, &kPaper[1]},
      {"crossover_hz", "crossover f_c [Hz]", &Metrics::crossover_hz, kEverywhere, kSample, kGiven,
       2, 1.0, "crossover [Hz]", "crossover",
       "Crossover frequency of the open loop, from the line of -20 dB a decade through its lowest "
       "eleven points",
       "crossover frequency", false, &kPaper[2]},
      {"force_left_n", "force left [N]", &TrialForces::left_n, kLoop, kMean},
      {"hand_acceleration_m_s2", "hand's acceleration [m/s²]", &TrialForces::acceleration_m_s2,
       kLoop, kMean},
      {"motor_force_n", "motor's force [N]", &TrialForces::motor_n, kLoop, kMean},
      {"volitional_force_n", "subject's force [N]", &TrialForces::volitional_n, kLoop, kMean},
      {"crossover_reference_hz", "crossover by the reference [Hz]",
       &Metrics::crossover_reference_hz, kEverywhere, kPlain, kGiven, 2, 1.0,
       "crossover through reference [Hz]", "crossover_reference",
       "Crossover frequency through the target, the remnant taken off"},
      {"cancelled_share", "feedthrough force cancelled [-]", &TrialNumbers::cancelled_share,
       kLab | kStudy | kLoop | kCsv, kPlain, kNull, 2, 1.0, "cancelled share [-]"},
      {"counterforce_delay_ms", "delay of the counterforce [ms]",
       &TrialNumbers::counterforce_delay_s, kLab | kLoop, kPlain, kLeftOut, 0, 1e3},
      {"counterforce_delay_s", "delay of the counterforce [s]", &TrialNumbers::counterforce_delay_s,
       kStudy, kPlain, kLeftOut, 3},
  });
}();

/// Of the paper's tables: what is tested, and of which a share is restored.
inline constexpr std::span<const Number, 3> kMetrics = std::span(kNumbers).first<3>();

// Not std::views::filter: clang 14 (clang-tidy) does not compile that of GCC 12.
inline std::vector<Number> numbers_if(auto wanted) {
  std::vector<Number> out;
  std::ranges::copy_if(kNumbers, std::back_inserter(out), wanted);
  return out;
}
/// Those that one of In gives.
inline std::vector<Number> numbers(unsigned in) {
  return numbers_if([in](const Number& each) { return (each.in & in) != 0; });
}
/// Those of printed tables and pages.
inline std::vector<Number> samples() {
  return numbers_if([](const Number& each) { return each.shape == Shape::kSample; });
}
/// In kNumbers, by its key in summary.json.
consteval std::size_t index_of(std::string_view key) {
  return static_cast<std::size_t>(&*std::ranges::find(kNumbers, key, [](const Number& each) {
    return std::string_view(each.key);
  }) - kNumbers.data());
}

}  // namespace stillhand::session
