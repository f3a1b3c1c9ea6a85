// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::diagnosis {

/// Where in the model an effect acts, METHOD "The model", in the order of the signal's way.
enum class Stage {
  kInputTime,    ///< when the input reaches the body, Eq. DG-2
  kInputValue,   ///< a memoryless map of the input, Eq. DG-3
  kFeedback,     ///< a nonlinearity inside the body, Eq. DG-4
  kGain,         ///< a factor on the body's output, Eq. DG-5
  kTerm,         ///< a sum of terms next to the body or through it, Eq. DG-6
  kOutputValue,  ///< a memoryless map of the output, Eq. DG-7
  kWeight,       ///< samples that the model does not claim to explain
};

/// A number of an effect on which the prediction depends nonlinearly.
struct Parameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  double lower = 0.0;
  double upper = 0.0;
  bool fitted = true;  ///< false: found by search, held fixed in the joint fit
};

/// Where an effect was seen: the range of a signal that it reads, or of what its nonlinearity is
/// given.  It goes on as it is for a quarter of the range on each side, and is held there, METHOD
/// Eq. DG-56.
struct SeenRange {
  static constexpr double kWider = 0.25;  ///< [-] of the range

  std::string of;    ///< a signal, as Signals names it; "argument": of a map or a nonlinearity
  std::string unit;  ///< empty: none that can be named
  double low = 0.0;
  double high = 0.0;

  [[nodiscard]] bool holds(double value) const { return value >= low && value <= high; }
  [[nodiscard]] double lower_edge() const { return low - kWider * (high - low); }
  [[nodiscard]] double upper_edge() const { return high + kWider * (high - low); }
  [[nodiscard]] double held(double value) const {
    return std::clamp(value, lower_edge(), upper_edge());
  }
};

/// One effect of a model: plain numbers, to which its kind gives a meaning (effect_kind.hpp).
struct Effect {
  std::string kind;                   ///< name in effect_kinds(), for example "delay"
  std::string form;                   ///< which of the kind's forms, for example "through the body"
  std::vector<std::string> channels;  ///< signals that it reads, as Signals names them
  std::vector<Parameter> parameters;  ///< nonlinear ones
  std::vector<double> coefficients;   ///< linear ones, of the terms or of the feedback path
  std::vector<SeenRange> seen = {};   ///< empty: everywhere, as while it is fitted
  /// [-] 0 to 1, of its size, Eq. DG-68.  One that acts in part keeps its numbers in every fit.
  double share = 1.0;

  [[nodiscard]] bool is_whole() const noexcept { return share == 1.0; }
  [[nodiscard]] double value(std::size_t i) const { return parameters.at(i).value; }
};

/// The same kind, form and channels, whatever the numbers.
bool is_same(const Effect& one, const Effect& other) noexcept;

/// What an effect without a law draws: straight between its knots, level beyond them.
struct Curve {
  std::string of;         ///< what it is, for example "force"
  std::string over;       ///< for example a channel
  std::string over_unit;  ///< of the knots
  /// Unit by which the output's is divided; empty: by none.  A pure number has none of the two.
  std::string per;
  bool pure_number = false;
  std::vector<double> knots;  ///< ascending
  std::vector<double> heights;
  /// Place of each height among the numbers of the effect that are fitted (coefficients, then
  /// parameters); none: given.
  std::vector<std::optional<std::size_t>> fitted;
};

/// A number that is given, not fitted: the mean of a channel, from which it is counted.
Parameter constant(std::string name, std::string unit, double value);

/// Number of numbers that the data chose; none of an effect that acts in part.
std::size_t complexity(const Effect& effect) noexcept;

}  // namespace stillhand::diagnosis
