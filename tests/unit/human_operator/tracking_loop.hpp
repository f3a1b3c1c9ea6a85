// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "services/core/contract/tick.hpp"
#include "services/core/human_operator/crossover_operator.hpp"
#include "services/core/signal/moments.hpp"
#include "services/core/signal/reference.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::human_operator {

/// Stick and arm as one mass, damper and spring, integrated by four Runge-Kutta steps a tick.
class Stick {
 public:
  explicit Stick(const ArmFeel& feel) : feel_(feel) {}

  void push(double force_n) {
    constexpr int kSubsteps = 4;
    const double h = kControlPeriod_s / kSubsteps;
    const auto accel = [&](double x, double v) {
      return (force_n - feel_.effective_damping_n_s_m * v - feel_.effective_stiffness_n_m * x) /
             feel_.effective_mass_kg;
    };
    for (int i = 0; i < kSubsteps; ++i) {
      const double v1 = v_, a1 = accel(x_, v_);
      const double v2 = v_ + h / 2 * a1, a2 = accel(x_ + h / 2 * v1, v2);
      const double v3 = v_ + h / 2 * a2, a3 = accel(x_ + h / 2 * v2, v3);
      const double v4 = v_ + h * a3, a4 = accel(x_ + h * v3, v4);
      x_ += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
      v_ += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  }
  [[nodiscard]] double hand_m() const { return x_; }

 private:
  ArmFeel feel_;
  double x_ = 0.0, v_ = 0.0;
};

/// A disturbance on harmonics of the run that the reference leaves free.
struct Disturbance {
  double rms_n = 0.0;
  double from_hz = 0.7;
  double to_hz = 2.0;
};

/// What a run leaves behind, one sample a tick.
struct TrackingRun {
  signal::ReferenceDesign design;
  std::vector<double> cursor_m, error_m, force_n;

  [[nodiscard]] double error_rms_m() const { return signal::rms(error_m); }
  [[nodiscard]] double dwell() const {
    std::size_t inside = 0;
    for (const double e : error_m) inside += std::abs(e) < 0.015 ? 1 : 0;
    return static_cast<double>(inside) / static_cast<double>(error_m.size());
  }
  /// G = Xp/Xe at line k, the paper's estimate.
  [[nodiscard]] std::complex<double> open_loop(std::size_t k) const {
    return signal::line_at(cursor_m, design.harmonics[k]) /
           signal::line_at(error_m, design.harmonics[k]);
  }
  [[nodiscard]] double line_hz(std::size_t k) const {
    return static_cast<double>(design.harmonics[k]) * kControlRateHz /
           static_cast<double>(error_m.size());
  }
  /// Crossover of the -20 dB/decade line through the lowest 11 points (paper III-C).
  [[nodiscard]] double crossover_hz_by_line() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < 11; ++k) sum += std::log(std::abs(open_loop(k)) * line_hz(k));
    return std::exp(sum / 11.0);
  }
};

inline double disturbance_at(const Disturbance& disturbance, const signal::ReferenceDesign& design,
                             Tick tick, Tick period_ticks) {
  if (disturbance.rms_n == 0.0) return 0.0;
  constexpr int kTones = 7;
  double sum = 0.0;
  for (int i = 0; i < kTones; ++i) {
    const double f =
        disturbance.from_hz + (disturbance.to_hz - disturbance.from_hz) * (i + 0.5) / kTones;
    auto harmonic = static_cast<Tick>(f * static_cast<double>(period_ticks) * kControlPeriod_s);
    for (const auto taken : design.harmonics) harmonic += harmonic == taken ? 1 : 0;
    const double turn =
        static_cast<double>(harmonic * tick % period_ticks) / static_cast<double>(period_ticks);
    sum += std::sin(2.0 * std::numbers::pi * turn + 1.7 * i * i);
  }
  return disturbance.rms_n * std::sqrt(2.0 / kTones) * sum;
}

/// Closes the loop over the periodic target of `duration_s`, with one tick from force to cursor,
/// and keeps its second period: the first is the run-in.
inline TrackingRun close_the_loop(const CrossoverConfig& config, double duration_s,
                                  std::uint64_t seed, double scale_m,
                                  const Disturbance& disturbance = {}) {
  const Tick period = ticks_in(duration_s);
  TrackingRun run;
  run.design = signal::reference_design(duration_s);
  const signal::ReferenceSignal reference(run.design, period, seed, scale_m);
  CrossoverOperator subject(config);
  Stick stick(config.arm);
  for (Tick tick = 0; tick < 2 * period; ++tick) {
    const double target_m = reference.at(tick);
    const double cursor_m = config.arm.cursor_per_hand * stick.hand_m();
    const auto out = subject.step({tick, target_m, cursor_m, true});
    stick.push(out.force_n + disturbance_at(disturbance, run.design, tick, period));
    if (tick < period) continue;
    run.cursor_m.push_back(cursor_m);
    run.error_m.push_back(target_m - cursor_m);
    run.force_n.push_back(out.force_n);
  }
  return run;
}

/// Without remnant and regression: the linear loop of Eq. HO-3.
inline CrossoverConfig linear_subject() {
  CrossoverConfig config;
  config.remnant_ratio = 0.0;
  config.regression_error_m = 1e6;
  return config;
}

}  // namespace stillhand::human_operator
