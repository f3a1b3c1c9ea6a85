// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/detection.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>

#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/signal/moments.hpp"
#include "services/core/statistics/multiple_testing.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kLags_s[] = {0.0, 0.05, 0.1, 0.2, 0.4, 0.8};
constexpr int kGainCosines = 8;

std::vector<double> mapped(const std::vector<double>& x, const std::function<double(double)>& f) {
  std::vector<double> y(x.size());
  std::ranges::transform(x, y.begin(), f);
  return y;
}

// Questions gathered with their answers.
class Questions {
 public:
  explicit Questions(const Screening& screening)
      : screening_(screening),
        gains_(screening.jacobian(), screening.residual(), screening.weight(), screening.blocks()),
        by_chance_(Eigen::ArrayXd::Zero(kSurrogates)) {}

  void ask(const std::string& question, const std::string& about,
           const std::vector<std::string>& channels, const Columns& columns) {
    const SurrogateShares shares = gains_.shares(screening_.as_added(columns));
    answers_.push_back({question, about, shares.own, 1.0, false, channels});
    by_chance_ = by_chance_.max(shares.surrogates);
  }
  void add(const std::string& about, const LineGroup& lines) {
    if (!lines.empty()) lines_.push_back({kDistortion, about, lines.share, lines.p, false, {}});
  }

  [[nodiscard]] std::vector<Detection> answers() const {
    std::vector<Detection> all = answers_;
    for (Detection& each : all) each.p = surrogate_p(each.share, by_chance_);
    std::vector<double> p;
    std::ranges::transform(lines_, std::back_inserter(p), &Detection::p);
    const std::vector<double> corrected = statistics::holm_adjusted(p);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      all.push_back(lines_[i]);
      all.back().p = corrected[i];
    }
    for (Detection& each : all) {
      each.found = each.share > kLeastShare && each.p <= kSignificance;
    }
    std::ranges::stable_sort(all, std::ranges::greater(), &Detection::share);
    return all;
  }

 private:
  const Screening& screening_;
  const SurrogateGains gains_;
  Eigen::ArrayXd by_chance_;  ///< largest share of any question, of each surrogate
  std::vector<Detection> answers_;
  std::vector<Detection> lines_;  ///< with a test of their own
};

void ask_about_signals(const Screening& screening, Questions& questions) {
  const Signals& signals = screening.signals();
  std::vector<const Signal*> measured;
  for (const Signal& signal : signals.all()) {
    if (!signal.derived) measured.push_back(&signal);
  }
  const auto scaled = [](const Signal& signal, double power) {
    return mapped(signal.values, [&](double x) {
      const double z = (x - signal.mean) / signal.deviation;
      return power == 2.0 ? z * z : z * z * z;
    });
  };
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const Signal& signal = *measured[i];
    Columns lags;
    for (const double lag_s : kLags_s) {
      lags.push_back(lagged(signal.values,
                            static_cast<std::size_t>(std::lround(lag_s * signals.rate_hz())),
                            signals.stretches()));
    }
    const std::vector<std::string> own{signal.name};
    questions.ask("linear in", signal.name, own, lags);
    questions.ask("square of", signal.name, own, {scaled(signal, 2.0)});
    questions.ask("cube of", signal.name, own, {scaled(signal, 3.0)});
    std::vector<double> product = screening.body_output();
    for (std::size_t n = 0; n < product.size(); ++n) product[n] *= signal.values[n] - signal.mean;
    if (!signals.is_input(signal.name)) questions.ask("gain by", signal.name, own, {product});
    for (std::size_t j = i + 1; j < measured.size(); ++j) {
      std::vector<double> both(signals.size());
      for (std::size_t n = 0; n < both.size(); ++n) {
        both[n] = (signal.values[n] - signal.mean) * (measured[j]->values[n] - measured[j]->mean);
      }
      questions.ask("product of", signal.name + " and " + measured[j]->name,
                    {signal.name, measured[j]->name}, {both});
    }
  }
}

void ask_about_state(const Screening& screening, Questions& questions) {
  const std::vector<double>& y = screening.body_output();
  const auto& stretches = screening.signals().stretches();
  const double size = signal::rms(y);
  if (!(size > 0.0)) return;
  const auto passed = [&](const std::function<double(double)>& f) {
    return screening.through_body(mapped(y, [&](double value) { return f(value / size); }));
  };
  questions.ask("square of", "the body's output", {}, passed([](double z) { return z * z; }));
  questions.ask("cube of", "the body's output", {}, passed([](double z) { return z * z * z; }));
  questions.ask("size of", "the body's output", {}, passed([](double z) { return std::abs(z); }));
  const std::vector<double> rate = differenced(y, stretches);
  questions.ask("sign of the rate of", "the body's output", {},
                {mapped(rate, [](double v) { return v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0); })});
  std::vector<double> past(y.size());
  for (std::size_t n = 0; n < y.size(); ++n) past[n] = std::abs(y[n]) * rate[n];
  questions.ask("damping by the size of", "the body's output", {}, {past});
}

void ask_about_time(const Screening& screening, Questions& questions) {
  const Signals& signals = screening.signals();
  Columns gains;
  for (int k = 1; k <= kGainCosines; ++k) {
    std::vector<double> shape(signals.size());
    for (std::size_t n = 0; n < shape.size(); ++n) {
      const double t = (signals.time_s()[n] - signals.time_s().front()) / signals.duration_s();
      shape[n] = std::cos(std::numbers::pi * k * t);
    }
    for (std::size_t n = 0; n < shape.size(); ++n) shape[n] *= screening.body_output()[n];
    gains.push_back(std::move(shape));
  }
  questions.ask("gain over", "time", {}, gains);
}

Whiteness whiteness_of(const Screening& screening) {
  constexpr double kQuantile = 2.576;  // of a normal deviate, 99 %
  const Eigen::VectorXd& r = screening.residual();
  // Those of one second, and one sample at least.
  const auto lags = std::min<Eigen::Index>(
      r.size() / 4,
      std::max(static_cast<Eigen::Index>(screening.signals().rate_hz()), Eigen::Index{1}));
  Whiteness result;
  const double power = std::max(r.squaredNorm(), 1e-300);
  for (Eigen::Index lag = 0; lag <= lags; ++lag) {
    result.autocorrelation.push_back(r.head(r.size() - lag).dot(r.tail(r.size() - lag)) / power);
  }
  result.bound = kQuantile / std::sqrt(static_cast<double>(r.size()));
  const auto outside =
      std::count_if(result.autocorrelation.begin() + 1, result.autocorrelation.end(),
                    [&](double c) { return std::abs(c) > result.bound; });
  result.share_outside = static_cast<double>(outside) / static_cast<double>(lags);
  return result;
}

Spread spread_of(const Screening& screening) {
  const Eigen::VectorXd& r = screening.residual();
  const Blocks& blocks = screening.blocks();
  Spread result;
  for (std::size_t b = 0; b < blocks.count; ++b) {
    const auto [first, rows] = rows_of(blocks, b, r.size());
    double weight = 0.0;
    for (Eigen::Index n = first; n < first + rows; ++n) {
      weight += screening.weight()[static_cast<std::size_t>(n)];
    }
    if (weight < 1.0) continue;
    result.rms.push_back(std::sqrt(r.segment(first, rows).squaredNorm() / weight));
    result.time_s.push_back(
        screening.signals().time_s()[static_cast<std::size_t>(first + rows / 2)]);
  }
  if (!result.rms.empty()) {
    result.largest_ratio =
        std::ranges::max(result.rms) / std::max(signal::middle_of(result.rms), 1e-300);
  }
  return result;
}

std::optional<DetectionLines> lines_of(const Screening& screening,
                                       const std::optional<PeriodicExcitation>& excitation) {
  if (!excitation) return {};
  const auto repeated =
      repeated_residual(excitation->periodicity, screening.residual(), screening.weight());
  if (!repeated) return {};
  return detection_lines(*repeated, excitation->excited, screening.signals());
}

}  // namespace

DetectionResult detected(const Screening& screening,
                         const std::optional<PeriodicExcitation>& excitation) {
  Questions questions(screening);
  ask_about_signals(screening, questions);
  ask_about_state(screening, questions);
  ask_about_time(screening, questions);
  const std::optional<DetectionLines> lines = lines_of(screening, excitation);
  if (lines) {
    questions.add("odd lines", lines->odd);
    questions.add("even lines", lines->even);
    questions.add("lines not excited", lines->odd_or_even);
  }
  return {questions.answers(), whiteness_of(screening), spread_of(screening),
          coherence_of(screening.residual(), screening.weight(), screening.signals()), lines};
}

}  // namespace stillhand::diagnosis
