// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "services/core/contract/config_error.hpp"

namespace stillhand::study {
namespace {

using Complex = std::complex<double>;

Complex s_at(double frequency_hz) { return {0.0, 2.0 * std::numbers::pi * frequency_hz}; }

Complex stick_impedance_at(const admittance::StickValues& stick, Complex s) {
  return stick.drive_mass_kg * s * s + stick.viscous_damping_n_s_m * s +
         stick.centring_stiffness_n_m;
}

// Eq. MI-8: one of the three parts of Z_+ each, per unit.
struct AddedParts {
  Complex stiffness, damping, mass;
};

AddedParts added_at(Complex s, const LoopTiming& timing) {
  const Complex loop = std::exp(-s * timing.delay_s) / (1.0 + s * timing.lag_s);
  const double w = 2.0 * std::numbers::pi * timing.rate_filter_hz;
  const Complex rate = w * w / (s * s + std::numbers::sqrt2 * w * s + w * w);
  const Complex inertia =
      1.0 / (1.0 + s / (2.0 * std::numbers::pi * cancellation::kInertiaCorner_hz));
  return {loop, loop * s * rate, loop * s * s * rate * inertia};
}

Complex added(const AddedParts& parts, const cancellation::ImpedanceConfig& impedance) {
  return impedance.stiffness_n_m * parts.stiffness + impedance.damping_n_s_m * parts.damping +
         impedance.mass_kg * parts.mass;
}

void need_people(const std::vector<KnownPerson>& people) {
  const bool known = !people.empty() && std::ranges::all_of(people, [](const KnownPerson& one) {
    return !one.arms.empty();
  });
  if (!known) throw ConfigError("mitigation.people", "nobody with an arm", "one person or more");
}

// An arm at the lines of a motion.
struct ArmLines {
  std::vector<admittance::ArmResponse> at;
};

ArmLines lines_of(const admittance::ArmValues& arm, const std::vector<PowerLine>& lines) {
  ArmLines out;
  for (const PowerLine& line : lines) {
    out.at.push_back(admittance::arm_response(arm, line.frequency_hz));
  }
  return out;
}

std::vector<ArmLines> all_lines(const std::vector<KnownPerson>& people,
                                const std::vector<PowerLine>& lines) {
  std::vector<ArmLines> out;
  for (const KnownPerson& person : people) {
    for (const auto& arm : person.arms) out.push_back(lines_of(arm, lines));
  }
  return out;
}

std::vector<AddedParts> parts_at(const std::vector<PowerLine>& lines, const LoopTiming& timing) {
  std::vector<AddedParts> out;
  out.reserve(lines.size());
  for (const PowerLine& line : lines) out.push_back(added_at(s_at(line.frequency_hz), timing));
  return out;
}

// Power of the motion that comes through the arm, and of the force that a wanted motion needs.
double motion_power(const PowerLine& line, const admittance::ArmResponse& arm, Complex impedance) {
  return line.power * std::norm(arm.feedthrough) / std::norm(impedance);
}
double force_power(const PowerLine& line, const admittance::ArmResponse& /*arm*/,
                   Complex impedance) {
  return line.power * std::norm(impedance);
}

// RMS in the worst arm, over that without the shaping; Eq. MI-8, and its bound.
double worst_ratio(const std::vector<PowerLine>& lines, const std::vector<ArmLines>& arms,
                   const std::vector<AddedParts>& parts, const admittance::StickValues& stick,
                   const cancellation::ImpedanceConfig& impedance, const auto& power) {
  double worst = 0.0;
  for (const ArmLines& arm : arms) {
    double with = 0.0;
    double without = 0.0;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const Complex alone =
          stick_impedance_at(stick, s_at(lines[k].frequency_hz)) + arm.at[k].impedance;
      without += power(lines[k], arm.at[k], alone);
      with += power(lines[k], arm.at[k], alone + added(parts[k], impedance));
    }
    worst = std::max(worst, std::sqrt(with / without));
  }
  return worst;
}

}  // namespace

