// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/core/diagnosis/model/effect.hpp"
#include "services/core/diagnosis/record/measurement.hpp"

namespace stillhand::diagnosis {

/// Signals by column, each as long as the measurement.
using Columns = std::vector<std::vector<double>>;

/// Quantity of a channel, by its unit.
enum class Quantity { kPosition, kRate, kAcceleration, kOther };

/// A channel that may explain something: measured, or made from a measured one.
struct Signal {
  std::string name;    ///< the channel's, or for example "rate of theta"
  std::string source;  ///< the measured channel
  std::string unit;
  Quantity quantity = Quantity::kOther;
  bool derived = false;
  std::vector<double> values;
  double mean = 0.0;
  double deviation = 0.0;  ///< standard deviation, same unit
};

/// A measurement as the engine sees it: inputs, output, and every channel that may explain
/// something.  A rate implies its position and a position its rate:
///
///   rate of x        central difference over two samples
///   position of v    trapezoidal sum within a stretch, from 0
///   rate of a        the same, then a high-pass of second order (Butterworth) at 0.1 Hz
///
/// unless a measured channel already is that signal (correlation above 0.95).
class Signals {
 public:
  /// @throws stillhand::ConfigError for a channel that is missing, an input that is the output, or
  /// a measurement that check() refuses.
  Signals(const Measurement& measurement, const std::vector<std::string>& inputs,
          const std::string& output);

  [[nodiscard]] std::size_t size() const noexcept { return output_.values.size(); }
  [[nodiscard]] double rate_hz() const noexcept { return rate_hz_; }
  [[nodiscard]] const std::vector<Stretch>& stretches() const noexcept { return stretches_; }
  /// The measurement's, and 0 in a stretch's first second (at most a tenth of it), where the
  /// unknown past has more effect than a fitted initial state describes.
  [[nodiscard]] const std::vector<double>& weight() const noexcept { return weight_; }
  /// The same signals with other weights, one a sample.
  [[nodiscard]] Signals weighed(std::vector<double> weight) const;
  /// The same signals, their output's errors judged behind a filter that makes the noise white, Eq.
  /// DG-61.  @param taps  c_0, c_1, ..; empty: as they are
  [[nodiscard]] Signals whitened(std::vector<double> taps) const;
  /// Filters columns of errors, or of what changes them, [samples x columns]; samples whose weight
  /// is 0 stay 0.
  void whiten(Eigen::Ref<Eigen::MatrixXd> columns, const std::vector<double>& weight) const;
  [[nodiscard]] bool is_whitened() const noexcept { return !whitening_.empty(); }
  /// The same signals for bodies that ring for long, Eq. DG-66.
  [[nodiscard]] Signals with_slow_poles() const;
  [[nodiscard]] bool slow_poles() const noexcept { return slow_poles_; }
  /// The same signals, slow free responses (Eq. DG-66) fitted to the rows with true alone.
  [[nodiscard]] Signals starting_by(std::vector<bool> rows) const;
  /// Empty: all rows.
  [[nodiscard]] const std::vector<bool>& start_rows() const noexcept { return start_rows_; }
  /// The same signals, a model over them in this state before a stretch, Eq. DG-82.
  /// @param states  one a sample [unit of the output]: e, that A y_b = B u has on its right; then,
  /// by effect, the same of a term with poles of its own, or nothing
  [[nodiscard]] Signals with_start(Columns states) const;
  [[nodiscard]] const Columns& start() const noexcept { return start_; }
  /// The same signals, a stretch beginning at each of these samples too.
  [[nodiscard]] Signals restarted(const std::vector<std::size_t>& at) const;
  /// These rows of the same signals, each of them a stretch.
  [[nodiscard]] Signals cut_to(const std::vector<Stretch>& pieces) const;
  /// The same signals, each stretch with a past of up to 10 s, Eq. DG-60: its own beginning in
  /// reverse, whose swing fades within 1 s to the level of Eq. DG-54.  It weighs nothing.  Times
  /// move on by the pasts, so that stretches don't overlap.
  [[nodiscard]] Signals with_pasts() const;
  /// Of a run over with_pasts(), one value a sample of these signals.
  [[nodiscard]] std::vector<double> without_pasts(const std::vector<double>& run) const;
  /// The same signals, one of them with other values.
  [[nodiscard]] Signals replaced(std::string_view name, std::vector<double> values) const;
  /// The same instants of another motion: every signal but the output with other values; means and
  /// deviations stay those of the measurement.
  [[nodiscard]] Signals moved(
      const std::function<std::vector<double>(const Signal& signal)>& values) const;
  /// The same signals, each held within its range; the inputs as the body sees them stay.
  [[nodiscard]] Signals within(const std::vector<SeenRange>& ranges) const;
  [[nodiscard]] const std::vector<double>& time_s() const noexcept { return time_s_; }
  /// [s] from the first to the last sample.
  [[nodiscard]] double duration_s() const noexcept { return time_s_.back() - time_s_.front(); }
  [[nodiscard]] const Signal& output() const noexcept { return output_; }
  [[nodiscard]] const std::vector<Signal>& inputs() const noexcept { return inputs_; }
  /// Inputs, other channels and what was made of them; never the output.
  [[nodiscard]] const std::vector<Signal>& all() const noexcept { return all_; }
  /// @throws stillhand::ConfigError when there is none of that name.
  [[nodiscard]] const Signal& at(std::string_view name) const;
  [[nodiscard]] bool is_input(std::string_view name) const noexcept;
  /// [Hz] below it lies a hundredth of the inputs' power, the one with the lowest counts.
  [[nodiscard]] double lowest_excited_hz() const noexcept { return lowest_excited_hz_; }
  /// [Hz] above it lies a hundredth of the inputs' power, the one with the highest counts.
  [[nodiscard]] double highest_excited_hz() const noexcept { return highest_excited_hz_; }
  /// The measured or derived signal that is the rate of this position, if any.
  [[nodiscard]] const Signal* rate_of(const Signal& position) const noexcept;

 private:
  void add_derived();
  void leave_starts_unjudged();
  void find_excited_band();
  [[nodiscard]] std::size_t past_of(const Stretch& stretch) const;

  double rate_hz_;
  std::vector<Stretch> stretches_;
  std::vector<double> weight_;
  std::vector<double> whitening_;
  std::vector<bool> start_rows_;
  Columns start_;  ///< empty: the steady start of Eq. DG-54
  std::vector<double> time_s_;
  Signal output_;
  std::vector<Signal> inputs_;
  std::vector<Signal> all_;
  double lowest_excited_hz_ = 0.0;
  double highest_excited_hz_ = 0.0;
  bool slow_poles_ = false;
};

/// Quantity of a unit: m, mm, cm, rad, deg are positions; with "/s" rates, with "/s^2"
/// accelerations.
Quantity quantity_of(std::string_view unit) noexcept;

/// A unit to a power, as a recording's header has it: "m^3", "(m/s^2)^2"; "-" of none.
std::string unit_power(const std::string& unit, int exponent);

}  // namespace stillhand::diagnosis
