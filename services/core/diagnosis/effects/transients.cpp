// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kWindow_s = 0.2;
constexpr double kGuard_s = 0.15;  // on both sides of what stands out
// Of a window's mean square over the median window's.  White noise in 20 samples stays below 3 with
// probability 1 - 1e-6; a window's two largest samples don't count, so a heavy tail doesn't make a
// burst of a single sample.
constexpr double kStandsOut = 6.0;
constexpr double kLargestShare = 0.15;  // of the record: more isn't isolated
constexpr std::size_t kMostBursts = 20;
constexpr double kLeastEnergy = 0.35;  // of the residual's, or there is more to it than bursts
constexpr std::size_t kDiscarded = 2;
constexpr int kRounds = 2;
constexpr double kFewWindows = 0.04;  // of all
constexpr double kMuchEnergy = 0.25;  // of the residual's; of even noise they hold a tenth

struct Window {
  std::size_t first;
  std::size_t end;
};

std::vector<double> window_squares(const Eigen::VectorXd& residual,
                                   const std::vector<Window>& windows) {
  std::vector<double> squares;
  for (const Window& window : windows) {
    std::vector<double> each;
    for (std::size_t n = window.first; n < window.end; ++n) {
      each.push_back(std::pow(residual[static_cast<Eigen::Index>(n)], 2));
    }
    std::ranges::sort(each);
    if (each.size() > 2 * kDiscarded) each.resize(each.size() - kDiscarded);
    double sum = 0.0;
    for (const double square : each) sum += square;
    squares.push_back(sum / static_cast<double>(each.size()));
  }
  return squares;
}

/// Isolated bursts: the samples from the begin to the end of each have weight 0.
///
/// Source: METHOD Eq. DG-37.
class Transients final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "transients"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kWeight; }
  [[nodiscard]] bool time_only(const Effect& /*effect*/) const override { return true; }
  // Parameters: begin and end of every burst.
  void weigh(const Effect& effect, const Signals& signals,
             std::span<double> weight) const override {
    for (std::size_t i = 0; i + 1 < effect.parameters.size(); i += 2) {
      for (std::size_t n = 0; n < weight.size(); ++n) {
        const double t_s = signals.time_s()[n];
        if (t_s >= effect.value(i) && t_s < effect.value(i + 1)) weight[n] = 0.0;
      }
    }
  }
  [[nodiscard]] ControlRole body_role(const Effect& /*effect*/) const override {
    return control::LeftOut{"nothing predicts when a burst comes"};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    std::string text = std::to_string(effect.parameters.size() / 2) + " isolated burst(s), from";
    for (std::size_t i = 0; i + 1 < effect.parameters.size() && i < 10; i += 2) {
      text += (i == 0 ? " " : ", ") + with_unit(effect.value(i), "s");
    }
    return text + "; the errors are of the rest of the record";
  }
};

struct Bursts {
  Effect effect{"transients", "isolated bursts", {}, {}, {}};
  double claimed_s = 0.0;
  double energy = 0.0;  // of the windows' squares
};

// Windows above a square, with their guards, as one effect.
Bursts bursts_above(double least, const std::vector<Window>& windows,
                    const std::vector<double>& squares, const Signals& signals) {
  Bursts bursts;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    if (squares[w] < least) continue;
    bursts.energy += squares[w];
    const double from_s = signals.time_s()[windows[w].first] - kGuard_s;
    const double to_s = signals.time_s()[windows[w].end - 1] + kGuard_s;
    auto& all = bursts.effect.parameters;
    if (!all.empty() && from_s <= all.back().value) {
      bursts.claimed_s += to_s - all.back().value;
      all.back().value = to_s;
      continue;
    }
    bursts.claimed_s += to_s - from_s;
    const std::string number = std::to_string(all.size() / 2 + 1);
    const double begin_s = signals.time_s().front() - kGuard_s;
    const double end_s = signals.time_s().back() + kGuard_s;
    all.push_back({"begin_" + number, "s", from_s, begin_s, end_s, false});
    all.push_back({"end_" + number, "s", to_s, begin_s, end_s, false});
  }
  return bursts;
}

// A body fitted without the bursts: one fitted to them as well may be far off.
std::optional<Body> body_without(const Bursts& bursts, const Screening& screening) {
  constexpr int kIterations = 10;
  const Signals& signals = screening.signals();
  Model model = screening.model();
  std::vector<double> left = signals.output().values;
  std::vector<std::vector<double>> inputs;
  if (model.body.order() == 0 || !without_effects(model, signals, inputs, left)) return {};
  std::vector<double> weight = signals.weight();
  transients_kind().weigh(bursts.effect, signals, weight);
  const Signals masked = signals.weighed(std::move(weight));
  const auto order = static_cast<int>(model.body.order());
  model.body = started_body(inputs, left, {}, masked, order);
  if (order == 4) model.body = with_other_mode(model.body, inputs, left, masked);
  FitOptions options;
  options.max_iterations = kIterations;
  fit(model, masked, screening.blocks(), options);
  return model.body;
}

std::vector<Proposal> Transients::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  for (const Effect& effect : screening.model().effects) {
    if (effect.kind == name()) return {};
  }
  const auto length =
      std::max<std::size_t>(5, static_cast<std::size_t>(kWindow_s * signals.rate_hz()));
  std::vector<Window> windows;
  for (const Stretch& stretch : signals.stretches()) {
    for (std::size_t n = stretch.first; n + length <= stretch.end; n += length / 2) {
      windows.push_back({n, n + length});
    }
  }
  if (windows.size() < 20) return {};
  std::vector<double> squares = window_squares(screening.residual(), windows);
  std::vector<Proposal> proposals;
  const auto propose = [&](const std::optional<Body>& body) {
    Bursts bursts = bursts_above(kStandsOut * quantile_of(squares, 0.5), windows, squares, signals);
    const std::size_t count = bursts.effect.parameters.size() / 2;
    const double share = bursts.energy / sum_of(squares);
    if (count == 0 || count > kMostBursts || share < kLeastEnergy ||
        bursts.claimed_s > kLargestShare * signals.duration_s()) {
      return;
    }
    proposals.push_back({std::move(bursts.effect), share, body});
  };
  propose({});
  // Bursts bias the fit that must reveal them.  Where few windows hold much energy, they are left
  // out and the rest is fitted again.
  std::optional<Body> body;
  for (int round = 0; round < kRounds; ++round) {
    const Bursts strongest =
        bursts_above(quantile_of(squares, 1.0 - kFewWindows), windows, squares, signals);
    if (strongest.energy < kMuchEnergy * sum_of(squares)) break;
    body = body_without(strongest, screening);
    if (!body) break;
    Model model = screening.model();
    model.body = *body;
    FreeRun run;
    squares = window_squares(residual_of(model, signals, run), windows);
  }
  if (body) propose(body);
  return proposals;
}

}  // namespace

const EffectKind& transients_kind() {
  static const Transients kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis
