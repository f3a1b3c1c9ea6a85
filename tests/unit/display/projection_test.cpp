// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/projection.hpp"

#include <gtest/gtest.h>

#include "services/core/contract/config_error.hpp"

namespace stillhand::display::projection_test {

TEST(ProjectionTest, TheScreensEdgesAreTheImagesEdges) {
  const Projection sut(ScreenConfig{}, 1024, 768);  // 4:3 as the screen
  EXPECT_NEAR(sut.column_of(-0.1524), 0.0, 1e-10);
  EXPECT_NEAR(sut.column_of(0.1524), 1024.0, 1e-10);
  EXPECT_NEAR(sut.row_of(0.1143), 0.0, 1e-10);
  EXPECT_NEAR(sut.row_of(-0.1143), 768.0, 1e-10);
}

TEST(ProjectionTest, TheScreensCentreIsTheImagesCentre) {
  const Projection sut(ScreenConfig{}, 801, 600);
  EXPECT_EQ(sut.column_of(0.0), 400.5);
  EXPECT_EQ(sut.row_of(0.0), 300.0);
}

TEST(ProjectionTest, AMillimetreIsAsManyPixelsUpAsAcross) {
  for (const auto& [columns, rows] : {std::pair{1920, 1080}, {600, 900}, {1024, 768}}) {
    const Projection sut(ScreenConfig{}, columns, rows);
    const double across = sut.column_of(0.001) - sut.column_of(0.0);
    const double up = sut.row_of(0.0) - sut.row_of(0.001);
    EXPECT_NEAR(across, up, 1e-10);
    EXPECT_NEAR(across, sut.pixels_per_metre() / 1000.0, 1e-10);
    // The whole screen is in the image and touches it on two sides.
    EXPECT_GE(sut.column_of(-0.1524), -1e-9);
    EXPECT_GE(sut.row_of(0.1143), -1e-9);
    EXPECT_NEAR(std::min(sut.column_of(-0.1524), sut.row_of(0.1143)), 0.0, 1e-9);
  }
}

TEST(ProjectionTest, PixelsLeadBackToMetres) {
  const Projection sut(ScreenConfig{}, 1920, 1080);
  for (double x_m = -0.15; x_m <= 0.15; x_m += 0.0137) {
    // Rounding at 1000 px is 1e-13 px, at 4700 px/m 2.4e-17 m.
    EXPECT_NEAR(sut.x_of(sut.column_of(x_m)), x_m, 1e-15);
    EXPECT_NEAR(sut.y_of(sut.row_of(x_m)), x_m, 1e-15);
  }
}

TEST(ProjectionTest, ImpossibleImagesAreRefused) {
  EXPECT_THROW(Projection(ScreenConfig{}, 15, 768), ConfigError);
  EXPECT_NO_THROW(Projection(ScreenConfig{}, 16, 768));
  EXPECT_THROW(Projection(ScreenConfig{}, 1024, 0), ConfigError);
  EXPECT_THROW(Projection(ScreenConfig{}, 1 << 20, 768), ConfigError);
  const ScreenConfig flat{.width_m = 0.0};
  EXPECT_THROW(Projection(flat, 1024, 768), ConfigError);
}

}  // namespace stillhand::display::projection_test
