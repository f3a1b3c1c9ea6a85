// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/loop_proposals.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/loop_sizes.hpp"

namespace stillhand::diagnosis {
namespace {

double cube(double z) { return z * z * z; }
double cubic(double z, LoopMemory& /*memory*/) { return cube(z); }

// Cubic for small, linear for large z: hardening and softening springs that don't run away.
double bent(double z, LoopMemory& /*memory*/) { return cube(z) / (1.0 + z * z); }

// Cubic for small z; what a spring loses whose force levels off.
// z - tanh z; by one exponential, which takes half the time of std::tanh.
double levelled(double z, LoopMemory& /*memory*/) {
  return z - 1.0 + 2.0 / (std::exp(2.0 * z) + 1.0);
}

/// A hardening or softening spring, an odd function of a displacement z in units of a threshold:
///
///   feedback of z^3, z^3/(1 + z^2) or z - tanh z inside the body;  y + k y^3 of the output;
///   c_1 (x - m) + c_2 (x - m)^3 of a position
///
/// Source: METHOD Eq. DG-24; cubic stiffness: Worden and Tomlinson (2001).
class NonlinearStiffness final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "nonlinear_stiffness"; }
  [[nodiscard]] Stage stage(const Effect& effect) const override {
    if (effect.form == "at the output") return Stage::kOutputValue;
    return effect.channels.empty() ? Stage::kFeedback : Stage::kTerm;
  }
  // y + kappa y^3 while it rises, then level.
  [[nodiscard]] double mapped(const Effect& effect, double y) const override {
    const double kappa = effect.value(0);
    if (rises(kappa, y)) return y + kappa * cube(y);
    const double end = std::copysign(1.0 / std::sqrt(-3.0 * kappa), y);
    return end + kappa * cube(end);
  }
  [[nodiscard]] double slope(const Effect& effect, double y) const override {
    const double kappa = effect.value(0);
    return rises(kappa, y) ? 1.0 + 3.0 * kappa * y * y : 0.0;
  }
  [[nodiscard]] Nonlinearity feedback(const Effect& effect) const override {
    if (effect.form.starts_with("cubic")) return {cubic, threshold_of(effect)};
    return {effect.form.starts_with("levelled") ? levelled : bent, threshold_of(effect)};
  }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const Signal& position = signals.at(effect.channels.at(0));
    std::vector<double> linear(signals.size());
    std::vector<double> cubic(signals.size());
    for (std::size_t n = 0; n < linear.size(); ++n) {
      linear[n] = position.values[n] - effect.value(0);
      cubic[n] = cube(linear[n]);
    }
    columns.push_back(std::move(linear));
    columns.push_back(std::move(cubic));
  }
  [[nodiscard]] std::string column_unit(const Effect& effect, const Signals& signals,
                                        std::size_t i) const override {
    const std::string& unit = signals.at(effect.channels.at(0)).unit;
    return i == 0 ? unit : unit_power(unit, 3);
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override;
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    if (!effect.channels.empty()) {
      return "the residual has a cubic part in " + effect.channels.front();
    }
    return "the stiffness changes with the amplitude, the same way to both sides: a spring, " +
           effect.form;
  }

 private:
  static bool rises(double kappa, double y) { return 3.0 * kappa * y * y > -1.0; }
};

// d phi / d z
double slope_of(const Effect& effect, double z) {
  if (effect.form.starts_with("cubic")) return 3.0 * z * z;
  if (effect.form.starts_with("levelled")) return std::pow(std::tanh(z), 2);
  return z * z * (3.0 + z * z) / std::pow(1.0 + z * z, 2);
}

std::vector<Size> NonlinearStiffness::sizes(const SizeCase& at) const {
  const Effect& effect = at.effect();
  const std::string& force = at.model.output_unit;
  if (stage(effect) == Stage::kTerm) {
    const Signal& position = at.signals.at(effect.channels.at(0));
    const double x = largest_deflection(position.values, effect.value(0), at.signals);
    const std::string where = "at " + with_unit(x, position.unit) + ", the largest deflection seen";
    const std::string unit = unit_over(force, position.unit);
    const double c1 = effect.coefficients.at(0);
    const double c3 = effect.coefficients.at(1);
    return {{"stiffness", unit, c1, "at the centre"},
            {"stiffness_at_largest", unit, c1 + 3.0 * c3 * x * x, where},
            {"cubic_force", force, c3 * cube(x), where}};
  }
  if (stage(effect) == Stage::kOutputValue) {
    const double y = largest_deflection(at.signals.output().values, 0.0, at.signals);
    const std::string where = "at " + with_unit(y, force) + ", the largest output seen";
    return {{"stiffness_ratio", "-", 1.0 + 3.0 * effect.value(0) * y * y,
             where + ", over that at rest"},
            {"cubic_force", force, effect.value(0) * cube(y), where}};
  }
  std::vector<Size> sizes{stiffness_ratio(at, slope_of(effect, largest_argument(at)), 0.0,
                                          "at the largest motion seen, over that at rest")};
  if (!effect.form.starts_with("cubic")) {
    sizes.push_back(force_at_threshold(at, "threshold_force", 1.0,
                                       "amplitude of the output from which the spring bends"));
  }
  return sizes;
}

std::vector<Proposal> NonlinearStiffness::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  std::vector<Proposal> proposals =
      loop_proposals(screening, "nonlinear_stiffness", "bent", bent, false);
  append(proposals, loop_proposals(screening, "nonlinear_stiffness", "levelled", levelled, false));
  append(proposals, loop_proposals(screening, "nonlinear_stiffness", "cubic", cubic, true));
  const double square = std::pow(deviation_of(screening.prediction()), 2);
  const double limit = 0.3 / square;
  const ScreenedGain of_cube = [&] {
    std::vector<double> column = screening.prediction();
    for (double& y : column) y = cube(y);
    return screening.gain({column});
  }();
  proposals.push_back(
      {{"nonlinear_stiffness",
        "at the output",
        {},
        {{"cubic", "1/" + signals.output().unit + "^2",
          std::clamp(of_cube.coefficients[0], -0.3 * limit, 0.3 * limit), -limit, limit}},
        {}},
       of_cube.share,
       {}});
  std::vector<Proposal> of_channels;
  for (const Signal& signal : signals.all()) {
    if (signal.quantity != Quantity::kPosition || signal.derived) continue;
    of_channels.push_back(
        screening.with_coefficients({"nonlinear_stiffness",
                                     "cubic, beside the body",
                                     {signal.name},
                                     {constant("centre", signal.unit, signal.mean)},
                                     {}}));
  }
  append(proposals, best_of(std::move(of_channels), 1));
  return proposals;
}

}  // namespace

const EffectKind& nonlinear_stiffness_kind() {
  static const NonlinearStiffness kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis
