// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "services/core/contract/tick.hpp"

/// Parts of property tests: draws that try the worst, and the shortest sequence that fails.
namespace stillhand::support {

/// A tick and some more; beyond an end of the type it goes on from the other end.
constexpr Tick moved(Tick tick, Tick by) noexcept {
  return static_cast<Tick>(static_cast<std::uint64_t>(tick) + static_cast<std::uint64_t>(by));
}

/// Draws for one sequence; the seed determines all of them.
class Hostile {
 public:
  explicit Hostile(std::uint64_t seed) : engine_(seed) {
    // Some sequences are almost sound, so that forces act; others are all noise.
    constexpr std::array kShares{0.0, 0.001, 0.02, 0.3};
    worst_share_ = kShares[index(kShares.size())];
  }

  bool chance(double share) { return std::bernoulli_distribution(share)(engine_); }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  std::size_t index(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_);
  }

  /// Within +-scale, now and then NaN, infinite, denormal, huge, or a zero with either sign.
  double number(double scale) {
    if (!worst()) return uniform(-scale, scale);
    using Limits = std::numeric_limits<double>;
    const std::array values{Limits::quiet_NaN(),
                            Limits::infinity(),
                            -Limits::infinity(),
                            Limits::max(),
                            Limits::lowest(),
                            Limits::denorm_min(),
                            -0.0,
                            -Limits::denorm_min(),
                            1e9 * scale,
                            Limits::min(),
                            -1e3 * scale,
                            0.0};
    return values[index(values.size())];
  }
  /// `next`, now and then a tick that is lost, repeated, earlier, far away or at an end.
  Tick tick(Tick next) {
    if (!worst()) return next;
    using Limits = std::numeric_limits<Tick>;
    const std::array ticks{moved(next, -1), moved(next, -2),   moved(next, 1),
                           moved(next, 49), moved(next, 51),   moved(next, 100'000),
                           Tick{0},         Limits::min(),     Limits::max(),
                           Tick{-1},        Limits::max() - 1, next / 2};
    return ticks[index(ticks.size())];
  }
  bool worst() { return worst_share_ > 0.0 && chance(worst_share_); }

 private:
  std::mt19937_64 engine_;
  double worst_share_ = 0.0;
};

/// Where a sequence broke a property.
struct Broken {
  std::size_t step;
  std::string what;
};

/// Runs a sequence from the start; none: the property holds.
template <typename Step>
using Run = std::function<std::optional<Broken>(const std::vector<Step>& steps)>;

/// The failing sequence cut at its failure, then without every part that it does not need.  Tries
/// parts of half its length first, then of a quarter, and so on, with a limit on the runs.
template <typename Step>
std::vector<Step> shrunk(std::vector<Step> steps, const Run<Step>& run) {
  const auto cut = [&](std::vector<Step> sequence) {
    const auto broken = run(sequence);
    if (broken) sequence.resize(broken->step + 1);
    return std::pair{broken.has_value(), sequence};
  };
  steps = cut(steps).second;
  int runs_left = 2000;
  for (std::size_t part = steps.size() / 2; part > 0; part /= 2) {
    for (std::size_t at = 0; at + part <= steps.size() && runs_left > 0;) {
      std::vector<Step> shorter = steps;
      const auto from = shorter.begin() + static_cast<std::ptrdiff_t>(at);
      shorter.erase(from, from + static_cast<std::ptrdiff_t>(part));
      --runs_left;
      if (auto [fails, left] = cut(shorter); fails) {
        steps = std::move(left);
      } else {
        at += part;
      }
    }
  }
  return steps;
}

/// Empty if the property holds; otherwise seed, step, what broke, and the shrunk sequence.
template <typename Step>
std::string failure_of(std::uint64_t seed, const std::vector<Step>& steps, const Run<Step>& run) {
  const auto broken = run(steps);
  if (!broken) return "";
  const auto shorter = shrunk(steps, run);
  const auto still = run(shorter);
  std::ostringstream text;
  text.precision(17);
  text << "seed " << seed << ", step " << broken->step << ": " << broken->what << "\nshrunk to "
       << shorter.size() << " steps: " << (still ? still->what : "passes now") << "\n";
  constexpr std::size_t kMostShown = 40;
  for (std::size_t i = shorter.size() - std::min(shorter.size(), kMostShown); i < shorter.size();
       ++i) {
    text << "  " << i << ": " << shorter[i] << "\n";
  }
  return text.str();
}

/// What no motor force may break, whatever commands it: seen from outside, with arithmetic of its
/// own.  Tolerances of 1e-9 N: the last bits of a sum of forces up to 60 N.
class ForceWatch {
 public:
  ForceWatch(double max_force_n, double max_slew_n_s, std::int64_t ramp_ticks)
      : max_force_n_(max_force_n), slew_n_(max_slew_n_s * kControlPeriod_s), ramp_(ramp_ticks) {}

  /// @param allowed  nothing forbids a force at this step
  std::optional<std::string> see(double force_n, bool allowed) {
    const double change_n = std::abs(force_n - last_n_);
    const double before_n = std::abs(last_n_);
    forbidden_ = allowed ? 0 : forbidden_ + 1;
    last_n_ = force_n;
    largest_n_ = std::max(largest_n_, std::abs(force_n));
    const double ramp_step_n = max_force_n_ / static_cast<double>(ramp_);
    if (!std::isfinite(force_n)) return "force is not finite";
    if (std::abs(force_n) > max_force_n_) return text("force above its limit", force_n);
    if (change_n > std::max(slew_n_, ramp_step_n) + kExact_n) return text("slew", change_n);
    if (!allowed && std::abs(force_n) > before_n + kExact_n) return text("grows", force_n);
    if (forbidden_ >= ramp_ && force_n != 0.0) return text("not zero after the ramp", force_n);
    return std::nullopt;
  }
  [[nodiscard]] double largest_n() const noexcept { return largest_n_; }

 private:
  static constexpr double kExact_n = 1e-9;
  static std::string text(const char* what, double value_n) {
    std::ostringstream out;
    out << what << ": " << value_n << " N";
    return out.str();
  }

  double max_force_n_;
  double slew_n_;
  std::int64_t ramp_;
  double last_n_ = 0.0;
  double largest_n_ = 0.0;
  std::int64_t forbidden_ = 0;
};

}  // namespace stillhand::support
