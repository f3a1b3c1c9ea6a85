// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effects/delay.hpp"

#include <limits>

#include "diagnosis/core/interpolation.hpp"
#include "diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kEarliest_s = -0.1;  // the input's own sensor may be late, too
constexpr double kLatest_s = 0.5;
constexpr double kTried_s[] = {-0.02, 0.02, 0.04, 0.07, 0.12, 0.2};

class Delay final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "delay"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kInputTime; }
  [[nodiscard]] double input_delay_s(const Effect& effect, double /*time_s*/) const override {
    return effect.value(0);
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return "the output answers the input " + with_unit(1e3 * effect.value(0), "ms") +
           " later than poles and zeros of the body can give";
  }
};

std::vector<Proposal> Delay::proposed(const Screening& screening) const {
  const Body& body = screening.model().body;
  for (const Effect& effect : screening.model().effects) {
    if (effect.kind == name()) return {};
  }
  if (body.order() == 0) {
    return {{{"delay", "of the input", {}, {{"delay", "s", 0.02, kEarliest_s, kLatest_s}}, {}},
             0.0,
             {}}};
  }
  // A delay moves the poles: each trial starts from a body of its own.
  std::vector<Proposal> proposals;
  for (const double delay_s : kTried_s) {
    std::vector<std::vector<double>> inputs;
    for (const Signal& input : screening.signals().inputs()) {
      inputs.push_back(delayed(input.values, screening.signals(), [&](double) { return delay_s; }));
    }
    Proposal proposal{
        {"delay", "of the input", {}, {{"delay", "s", delay_s, kEarliest_s, kLatest_s}}, {}},
        0.0,
        started_body(inputs, screening.signals().output().values, screening.impulse_response(),
                     screening.signals(), static_cast<int>(body.order()))};
    Model model = screening.model();
    model.body = *proposal.body;
    model.effects.push_back(proposal.effect);
    FreeRun run;
    const double square = residual_of(model, screening.signals(), run).squaredNorm();
    proposal.gain = run.finite ? 1.0 - square / screening.residual().squaredNorm()
                               : -std::numeric_limits<double>::infinity();
    proposals.push_back(std::move(proposal));
  }
  // A delay's error has hollows a few samples apart: two starts.
  return best_of(std::move(proposals), 2);
}

}  // namespace

const EffectKind& delay_kind() {
  static const Delay kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis
