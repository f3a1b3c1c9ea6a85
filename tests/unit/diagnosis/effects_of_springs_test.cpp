// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/diagnosis/proposed.hpp"

// Nonlinearities inside the body, Eq. DG-4, simulated here sample by sample.
namespace stillhand::diagnosis::effects_of_springs_test {

using made::expect_proposed;
using made::Planted;

constexpr std::size_t kCount = 6000;
const std::vector<double> kU = made::ride(kCount, 1);
const Body kBody = made::two_pole_body();

// A y = B u + force * phi(y / threshold) of the sample before: a spring that answers the output.
std::vector<double> with_spring(double force, double threshold,
                                const std::function<double(double)>& phi) {
  const auto& b = kBody.numerators[0];
  const auto& a = kBody.denominator;
  std::vector<double> y(kCount, 0.0);
  double felt = 0.0;
  for (std::size_t n = 0; n < kCount; ++n) {
    y[n] = b[0] * kU[n] + felt;
    if (n >= 1) y[n] += b[1] * kU[n - 1] - a[1] * y[n - 1];
    if (n >= 2) y[n] += b[2] * kU[n - 2] - a[2] * y[n - 2];
    felt = force * phi(y[n] / threshold);
  }
  return y;
}

Planted planted(const char* kind, const char* form, const std::vector<double>& y) {
  return made::planted_in(kind, form, y, kU);
}

double size() { return made::rms_of(made::answer(kBody, kU)); }

// Thresholds of 0.5, 1, 1.7 and 3 standard deviations are tried; the path has two numbers, of which
// one is planted.
TEST(EffectsOfSpringsTest, ASpringThatHardens) {
  const auto bent = [](double z) { return z * z * z / (1.0 + z * z); };
  expect_proposed(planted("nonlinear_stiffness", "bent of the output",
                          with_spring(-0.03 * size(), size(), bent)),
                  {{0, size(), 0.75 * size(), 0.1 * size()}});
}

TEST(EffectsOfSpringsTest, ASpringThatIsStifferOnOneSide) {
  expect_proposed(
      planted("asymmetry", "slopes of the output",
              with_spring(-0.01 * size(), size(), [](double z) { return std::abs(z); })));
  expect_proposed(planted("asymmetry", "square of the output",
                          with_spring(-0.003 * size(), size(), [](double z) { return z * z; })));
}

TEST(EffectsOfSpringsTest, ASpringWithPlay) {
  expect_proposed(planted("dead_zone", "play of the output",
                          with_spring(0.02 * size(), 0.6 * size(),
                                      [](double z) { return std::clamp(z, -1.0, 1.0); })),
                  {{0, 0.6 * size(), 0.5 * size(), 0.06 * size()}});
}

TEST(EffectsOfSpringsTest, ASpringThatYields) {
  double state = 0.0;
  double before = 0.0;
  bool started = false;
  const auto stop = [&](double z) {
    if (!started) before = z;
    started = true;
    state = std::clamp(state + z - before, -1.0, 1.0);
    before = z;
    return state;
  };
  expect_proposed(planted("hysteresis", "elastic-plastic of the output",
                          with_spring(-0.02 * size(), 0.6 * size(), stop)),
                  {{0, 0.6 * size(), 0.5 * size(), 0.06 * size()}});
}

// A spring between two masses: displacement and force both lie inside.  z answers u through one of
// the two modes, its hardening force comes back to z and out to y.
TEST(EffectsOfSpringsTest, ASpringInsideTheBody) {
  const Body body = made::four_pole_body();
  const auto& a = body.denominator;
  // z: the mode at 2.5 Hz, numerator with the other one cancelled.
  const auto n_path = made::times({0.0, 1.0}, made::mode(7.0, 0.25));
  const auto linear = made::answer(n_path, a, kU);
  const double threshold = made::rms_of(linear);
  std::vector<double> z(kCount, 0.0);
  std::vector<double> phi(kCount, 0.0);
  std::vector<double> y(kCount, 0.0);
  const auto past = [](const std::vector<double>& x, std::size_t n, std::size_t i) {
    return n >= i ? x[n - i] : 0.0;
  };
  const std::vector<double> m{0.0, -0.02, 0.03, -0.01};  // of phi, in units of the threshold
  const std::vector<double> e{0.0, 0.05, -0.07, 0.025};
  for (std::size_t n = 0; n < kCount; ++n) {
    for (std::size_t i = 0; i <= 4; ++i) {
      if (i < n_path.size()) z[n] += n_path[i] * past(kU, n, i) / threshold;
      y[n] += body.numerators[0][i] * past(kU, n, i);
      if (i < m.size()) z[n] += m[i] * past(phi, n, i);
      if (i < e.size()) y[n] += e[i] * past(phi, n, i);
      if (i > 0) z[n] -= a[i] * past(z, n, i);
      if (i > 0) y[n] -= a[i] * past(y, n, i);
    }
    phi[n] = z[n] * z[n] * z[n] / (1.0 + z[n] * z[n]);
  }
  Planted sut = planted("nonlinear_stiffness", "bent inside the body", y);
  sut.order = 4;
  sut.left = 2.0;  // 14 numbers of the path, many directions of which say the same
  expect_proposed(sut);
}

}  // namespace stillhand::diagnosis::effects_of_springs_test
