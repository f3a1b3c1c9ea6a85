// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/fourier_lines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::fourier_lines_test {

TEST(FourierLinesTest, AnyLengthGivesTheDefinitionsSums) {
  for (const std::size_t count : {1u, 2u, 3u, 8u, 30u, 101u, 1009u}) {
    const std::vector<double> x = made::white(count, count);
    const auto sut = fourier_lines(x);
    ASSERT_EQ(sut.size(), count / 2 + 1);
    for (std::size_t j = 0; j < sut.size(); ++j) {
      std::complex<double> sum = 0.0;
      for (std::size_t n = 0; n < count; ++n) {
        const auto step = static_cast<double>(j * n % count) / static_cast<double>(count);
        sum += x[n] * std::polar(1.0, -2.0 * std::numbers::pi * step);
      }
      // Rounding of some log2(2048) stages on values of size sqrt(1009).
      EXPECT_LT(std::abs(sut[j] - sum), 1e-11) << count << ", line " << j;
    }
  }
}

TEST(FourierLinesTest, NothingHasNoLines) { EXPECT_TRUE(fourier_lines({}).empty()); }

}  // namespace stillhand::diagnosis::fourier_lines_test
