// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "services/core/recording/recording.hpp"

/// Recordings of a body that is known, and what loggers, sensors and people do to them.
namespace stillhand::spoiled {

inline constexpr double kGain_n_s2_m = 2.0;
inline constexpr double kResonance_hz = 2.5;
inline constexpr double kDamping = 0.35;
inline constexpr double kRate_hz = 100.0;
inline constexpr std::size_t kRows = 6000;

/// Uniform in 0 to 1, the same on every machine.
class Dice {
 public:
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_ = 1;
};

/// `t, a_y [m/s^2], f [N]`: noise of 0.3 to 6 Hz, and the body's answer
///
///   f'' + 2 d w f' + w^2 f = g w^2 a,   g = 2 N/(m/s^2), w = 2 pi 2.5 Hz, d = 0.35
///
/// by 100 steps a row (semi-implicit Euler, 0.1 % at the resonance), and 1 mN of noise.
inline recording::Recording known_body() {
  recording::Recording out;
  out.source = "known_body";
  out.columns = {{"a_y", "m/s^2", {}}, {"f", "N", {}}};
  Dice dice;
  constexpr int kSteps = 100;
  constexpr double kStep_s = 1.0 / (kRate_hz * kSteps);
  constexpr double kPi = std::numbers::pi;
  const double w = 2.0 * kPi * kResonance_hz;
  double slow = 0.0, fast = 0.0, faster = 0.0, force = 0.0, rate = 0.0;
  for (std::size_t n = 0; n < kRows; ++n) {
    const double white = 12.0 * (dice.next() - 0.5);
    for (int k = 0; k < kSteps; ++k) {
      fast += 2.0 * kPi * 6.0 * kStep_s * (white - fast);
      faster += 2.0 * kPi * 6.0 * kStep_s * (fast - faster);
      slow += 2.0 * kPi * 0.3 * kStep_s * (faster - slow);
      if (k == 0) {
        out.time_s.push_back(static_cast<double>(n) / kRate_hz);
        out.columns[0].values.push_back(faster - slow);
        out.columns[1].values.push_back(force + 2e-3 * (dice.next() - 0.5));
      }
      rate +=
          kStep_s * (w * w * (kGain_n_s2_m * (faster - slow) - force) - 2.0 * kDamping * w * rate);
      force += kStep_s * rate;
    }
  }
  recording::estimate_timing(out);
  return out;
}

using Values = std::vector<double>;

/// What was done to a recording, and what every verb has to find.
struct Case {
  std::string name;
  std::string channel;  ///< that screening names; empty: none
  std::string what;     ///< that it names
  bool no_model;        ///< false: what is left is the body's
  void (*spoil)(Values& a, Values& f);
};

inline Values between(const Values& from, double first, double step) {
  Values out;
  const auto size = static_cast<double>(from.size());
  for (std::size_t n = 0; n < from.size(); ++n) {
    // Beyond the end it begins again.
    const double place = std::fmod(first + step * static_cast<double>(n) + size, size);
    const auto below = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(below);
    out.push_back((1.0 - part) * from[below] + part * from[(below + 1) % from.size()]);
  }
  return out;
}

inline void hold(Values& values, double rows) {
  const Values from = values;
  for (std::size_t n = 0; n < values.size(); ++n) {
    values[n] =
        from[static_cast<std::size_t>(std::floor(static_cast<double>(n) / rows + 1e-9) * rows)];
  }
}

inline void add_noise(Values& values, double size) {
  Dice dice;
  for (double& value : values) value += size * (dice.next() - 0.5);
}

/// Straight lines between every so many of the values.
inline void draw_lines(Values& values, std::size_t rows) {
  const Values from = values;
  for (std::size_t n = 0; n + rows < values.size(); ++n) {
    const std::size_t knot = n / rows * rows;
    values[n] = from[knot] + static_cast<double>(n % rows) / static_cast<double>(rows) *
                                 (from[knot + rows] - from[knot]);
  }
}

inline void fill(Values& values, std::size_t first, std::size_t end, double with) {
  for (std::size_t n = first; n < end; ++n) values[n] = with;
}

inline void scatter(Values& values, std::size_t count, double with, bool add) {
  Dice dice;
  for (std::size_t k = 0; k < count; ++k) {
    const auto at = static_cast<std::size_t>(dice.next() * static_cast<double>(values.size()));
    values[at] = add ? values[at] + (dice.next() < 0.5 ? -with : with) : with;
  }
}

inline void scale(Values& values, double by) {
  for (double& value : values) value *= by;
}

inline void round_to(Values& values, double step) {
  for (double& value : values) value = std::round(value / step) * step;
}

/// A blow of one row on the platform, and the body's answer to it.
inline void hit(Values& a, Values& f, std::size_t row, double by_m_s2) {
  const double w = 2.0 * std::numbers::pi * kResonance_hz;
  const double damped = w * std::sqrt(1.0 - kDamping * kDamping);
  a[row] += by_m_s2;
  for (std::size_t n = row; n < f.size(); ++n) {
    const double t_s = static_cast<double>(n - row) / kRate_hz;
    f[n] += kGain_n_s2_m * w * w / damped * by_m_s2 / kRate_hz * std::exp(-kDamping * w * t_s) *
            std::sin(damped * t_s);
  }
}

inline const std::vector<Case>& cases() {
  static const std::vector<Case> kCases{
      {"as it is", "", "", false, [](Values&, Values&) {}},
      {"a tenth of the motion", "", "", false,
       [](Values& a, Values& f) {
         scale(a, 0.1);
         scale(f, 0.1);
       }},
      {"12 bits", "", "", false,
       [](Values& a, Values& f) {
         round_to(a, 8.0 / 2048.0);
         round_to(f, 16.0 / 2048.0);
       }},
      {"a blow", "", "", false, [](Values& a, Values& f) { hit(a, f, 2500, 60.0); }},
      {"blows", "", "", false,
       [](Values& a, Values& f) {
         for (const std::size_t row : {700u, 1300u, 3100u, 5200u}) hit(a, f, row, 40.0);
       }},
      {"rail of 16 bits", "f", "rail", false,
       [](Values&, Values& f) { fill(f, 3000, 3030, 32767); }},
      {"rail of 12 bits", "a_y", "rail", false,
       [](Values& a, Values&) { fill(a, 100, 300, -2048); }},
      {"rail of 24 bits", "f", "rail", false, [](Values&, Values& f) { fill(f, 9, 40, 8388607); }},
      {"both rails of 16 bits", "f", "rail", false,
       [](Values&, Values& f) {
         fill(f, 2000, 2010, 32767);
         fill(f, 2010, 2020, -32768);
       }},
      {"fill value", "f", "sentinel", false,
       [](Values&, Values& f) { scatter(f, 12, -9999, false); }},
      {"netCDF's fill value", "a_y", "sentinel", false,
       [](Values& a, Values&) { scatter(a, 30, 9.96921e36, false); }},
      {"fill value of 999 in a block", "f", "sentinel", false,
       [](Values&, Values& f) { fill(f, 2000, 2100, 999); }},
      {"spikes", "f", "spikes", false, [](Values&, Values& f) { scatter(f, 40, 80, true); }},
      {"spikes of two rows", "f", "spikes", false,
       [](Values&, Values& f) {
         for (const std::size_t row : {400u, 950u, 1020u, 2600u, 4100u, 5555u}) {
           f[row] += 60.0;
           f[row + 1] += 55.0;
         }
       }},
      {"spikes in the acceleration", "a_y", "spikes", false,
       [](Values& a, Values&) {
         for (const std::size_t row : {150u, 1950u, 2020u, 3600u, 4100u, 5111u}) a[row] -= 90.0;
       }},
      {"spikes in both at once", "f", "spikes", false,
       [](Values& a, Values& f) {
         for (const std::size_t row : {150u, 1950u, 2020u, 3600u, 4100u, 5111u}) {
           a[row] += 60.0;
           f[row] += row < 3000 ? 80.0 : -80.0;
         }
       }},
      {"drop-outs to zero", "f", "drop-outs", false,
       [](Values&, Values& f) {
         for (const std::size_t row :
              {300u, 410u, 1111u, 1900u, 2222u, 2950u, 3333u, 4400u, 4987u, 5050u, 5301u, 5777u}) {
           fill(f, row, row + 2 + row % 3, 0.0);
         }
       }},
      {"one spike", "a_y", "spikes", false, [](Values& a, Values&) { a[1234] += 300; }},
      {"frozen tail", "f", "stuck", false,
       [](Values&, Values& f) { fill(f, 4000, kRows, f[4000]); }},
      {"frozen input", "a_y", "stuck", false,
       [](Values& a, Values&) { fill(a, 2000, 2500, a[2000]); }},
      {"a loose plug", "f", "stuck", false,
       [](Values&, Values& f) {
         fill(f, 1000, 1050, 0.0);
         fill(f, 2510, 2600, 0.0);
         fill(f, 4015, 4070, 0.0);
       }},
      {"zeros allocated before", "f", "stuck", false,
       [](Values& a, Values& f) {
         fill(a, 4500, kRows, 0.0);
         fill(f, 4500, kRows, 0.0);
       }},
      {"clipped", "f", "clipped", false,
       [](Values&, Values& f) {
         for (double& value : f) value = std::clamp(value, -4.8, 4.8);
       }},
      {"clipped acceleration", "a_y", "clipped", false,
       [](Values& a, Values&) {
         for (double& value : a) value = std::clamp(value, -2.2, 2.2);
       }},
      {"held at 25 Hz", "a_y", "held", true, [](Values& a, Values&) { hold(a, 4); }},
      {"held at 10 Hz", "f", "held", true, [](Values&, Values& f) { hold(f, 10); }},
      {"held at 20 Hz", "f", "held", true, [](Values&, Values& f) { hold(f, 5); }},
      {"held at 30 Hz", "a_y", "held", true, [](Values& a, Values&) { hold(a, 10.0 / 3.0); }},
      {"straight lines from 20 Hz", "a_y", "held", true,
       [](Values& a, Values&) { draw_lines(a, 5); }},
      {"straight lines from 25 Hz", "f", "held", true,
       [](Values&, Values& f) { draw_lines(f, 4); }},
      {"straight lines from 20 Hz behind a noise", "a_y", "held", true,
       [](Values& a, Values&) {
         draw_lines(a, 5);
         add_noise(a, 0.01);
       }},
      {"held at 30 Hz behind a noise", "a_y", "held", true,
       [](Values& a, Values&) {
         hold(a, 10.0 / 3.0);
         add_noise(a, 0.05);
       }},
      {"held at 10 Hz behind a noise", "f", "held", true,
       [](Values&, Values& f) {
         hold(f, 10);
         add_noise(f, 0.2);
       }},
      {"held as a bus delivers", "f", "held", true,
       [](Values&, Values& f) {
         Dice dice;
         for (std::size_t n = 0; n < f.size();) {
           const std::size_t end =
               std::min(f.size(), n + 2 + static_cast<std::size_t>(8.0 * dice.next()));
           fill(f, n, end, f[n]);
           n = end;
         }
       }},
      {"16 bits that overflow", "f", "overflow", true,
       [](Values&, Values& f) {
         for (double& value : f) value -= 8.0 * std::round(value / 8.0);
       }},
      {"nine steps", "f", "coarse", true, [](Values&, Values& f) { round_to(f, 1.5); }},
      {"columns exchanged", "", "", true, [](Values& a, Values& f) { std::swap(a, f); }},
      {"a counter for a signal", "a_y", "counter", true,
       [](Values& a, Values&) {
         for (std::size_t n = 0; n < a.size(); ++n) a[n] = static_cast<double>(n % 256);
       }},
      {"a counter of 16 bits", "f", "counter", true,
       [](Values&, Values& f) {
         for (std::size_t n = 0; n < f.size(); ++n) f[n] = static_cast<double>(n * 3 % 65536);
       }},
      {"thousandths of newtons", "", "", true, [](Values&, Values& f) { scale(f, 1000.0); }},
      {"thousands of newtons", "", "", true, [](Values&, Values& f) { scale(f, 1e-3); }},
      {"mm/s^2", "", "", true, [](Values& a, Values&) { scale(a, 1000.0); }},
      {"two seconds late", "", "", true, [](Values&, Values& f) { f = between(f, -200.0, 1.0); }},
      {"two seconds early", "", "", true, [](Values&, Values& f) { f = between(f, 200.0, 1.0); }},
      {"a clock 0.83 % fast", "", "", true,
       [](Values&, Values& f) { f = between(f, 0.0, 0.9917); }},
      {"a clock 0.83 % slow", "", "", true,
       [](Values&, Values& f) { f = between(f, 0.0, 1.0083); }},
      {"a clock 1.5 % fast", "", "", true, [](Values&, Values& f) { f = between(f, 0.0, 0.985); }},
      {"a clock 1.5 % slow", "", "", true, [](Values&, Values& f) { f = between(f, 0.0, 1.015); }},
      {"another recording's force", "", "", true,
       [](Values&, Values& f) { f = Values(f.rbegin(), f.rend()); }},
      {"noise for a signal", "", "", true, [](Values& a, Values&) {
         Dice dice;
         for (double& value : a) value = dice.next() - 0.5;
       }}};
  return kCases;
}

inline recording::Recording recorded(const Case& each) {
  recording::Recording out = known_body();
  each.spoil(out.columns[0].values, out.columns[1].values);
  return out;
}

}  // namespace stillhand::spoiled
