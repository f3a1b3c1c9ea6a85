// SPDX-License-Identifier: Apache-2.0
#include "services/processes/display/view_output.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/processes/display/view_opencv.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::display::view_output_test {

constexpr int kColumns = 640;
constexpr int kRows = 480;

class FrameFileTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }

  TrackingView view_{TrackingDisplay::Config{}, kColumns, kRows};

 private:
  const support::Folder folder_;
};

// Motion JPEG loses detail: quality 95 leaves a few levels of mean error, far below the 30 or so
// that another frame, with its box elsewhere, would make over the lines' own area.
TEST_F(FrameFileTest, AVideoPlaysTheFramesBack) {
  const cv::Mat last = view_.draw({0.05, 0.02, false, kGood}, {}).clone();
  {
    FrameFile sut(path("screen.avi"), 60.0, kColumns, kRows);
    for (int i = 0; i < 30; ++i) {
      ASSERT_TRUE(sut.write(i == 29 ? last : view_.draw({0.001 * i, 0.0, true, kGood}, {})));
    }
  }
  cv::VideoCapture video(path("screen.avi"));
  ASSERT_TRUE(video.isOpened());
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 60.0, 0.01);
  cv::Mat frame;
  cv::Mat read;
  int frames = 0;
  while (video.read(read)) {
    frame = read.clone();
    ++frames;
  }
  EXPECT_EQ(frames, 30);
  ASSERT_EQ(frame.size(), last.size());
  EXPECT_LT(cv::norm(frame, last, cv::NORM_L1), 0.2 * cv::norm(last, cv::NORM_L1));
}

TEST_F(FrameFileTest, WhatCannotBeWrittenIsRefusedBeforeTheRun) {
  EXPECT_THROW(FrameFile("/nonexistent/screen.avi", 60.0, kColumns, kRows), ConfigError);
  EXPECT_THROW(FrameFile(path("screen.gif"), 60.0, kColumns, kRows), ConfigError);
  EXPECT_THROW(FrameFile(path("screen.avi"), 0.0, kColumns, kRows), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(path("screen.gif")));
}

TEST(ScreenWindowTest, WithoutADisplayItIsRefusedInsteadOfEndingTheProcess) {
  ::unsetenv("WAYLAND_DISPLAY");
  ::unsetenv("QT_QPA_PLATFORM");
  const Projection projection(ScreenConfig{}, kColumns, kRows);
  ::unsetenv("DISPLAY");
  EXPECT_THROW(ScreenWindow("screen", projection, false), ConfigError);
  ::setenv("DISPLAY", ":4711", 1);
  EXPECT_THROW(ScreenWindow("screen", projection, false), ConfigError);
}

}  // namespace stillhand::display::view_output_test
