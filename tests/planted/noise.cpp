// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace stillhand::planted {
namespace {

std::string text(const char* format, double value) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

/// First-order low-pass of white noise, in its steady state from the first sample, variance 1.
void add_first_order(Series& out, double rate_hz, double corner_hz, Draw& draw) {
  const double keep = std::exp(-2.0 * std::numbers::pi * corner_hz / rate_hz);
  const double fresh = std::sqrt(1.0 - keep * keep);
  double state = draw.normal();
  for (double& value : out) {
    value += state;
    state = keep * state + fresh * draw.normal();
  }
}

/// 1/f: equal power an octave, from one first-order process each.
void add_pink(Series& out, double rate_hz, Draw& draw) {
  const double lowest_hz = rate_hz / static_cast<double>(out.size());
  for (double corner_hz = lowest_hz; corner_hz < 0.5 * rate_hz; corner_hz *= 2.0) {
    add_first_order(out, rate_hz, corner_hz, draw);
  }
}

/// Student's t of 3 degrees of freedom.
double heavy_tailed(Draw& draw) {
  const double a = draw.normal();
  const double b = draw.normal();
  const double c = draw.normal();
  return draw.normal() / std::sqrt((a * a + b * b + c * c) / 3.0);
}

std::string make_uneven(Series& out, Draw& draw) {
  const double ratio = draw.uniform(2.0, 5.0);
  const std::size_t pick = draw.index(3);
  const double at = draw.uniform(0.25, 0.75);
  const double cycles = draw.uniform(1.0, 4.0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(out.size());
    const double part = pick == 0   ? x
                        : pick == 1 ? (x > at ? 1.0 : 0.0)
                                    : 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * cycles * x);
    out[i] = draw.normal() * (1.0 + (ratio - 1.0) * part);
  }
  const char* name = pick == 0   ? "white, rising to %.1f times"
                     : pick == 1 ? "white, from one moment %.1f times"
                                 : "white, swelling to %.1f times";
  return text(name, ratio);
}

}  // namespace

Noise draw_noise(NoiseShape shape, std::size_t count, double rate_hz, double rms, Draw& draw) {
  Noise out{Series(count, 0.0), std::string(kNoiseNames[static_cast<std::size_t>(shape)])};
  switch (shape) {
    case NoiseShape::kWhite:
      for (double& value : out.values) value = draw.normal();
      break;
    case NoiseShape::kLowPass: {
      const double corner_hz = draw.log_uniform(0.2, 5.0);
      add_first_order(out.values, rate_hz, corner_hz, draw);
      out.about = text("first-order low-pass, corner %.2f Hz", corner_hz);
      break;
    }
    case NoiseShape::kPink:
      add_pink(out.values, rate_hz, draw);
      break;
    case NoiseShape::kHeavyTailed:
      for (double& value : out.values) value = heavy_tailed(draw);
      break;
    case NoiseShape::kUneven:
      out.about = make_uneven(out.values, draw);
      break;
  }
  standardise(out.values, rms);
  return out;
}

Losses draw_losses(bool gaps, bool single_rows, std::size_t count, double rate_hz, Draw& draw) {
  Losses out{std::vector<bool>(count, false), ""};
  if (gaps) {
    const std::size_t number = 2 + draw.index(4);
    for (std::size_t i = 0; i < number; ++i) {
      const auto rows = static_cast<std::size_t>(draw.log_uniform(0.2, 3.0) * rate_hz);
      const auto first =
          static_cast<std::size_t>(draw.uniform(0.02, 0.95) * static_cast<double>(count));
      for (std::size_t n = first; n < std::min(count - 1, first + rows); ++n) out.lost[n] = true;
    }
    out.about = std::to_string(number) + " gaps";
  }
  if (single_rows) {
    const double share = draw.uniform(0.002, 0.01);
    for (std::size_t n = 1; n + 1 < count; ++n) {
      if (draw.chance(share)) out.lost[n] = true;
    }
    out.about += (gaps ? ", " : "") + text("%.2f %% of the rows", 100.0 * share);
  }
  return out;
}

}  // namespace stillhand::planted
