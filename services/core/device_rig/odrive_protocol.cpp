// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/odrive_protocol.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::device_rig::odrive {
namespace {

/// What is sent to an axis.
struct Commands {
  std::string_view torque, arm, idle;
  std::string_view constant;  ///< name of the setting that makes a torque of a current
  const char *axis, *motor, *encoder, *controller;
};
constexpr std::array<Commands, 2> kCommands{
    {{"c 0 ", "w axis0.requested_state 8", "w axis0.requested_state 1",
      "axis0.motor.config.torque_constant", "axis0.error", "axis0.motor.error",
      "axis0.encoder.error", "axis0.controller.error"},
     {"c 1 ", "w axis1.requested_state 8", "w axis1.requested_state 1",
      "axis1.motor.config.torque_constant", "axis1.error", "axis1.motor.error",
      "axis1.encoder.error", "axis1.controller.error"}}};
constexpr std::string_view kClearErrors = "sc";
constexpr std::string_view kSerialNumber = "Serial number: ";

constexpr std::uint64_t kMostFault = 0x7fffffff;

std::uint64_t bits_of(double value) noexcept {
  constexpr double kMost = 1e15;
  return value >= 0.0 && value < kMost ? static_cast<std::uint64_t>(value) : 1u;
}

}  // namespace

OdriveProtocol::OdriveProtocol(const DriveConfig& config, const SettingLimits&)
    : config_(config),
      axis_(config.axis == 0 ? 0 : 1),
      errors_{{{kCommands[config.axis == 0 ? 0 : 1].axis},
               {kCommands[config.axis == 0 ? 0 : 1].motor},
               {kCommands[config.axis == 0 ? 0 : 1].encoder},
               {kCommands[config.axis == 0 ? 0 : 1].controller}}} {}

void OdriveProtocol::clear() noexcept {
  splitter_ = {};
  reader_.clear();
  armed_in_.reset();
  asked_ = Asked::kState;
}

std::string_view OdriveProtocol::order(Order order, double torque_n_m) noexcept {
  lines_.clear();
  asked_ = Asked::kState;
  const std::uint64_t number = reader_.ask();
  if (order == Order::kStop) stop();
  if (order == Order::kTorque) {
    torque(torque_n_m);
    // One command alone arms: a drive whose watchdog tripped stays off, whatever torque comes.
    if (!armed_in_) {
      lines_.add(kClearErrors);
      lines_.add(kCommands[axis_].arm);
      armed_in_ = number;
    }
  } else {
    armed_in_.reset();
  }
  put_questions(lines_, axis_, number);
  return lines_.view();
}

// A torque of before would come back with the next arming.
void OdriveProtocol::stop() noexcept {
  lines_.add(kCommands[axis_].torque, 0.0);
  lines_.add(kCommands[axis_].idle);
  lines_.add(kClearErrors);
}

void OdriveProtocol::torque(double torque_n_m) noexcept {
  const double most_n_m = std::max(config_.max_torque_n_m, 0.0);
  const double bounded_n_m =
      std::isfinite(torque_n_m) ? std::clamp(torque_n_m, -most_n_m, most_n_m) : 0.0;
  lines_.add(kCommands[axis_].torque, armed_in_ ? bounded_n_m / config_.ratio : 0.0);
}

void OdriveProtocol::take(std::string_view bytes, DriveListener& listener) noexcept {
  splitter_.take(bytes, [&](std::string_view line) { take_line(line, listener); });
}

void OdriveProtocol::take_line(std::string_view line, DriveListener& listener) noexcept {
  if (asked_ != Asked::kState) {
    const auto text = read_line(line);
    if (!text) return listener.damaged();
    if (asked_ == Asked::kSetting) take_setting(*text);
    if (asked_ == Asked::kSerial && text->starts_with(kSerialNumber)) {
      serial_ = text->substr(kSerialNumber.size());
    }
    return;
  }
  switch (reader_.take(line)) {
    case AnswerReader::Verdict::kMore:
      return;
    case AnswerReader::Verdict::kDamaged:
      return listener.damaged();
    case AnswerReader::Verdict::kWhole:
      return listener.state(reply_of(reader_.answers()));
  }
}

// Number, value, number: what was under way before stands between other lines.
void OdriveProtocol::take_setting(std::string_view text) noexcept {
  const bool number = whole_of(text) == setting_number_;
  if (number && between_ && !between_->empty() && !answer_) {
    answer_ = between_;
    if (asks_constant_) torque_constant_n_m_a_ = real_of(*answer_).value_or(0.0);
  }
  if (number) {
    between_.emplace();
  } else if (between_ && between_->empty()) {
    between_ = text;
  } else {
    between_.reset();
  }
}

// METHOD Eq. DR-32.
DriveReply OdriveProtocol::reply_of(const Answers& answers) noexcept {
  const Extra extra = extra_of(answers.number);
  errors_[0].bits = answers.axis_error;
  if (extra == Extra::kCurrent) {
    current_a_ = answers.extra;
  } else {
    errors_[1 + static_cast<std::size_t>(extra)].bits = bits_of(answers.extra);
  }
  // An answer to a question of before the axis was armed says nothing of its watchdog: nothing
  // feeds that of an axis which is off.
  const bool armed = armed_in_ && answers.number >= *armed_in_;
  if (!armed) errors_[0].bits &= ~kWatchdogExpired;

  DriveReply reply;
  const auto* const word =
      std::ranges::find_if(errors_, [](const Word& each) { return each.bits != 0; });
  if ((errors_[0].bits & kWatchdogExpired) != 0) {
    reply.mode = DriveMode::kTimedOut;
  } else if (word != errors_.end()) {
    reply.mode = DriveMode::kFault;
    reply.fault = static_cast<int>(std::min<std::uint64_t>(word->bits, kMostFault));
    reply.fault_word = word->name;
  } else if (answers.state == kClosedLoop) {
    reply.mode = DriveMode::kTorque;
  } else {
    reply.mode = answers.state == kIdle ? DriveMode::kOff : DriveMode::kOther;
  }
  reply.position_rev = answers.position_turns / config_.ratio;
  reply.velocity_rev_s = answers.velocity_turns_s / config_.ratio;
  reply.torque_n_m = current_a_ * torque_constant_n_m_a_ * config_.ratio;
  reply.milliseconds = static_cast<int>(answers.uptime_ms & 0xffffu);
  reply.whole = true;
  return reply;
}

std::string_view OdriveProtocol::ask(std::string_view name) noexcept {
  answer_.reset();
  between_.reset();
  asked_ = Asked::kSetting;
  asks_constant_ = name == kCommands[axis_].constant;
  setting_number_ = reader_.ask();
  reader_.clear();
  std::array<char, 80> question{'r', ' '};
  const std::size_t size = std::min(name.size(), question.size() - 2);
  std::ranges::copy(name.substr(0, size), question.begin() + 2);
  lines_.clear();
  lines_.add("w test_property ", setting_number_);
  lines_.add("r test_property");
  lines_.add(std::string_view(question.data(), size + 2));
  lines_.add("r test_property");
  return lines_.view();
}

std::optional<SettingFault> OdriveProtocol::judge(std::string_view name,
                                                  std::string_view text) const {
  return judge_setting(name, text, config_);
}

std::string_view OdriveProtocol::ask_serial() noexcept {
  serial_.reset();
  asked_ = Asked::kSerial;
  reader_.clear();
  lines_.clear();
  lines_.add("i");
  return lines_.view();
}

}  // namespace stillhand::device_rig::odrive
