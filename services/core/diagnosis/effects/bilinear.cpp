// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <complex>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kLargestPerDeviation =
    10.0;  // [-] of the gain, per standard deviation of the channel

/// A product of two channels, or a gain that follows a channel:
///
///   c (x_1 - m_1)(x_2 - m_2);  g = 1 + s (x - m) on the body's output
///
/// Source: METHOD Eq. DG-36.
class Bilinear final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "bilinear"; }
  [[nodiscard]] Stage stage(const Effect& effect) const override {
    return effect.form == "gain of the body" ? Stage::kGain : Stage::kTerm;
  }
  void gain(const Effect& effect, const Signals& signals, std::span<double> gain) const override {
    const Signal& signal = signals.at(effect.channels.at(0));
    for (std::size_t n = 0; n < gain.size(); ++n) {
      gain[n] *= 1.0 + effect.value(0) * (signal.values[n] - effect.value(1));
    }
  }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const Signal& left = signals.at(effect.channels.at(0));
    const Signal& right = signals.at(effect.channels.at(1));
    std::vector<double> product(signals.size());
    for (std::size_t n = 0; n < product.size(); ++n) {
      product[n] = (left.values[n] - effect.value(0)) * (right.values[n] - effect.value(1));
    }
    columns.push_back(std::move(product));
  }
  [[nodiscard]] std::string column_unit(const Effect& effect, const Signals& signals,
                                        std::size_t /*i*/) const override {
    return signals.at(effect.channels.at(0)).unit + "*" + signals.at(effect.channels.at(1)).unit;
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    const Effect& effect = at.effect();
    const auto deviation = [&](std::size_t i) {
      return at.signals.at(effect.channels.at(i)).deviation;
    };
    if (stage(effect) == Stage::kGain) {
      return {{"gain_change", "-", effect.value(0) * deviation(0),
               "over one standard deviation of " + effect.channels.at(0)}};
    }
    const double factor =
        through_body(effect) ? through_body_at(at, 0.0).real() : effect.coefficients.at(0);
    return {{"force", at.model.output_unit, factor * deviation(0) * deviation(1),
             std::string("where both are one standard deviation above their means") +
                 (through_body(effect) ? ", at 0 Hz behind the body" : "")}};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    if (stage(effect) == Stage::kGain) return "the body's gain follows " + effect.channels.at(0);
    return "the residual follows the product of " + effect.channels.at(0) + " and " +
           effect.channels.at(1) + ", " + effect.form;
  }
};

std::vector<Proposal> Bilinear::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  std::vector<Proposal> gains;
  std::vector<Proposal> products;
  std::vector<const Signal*> measured;
  for (const Signal& signal : signals.all()) {
    if (!signal.derived) measured.push_back(&signal);
  }
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const Signal& signal = *measured[i];
    if (!signals.is_input(signal.name)) {
      std::vector<double> column = screening.body_output();
      for (std::size_t n = 0; n < column.size(); ++n) {
        column[n] *= signal.values[n] - signal.mean;
      }
      const ScreenedGain found = screening.gain({column});
      const double bound = kLargestPerDeviation / signal.deviation;
      gains.push_back({{"bilinear",
                        "gain of the body",
                        {signal.name},
                        {{"sensitivity", "1/(" + signal.unit + ")",
                          std::clamp(found.coefficients[0], -bound, bound), -bound, bound},
                         constant("centre", signal.unit, signal.mean)},
                        {}},
                       found.share,
                       {}});
    }
    for (std::size_t j = i + 1; j < measured.size(); ++j) {
      const Signal& other = *measured[j];
      for (const char* form : {"beside the body", "through the body"}) {
        if (screening.model().body.order() == 0 && form[0] == 't') continue;
        products.push_back(
            screening.with_coefficients({"bilinear",
                                         form,
                                         {signal.name, other.name},
                                         {constant("centre_1", signal.unit, signal.mean),
                                          constant("centre_2", other.unit, other.mean)},
                                         {}}));
      }
    }
  }
  std::vector<Proposal> all = best_of(std::move(products), 2);
  append(all, best_of(std::move(gains), 1));
  return all;
}

}  // namespace

const EffectKind& bilinear_kind() {
  static const Bilinear kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis
