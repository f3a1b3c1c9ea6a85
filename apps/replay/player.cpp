// SPDX-License-Identifier: Apache-2.0
#include "apps/replay/player.hpp"

#include <algorithm>

#include "services/system/process/clock.hpp"

namespace stillhand::replay {

using recording::HeldMessage;
using runtime::monotonic_ns;

namespace {

// What is due sooner is waited for asleep, and the keyboard waits; later, the keyboard is asked.
constexpr std::int64_t kHorizon_ns = 2'000'000;
constexpr std::int64_t kLongestWait_ns = 20'000'000;
// A message that is later than this counts as a delay by the machine.
constexpr std::int64_t kHeldUp_ns = 10'000'000;

}  // namespace

Player::Player(MessageSource& source, std::uint64_t first_ns, std::uint64_t last_ns,
               recording::PlayRate rate, bool loop, Release release)
    : source_(source),
      first_ns_(first_ns),
      last_ns_(last_ns),
      loop_(loop),
      release_(std::move(release)),
      clock_(0, static_cast<std::int64_t>(first_ns), rate),
      loop_from_ns_(first_ns),
      end_ns_(last_ns) {}

void Player::begin(bool paused) {
  if (paused) clock_.pause(0);  // before it runs: the position is the first instant exactly
  jump(first_ns_);
}

// The clock starts again when the first stretch has been read: reading is not lateness.
void Player::jump(std::uint64_t to_ns) {
  end_ns_ = loop_to_ns_ && *loop_to_ns_ > to_ns ? *loop_to_ns_ : last_ns_;
  source_.seek(to_ns, end_ns_);
  stretch_ = source_.wait_next();  // the state before
  next_ = 0;
  if (stretch_.batch.messages.empty()) stretch_ = source_.wait_next();
  clock_.seek(monotonic_ns(), static_cast<std::int64_t>(to_ns));
  newest_.reset();
}

/// @returns false when the next stretch is not there yet, or nothing follows
bool Player::fetch() {
  while (next_ >= stretch_.batch.messages.size()) {
    if (stretch_.last) return false;
    std::optional<Stretch> following = source_.next();
    if (!following) return false;
    stretch_ = std::move(*following);
    next_ = 0;
  }
  return true;
}

std::optional<std::int64_t> Player::step() {
  const std::int64_t end_ns = monotonic_ns() + kHorizon_ns;
  while (!clock_.paused()) {
    if (!fetch()) {
      if (!stretch_.last) return kHorizon_ns / 4;
      if (!loop_ && !loop_to_ns_) return std::nullopt;
      jump(loop_from_ns_);
      return 0;
    }
    const std::int64_t due_ns = *clock_.due(static_cast<std::int64_t>(front().log_time_ns));
    // A burst of overdue messages would overrun the readers' histories (16 samples at 1 kHz): at
    // most twice as fast until the schedule is met again.
    const std::int64_t when_ns =
        newest_ ? std::max(due_ns, newest_->released_ns + (due_ns - newest_->due_ns) / 2) : due_ns;
    if (when_ns > end_ns) {
      return std::min(when_ns - kHorizon_ns - monotonic_ns(), kLongestWait_ns);
    }
    if (when_ns > monotonic_ns()) runtime::sleep_until_ns(when_ns);
    const std::int64_t now_ns = monotonic_ns();
    release_next();
    errors_.add(now_ns - due_ns);
    const bool late = now_ns - due_ns > kHeldUp_ns;
    if (late && !late_) ++held_up_;
    late_ = late;
    newest_ = Released{now_ns, due_ns};
    if (now_ns > end_ns) return 0;
  }
  return kLongestWait_ns;
}

void Player::release_next() {
  const HeldMessage& message = front();
  release_(message, stretch_.batch.content(message));
  ++next_;
  ++released_;
}

void Player::set_paused(bool paused) {
  if (paused) {
    clock_.pause(monotonic_ns());
  } else {
    clock_.resume(monotonic_ns());
  }
  newest_.reset();
}

void Player::set_rate(recording::PlayRate rate) {
  clock_.set_rate(monotonic_ns(), rate);
  newest_.reset();
}

void Player::seek(std::int64_t to_ns) {
  jump(static_cast<std::uint64_t>(std::clamp(to_ns, static_cast<std::int64_t>(first_ns_),
                                             static_cast<std::int64_t>(last_ns_))));
}

void Player::step_once() {
  if (!clock_.paused() || !fetch()) return;
  clock_.seek(monotonic_ns(), static_cast<std::int64_t>(front().log_time_ns));
  release_next();
}

std::int64_t Player::position_ns() const noexcept {
  return std::clamp(clock_.recorded_at(monotonic_ns()), static_cast<std::int64_t>(first_ns_),
                    static_cast<std::int64_t>(end_ns_));
}

void Player::loop_from_here() { loop_from_ns_ = static_cast<std::uint64_t>(position_ns()); }

void Player::loop_to_here() {
  const auto here_ns = static_cast<std::uint64_t>(position_ns());
  if (here_ns <= loop_from_ns_) return;
  loop_between(static_cast<std::int64_t>(loop_from_ns_), static_cast<std::int64_t>(here_ns));
}

void Player::loop_between(std::int64_t from_ns, std::int64_t to_ns) {
  loop_from_ns_ = static_cast<std::uint64_t>(from_ns);
  loop_to_ns_ = static_cast<std::uint64_t>(to_ns);
  jump(loop_from_ns_);
}

void Player::loop_off() {
  loop_ = false;
  loop_to_ns_.reset();
  loop_from_ns_ = first_ns_;
  jump(static_cast<std::uint64_t>(position_ns()));
}

}  // namespace stillhand::replay