ReducedChoice choose_reduced(const std::vector<KnownPerson>& people,
                             const std::vector<PowerLine>& motion,
                             const admittance::StickValues& stick) {
  need_people(people);
  constexpr int kGains = 25;
  constexpr double kGainStep = 0.05;
  const std::vector<ArmLines> arms = all_lines(people, motion);
  std::size_t orders = 12;
  for (const KnownPerson& one : people) orders = std::min(orders, one.reduced.size());
  if (orders == 0) throw ConfigError("mitigation.people", "no models", "a model of each person");
  ReducedChoice best{.order = 1, .gain = 0.0, .worst = 1.0};
  for (std::size_t order = 1; order <= orders; ++order) {
    std::array<double, kGains> worst{};
    for (const KnownPerson& made_for : people) {
      std::vector<Complex> model;
      model.reserve(motion.size());
      for (const PowerLine& line : motion) {
        model.push_back(signal::response_at(made_for.reduced[order - 1], line.frequency_hz));
      }
      for (const ArmLines& arm : arms) {
        // || P (H - g M) ||^2 = a - 2 b g + c g^2.
        double a = 0.0;
        double b = 0.0;
        double c = 0.0;
        for (std::size_t k = 0; k < motion.size(); ++k) {
          const Complex whole =
              stick_impedance_at(stick, s_at(motion[k].frequency_hz)) + arm.at[k].impedance;
          const double weight = motion[k].power / std::norm(whole);
          const Complex h = arm.at[k].feedthrough;
          a += weight * std::norm(h);
          b += weight * (std::conj(h) * model[k]).real();
          c += weight * std::norm(model[k]);
        }
        for (int i = 0; i < kGains; ++i) {
          const double g = kGainStep * i;
          const double left = std::sqrt(std::max(0.0, a - 2.0 * b * g + c * g * g) / a);
          worst[static_cast<std::size_t>(i)] = std::max(worst[static_cast<std::size_t>(i)], left);
        }
      }
    }
    for (int i = 0; i < kGains; ++i) {
      // A lower order wins a draw.
      if (worst[static_cast<std::size_t>(i)] < best.worst - 1e-9) {
        best = {order, kGainStep * i, worst[static_cast<std::size_t>(i)]};
      }
    }
  }
  return best;
}

double passive_up_to_hz(const cancellation::ImpedanceConfig& impedance,
                        const admittance::StickValues& stick, const LoopTiming& timing) {
  constexpr int kLast = 1000;
  for (int step = 1; step <= kLast; ++step) {
    const double f = 0.1 * step;
    const Complex s = s_at(f);
    const Complex whole = stick_impedance_at(stick, s) + added(added_at(s, timing), impedance);
    if ((whole / s).real() < 0.0) return f;
  }
  return 0.1 * kLast;
}

ImpedanceChoice choose_impedance(const std::vector<KnownPerson>& people,
                                 const std::vector<PowerLine>& motion,
                                 const std::vector<PowerLine>& wanted,
                                 const admittance::StickValues& stick, const LoopTiming& timing,
                                 const ImpedanceBounds& bounds) {
  need_people(people);
  const std::vector<ArmLines> moved = all_lines(people, motion);
  const std::vector<ArmLines> willed = all_lines(people, wanted);
  const auto moved_parts = parts_at(motion, timing);
  const auto willed_parts = parts_at(wanted, timing);
  ImpedanceChoice best{.worst = 1.0, .effort = 1.0};
  best.passive_hz = passive_up_to_hz(best.impedance, stick, timing);
  constexpr int kStiffnesses = 15;
  constexpr int kDampings = 12;
  constexpr int kMasses = 4;
  for (int k = 0; k <= kStiffnesses; ++k) {
    for (int b = 0; b <= kDampings; ++b) {
      for (int m = 0; m <= kMasses; ++m) {
        const cancellation::ImpedanceConfig impedance{bounds.most_mass * m / kMasses,
                                                      bounds.most_damping * b / kDampings,
                                                      bounds.most_stiffness * k / kStiffnesses};
        const double passive_hz = passive_up_to_hz(impedance, stick, timing);
        if (passive_hz < bounds.passive_to_hz) continue;
        const double effort =
            worst_ratio(wanted, willed, willed_parts, stick, impedance, force_power);
        if (effort > bounds.most_effort) continue;
        const double worst =
            worst_ratio(motion, moved, moved_parts, stick, impedance, motion_power);
        if (worst < best.worst) best = {impedance, worst, effort, passive_hz};
      }
    }
  }
  return best;
}

}  // namespace stillhand::study
