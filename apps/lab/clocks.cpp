// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/clocks.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "idl/topics.hpp"
#include "services/bus/clock_answer.hpp"
#include "services/core/contract/time_difference.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::lab {
namespace {

constexpr std::chrono::milliseconds kEvery{250};
constexpr std::int64_t kPublishEvery = 4;  // questions
// A system clock is read together with the monotonic one: a larger difference is a jump.
constexpr std::int64_t kSystemStep_ns = 1'000'000;

}  // namespace

Clocks::Clocks(runtime::Service& service)
    : service_(service),
      questions_(service.bus().publisher<stillhand_msgs::ClockQuestion>(topics::kClockQuestion)),
      offsets_(service.bus().publisher<stillhand_msgs::ClockOffset>(topics::kClockOffset)),
      identity_(runtime::clock_identity()) {
  service.bus().subscribe<stillhand_msgs::ClockAnswer>(
      topics::kClockAnswer, [this](const stillhand_msgs::ClockAnswer& answer,
                                   const runtime::Arrival& arrival) { take(answer, arrival); });
}

Clocks::~Clocks() {
  worker_.request_stop();
  if (worker_.joinable()) worker_.join();
}

void Clocks::start() {
  worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

void Clocks::work(const std::stop_token& stop) {
  runtime::become_background();
  for (std::int64_t number = 0; !stop.stop_requested(); ++number) {
    stillhand_msgs::ClockQuestion question;
    question.number(number);
    questions_.write(question);
    if (number % kPublishEvery == 0) publish();
    std::mutex unshared;
    std::unique_lock lock(unshared);
    wake_.wait_for(lock, stop, kEvery, [] { return false; });
  }
}

void Clocks::take(const stillhand_msgs::ClockAnswer& answer, const runtime::Arrival& arrival) {
  const std::string who = answer.service().c_str();
  if (!topics::is_service(who)) return;  // a stranger
  const std::lock_guard lock(mutex_);
  Other& other = others_[who];
  other.same_clock = identity_ == answer.clock().c_str();
  // Of clocks of one kind: the two kinds are some fifty years apart, and a difference ends at
  // thirty.
  const std::int64_t system_ahead_ns =
      difference_ns(difference_ns(answer.system_ns(), arrival.logged_ns),
                    difference_ns(answer.stamp_ns(), arrival.received_ns));
  const std::int64_t moved_ns = difference_ns(system_ahead_ns, other.system_ahead_ns);
  if (other.answered && std::abs(moved_ns) > kSystemStep_ns) {
    ++other.system_steps;
    report(
        stillhand_msgs::EVENT_CLOCK_STEPPED, who,
        fmt::format("its system clock jumped by {:+.1f} ms", 1e-6 * static_cast<double>(moved_ns)));
  }
  other.system_ahead_ns = system_ahead_ns;
  other.answered = true;
  if (const auto step_ns = other.comparison.take(
          {answer.asked_ns(), answer.received_ns(), answer.stamp_ns(), arrival.received_ns})) {
    report(stillhand_msgs::EVENT_CLOCK_STEPPED, who,
           fmt::format("its monotonic clock jumped by {:+.1f} ms",
                       1e-6 * static_cast<double>(*step_ns)));
  }
}

void Clocks::publish() {
  const std::lock_guard lock(mutex_);
  const std::int64_t now_ns = runtime::monotonic_ns();
  for (auto& [who, other] : others_) {
    const auto offset = other.comparison.offset(now_ns);
    if (!offset) continue;
    stillhand_msgs::ClockOffset message;
    message.service(who);
    message.same_clock(other.same_clock);
    message.offset_ns(other.same_clock ? 0 : offset->offset_ns);
    message.uncertainty_ns(other.same_clock ? 0.0 : offset->uncertainty_ns);
    message.drift_ppm(offset->drift_ppm);
    message.drift_sigma_ppm(std::isfinite(offset->drift_sigma_ppm) ? offset->drift_sigma_ppm : 0.0);
    message.round_trip_ns(offset->round_trip_ns);
    message.system_offset_ns(message.offset_ns() + other.system_ahead_ns);
    message.steps(static_cast<std::int32_t>(offset->steps + other.system_steps));
    offsets_.write(message);
    service_.bus().set_clock_offset(who, message.offset_ns());
    if (offset->drifts() && !other.drift_reported) {
      other.drift_reported = true;
      report(stillhand_msgs::EVENT_CLOCK_DRIFTS, who,
             fmt::format("its clock drifts by {:+.0f} ppm", offset->drift_ppm));
    }
  }
}

void Clocks::report(stillhand_msgs::EventKind kind, const std::string& who,
                    const std::string& what) {
  service_.note_event(kind, fmt::format("{}: {}", who, what).c_str());
}

}  // namespace stillhand::lab
