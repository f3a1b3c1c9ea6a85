// SPDX-License-Identifier: Apache-2.0
#include "services/processes/display/view_output.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <opencv2/highgui.hpp>

#include "services/core/contract/config_error.hpp"

namespace stillhand::display {
namespace {

constexpr int kEscapeKey = 27;

void check_rate(double rate_hz) {
  if (!(rate_hz >= 1.0 && rate_hz <= 240.0)) {
    throw ConfigError("display.view.rate_hz", std::to_string(rate_hz), "1 to 240 frames a second");
  }
}

constexpr const char* kWantedSession =
    "a graphical session, or no window (--headless): frames can go to a video file";

std::string named(const char* variable) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing here sets a variable
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

/// Qt, which draws OpenCV's windows, ends the whole process when it finds no display: ask first.
void check_display() {
  const std::string want = kWantedSession;
  const std::string platform = named("QT_QPA_PLATFORM");
  if (platform == "offscreen" || platform == "minimal") return;
  const std::string x11 = named("DISPLAY");
  if (x11.empty() && named("WAYLAND_DISPLAY").empty()) {
    throw ConfigError("display.view.window", "neither DISPLAY nor WAYLAND_DISPLAY", want);
  }
  // ":3.0" names a socket of this machine, which is there or not; a remote name can't be checked.
  if (x11.starts_with(':')) {
    const std::string number =
        x11.substr(1, x11.find('.') == x11.npos ? x11.npos : x11.find('.') - 1);
    if (!std::filesystem::exists("/tmp/.X11-unix/X" + number)) {
      throw ConfigError("display.view.window", "DISPLAY=" + x11 + " where no server answers", want);
    }
  }
}

/// Qt alone knows whether a display admits this program, and aborts where it does not.  While this
/// lives, an abort is reported as a refusal, with the exit status of a ConfigError.
class AbortAsRefusal {
 public:
  AbortAsRefusal() {
    const ConfigError refusal(
        "display.view.window",
        "DISPLAY=" + named("DISPLAY") + ", which does not let this program in", kWantedSession);
    std::snprintf(line_, sizeof line_, "stillhand-display: %s\n", refusal.what());
    before_ = std::signal(SIGABRT, &refuse);
  }
  ~AbortAsRefusal() { std::signal(SIGABRT, before_); }
  AbortAsRefusal(const AbortAsRefusal&) = delete;
  AbortAsRefusal& operator=(const AbortAsRefusal&) = delete;

 private:
  using Act = void (*)(int);
  // Only what a signal may do; hence the line made before, and static.
  [[noreturn]] static void refuse(int /*signal*/) {
    constexpr int kRefused = 2;
    _exit(write(STDERR_FILENO, line_, std::strlen(line_)) < 0 ? 1 : kRefused);
  }

  static inline char line_[512];
  Act before_;
};

}  // namespace

FrameFile::FrameFile(const std::string& path, double rate_hz, int columns, int rows) {
  check_rate(rate_hz);
  if (!path.ends_with(".avi")) {
    throw ConfigError("display.view.file", path, "a name that ends in .avi");
  }
  // The first bytes show whether the place can be written at all; OpenCV only says "no".
  std::FILE* probe = std::fopen(path.c_str(), "wb");
  if (probe == nullptr) {
    throw ConfigError("display.view.file", path, "a place that can be written");
  }
  std::fclose(probe);
  const int codec = cv::VideoWriter::fourcc('M', 'J', 'P', 'G');
  if (!video_.open(path, codec, rate_hz, cv::Size(columns, rows), true)) {
    std::filesystem::remove(path);
    throw ConfigError("display.view.file", path, "an OpenCV that writes Motion JPEG");
  }
}

bool FrameFile::write(const cv::Mat& frame) {
  try {
    video_.write(frame);
    return true;
  } catch (const cv::Exception&) {
    return false;
  }
}

ScreenWindow::ScreenWindow(const std::string& title, const Projection& projection, bool full_screen)
    : title_(title), projection_(projection), sized_(full_screen) {
  check_display();
  try {
    const AbortAsRefusal abort_as_refusal;
    cv::namedWindow(title_, cv::WINDOW_NORMAL | cv::WINDOW_KEEPRATIO | cv::WINDOW_GUI_NORMAL);
    if (full_screen) {
      cv::setWindowProperty(title_, cv::WND_PROP_FULLSCREEN, cv::WINDOW_FULLSCREEN);
    }
    cv::setMouseCallback(title_, &ScreenWindow::on_mouse, this);
  } catch (const cv::Exception& error) {
    throw ConfigError("display.view.window", error.err, kWantedSession);
  }
}

ScreenWindow::~ScreenWindow() {
  try {
    cv::destroyWindow(title_);
  } catch (const cv::Exception&) {
    // Closed by its own button: gone already.
  }
}

bool ScreenWindow::show(const cv::Mat& frame) {
  try {
    if (!sized_) cv::resizeWindow(title_, frame.cols, frame.rows);
    sized_ = true;
    cv::imshow(title_, frame);
    // A key a call; a person presses few between two frames.
    for (int key = cv::waitKey(1); key >= 0; key = cv::pollKey()) {
      if (key == kEscapeKey) escape_ = true;
      if (key == 'q') return false;
      if (key == '\r' || key == '\n') keys_.push_back(kEnterKey);
      if (key >= ' ' && key <= '~') keys_.push_back(static_cast<char>(key));
    }
    return cv::getWindowProperty(title_, cv::WND_PROP_VISIBLE) > 0.0;
  } catch (const cv::Exception&) {
    return false;
  }
}

void ScreenWindow::on_mouse(int event, int column, int row, int /*flags*/, void* window) {
  auto& self = *static_cast<ScreenWindow*>(window);
  // A pixel's centre.
  self.pointer_m_ = self.projection_.x_of(column + 0.5);
  if (event == cv::EVENT_LBUTTONDOWN) {
    self.click_ = {self.projection_.x_of(column + 0.5), self.projection_.y_of(row + 0.5)};
  }
}

}  // namespace stillhand::display
