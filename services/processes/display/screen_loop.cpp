// SPDX-License-Identifier: Apache-2.0
#include "services/processes/display/screen_loop.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/processes/display/view_opencv.hpp"
#include "services/processes/display/view_output.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::display {
namespace {

constexpr int kColumns = 1024;  // a 15 inch monitor of the paper's day, 4:3
constexpr int kRows = 768;
constexpr double kRate_hz = 60.0;
// With no new tick for this long the picture is old.
constexpr std::int64_t kLinkLost_ns = 100'000'000;
// An emergency stop is repeated with every frame for this long.
constexpr std::int64_t kRepeated_ns = 1'000'000'000;

// An answer is repeated this often until the next prompt.
constexpr std::int64_t kAnswerPeriod_ns = 300'000'000;

Moment moment_of(const Shown& shown, bool fresh, bool gamepad) {
  return {shown.tick, shown.trial, shown.paused, fresh, gamepad};
}

}  // namespace

/// View, file and window together; drawn and shown with ordinary priority.
class ScreenLoop::Screen {
 public:
  Screen(Shell& shell, const ScreenOptions& options)
      : shell_(shell),
        view_(shell.config(), kColumns, kRows),
        gamepad_(!options.gamepad.empty()),
        rig_(options.rig) {
    if (!options.video.empty()) file_.emplace(options.video.string(), kRate_hz, kColumns, kRows);
    if (options.window) window_.emplace("Stillhand", view_.projection(), false);
  }

  /// @param pressed  on a gamepad since the frame before
  /// @return false once the window was closed.
  bool show(const Shown& shown, bool fresh, const std::vector<PadAct>& pressed) {
    take_prompt();
    Page page = page_of(prompt_, moment_of(shown, fresh, gamepad_), answering_);
    page.rig = rig_;
    const cv::Mat& frame = view_.draw(shown.sample, page);
    // Frames of a session that has not begun, or of a disk that is full, are not kept.
    if (file_ && shown.tick >= 0 && !file_->write(frame)) {
      shell_.service().note_event(stillhand_msgs::EVENT_NOTE, "the video cannot be written");
      file_.reset();
    }
    if (!window_) return true;
    const bool open = window_->show(frame);
    take_acts(page);
    if (!page.button.empty()) take_pressed(pressed);
    if (!open && prompt_.kind == PromptKind::kEnd) {  // its button closes it, and so may anything
      answering_.confirm();
      window_.reset();
      return true;
    }
    return open;
  }
  [[nodiscard]] const std::optional<Answering::Answer>& answer() const noexcept {
    return answering_.answer();
  }
  [[nodiscard]] bool escape_pressed() { return window_ && window_->escape_pressed(); }
  [[nodiscard]] std::optional<double> pointer_m() const {
    return window_ ? window_->pointer_m() : std::nullopt;
  }

 private:
  void take_prompt() {
    const stillhand_msgs::Prompt& newest = shell_.prompt();
    if (newest.number() != prompt_.number) prompt_ = from_idl(newest);
    answering_.show(prompt_);
  }
  // What the participant did to the frame that is shown.  Keys count while it has a button: nobody
  // answers what is not on the screen.
  void take_acts(const Page& page) {
    const auto keys = window_->keys();
    for (const char key : keys) {
      if (page.button.empty()) break;
      if (key >= '1' && key <= '9') answering_.choose(key - '0');
      if (key == kEnterKey || key == ' ') answering_.confirm();
    }
    const auto click = window_->click();
    if (!click) return;
    const auto box = view_.box_at(click->x_m, click->y_m);
    if (box == kButton) answering_.confirm();
    if (box) answering_.choose(*box);
  }

  void take_pressed(const std::vector<PadAct>& pressed) {
    for (const PadAct act : pressed) {
      if (act == PadAct::kLeft) answering_.move(-1);
      if (act == PadAct::kRight) answering_.move(1);
      if (act == PadAct::kConfirm) answering_.confirm();
    }
  }

  Shell& shell_;
  TrackingView view_;
  bool gamepad_;
  std::string rig_;
  Prompt prompt_;
  Answering answering_;
  std::optional<FrameFile> file_;
  std::optional<ScreenWindow> window_;
};

ScreenLoop::ScreenLoop(Shell& shell, ScreenOptions options)
    : shell_(shell),
      options_(std::move(options)),
      pointer_(shell.service().bus().publisher<stillhand_msgs::Pointer>(topics::kPointer)) {
  if (!options_.window && options_.video.empty()) return;
  if (!options_.gamepad.empty()) gamepad_.emplace(options_.gamepad);
  const runtime::OrdinaryWhile ordinary;  // OpenCV's own threads inherit it
  screen_ = std::make_unique<Screen>(shell_, options_);
}

ScreenLoop::~ScreenLoop() = default;

void ScreenLoop::run() {
  runtime::Stop& stop = shell_.service().stop();
  if (!screen_) {
    stop.wait();
    return;
  }
  runtime::become_background();
  constexpr auto kPeriod_ns = static_cast<std::int64_t>(1e9 / kRate_hz);
  std::int64_t due_ns = runtime::monotonic_ns();
  Tick last_tick = -1;
  std::int64_t fresh_ns = due_ns;
  while (!stop.requested()) {
    due_ns = std::max(due_ns + kPeriod_ns, runtime::monotonic_ns());
    runtime::sleep_until_ns(due_ns);
    const Shown& shown = shell_.shown();
    if (shown.tick != last_tick) fresh_ns = due_ns;
    last_tick = shown.tick;
    bool open = true;
    {
      const runtime::OrdinaryWhile ordinary;
      open = screen_->show(shown, due_ns - fresh_ns < kLinkLost_ns,
                           gamepad_ ? gamepad_->acts() : std::vector<PadAct>());
    }
    // The window stays: the session ends by itself, and the subject sees why.
    if (screen_->escape_pressed()) escape_ns_ = due_ns;
    if (escape_ns_ && due_ns - *escape_ns_ < kRepeated_ns) shell_.stop_at_once();
    if (screen_->answer() && due_ns - answered_ns_ >= kAnswerPeriod_ns) {
      shell_.answer(*screen_->answer());
      answered_ns_ = due_ns;
    }
    // This process ends, and with it the session; the experiment quotes the line.
    if (!open) throw std::runtime_error("the tracking window was closed");
    if (options_.pointer) publish_pointer(shown.tick, pointed_m());
  }
}

// The whole axis is the whole width of the screen.
std::optional<double> ScreenLoop::pointed_m() {
  if (!gamepad_) return screen_->pointer_m();
  const std::optional<double> share = gamepad_->position();
  if (!share) return std::nullopt;
  return *share * 0.5 * shell_.config().screen.width_m;
}

void ScreenLoop::publish_pointer(Tick tick, std::optional<double> position_m) {
  stillhand_msgs::Pointer message;
  message.tick(tick);
  message.position_m(position_m.value_or(std::numeric_limits<double>::quiet_NaN()));
  message.inside_window(position_m.has_value());
  pointer_.write(message);
}

}  // namespace stillhand::display
