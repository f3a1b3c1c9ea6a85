// SPDX-License-Identifier: Apache-2.0
#include "services/bus/clock_answer.hpp"

#include <filesystem>
#include <fstream>

#include "idl/clock.h"

namespace stillhand::runtime {

std::string clock_identity() {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  std::error_code none;
  return boot + ' ' + std::filesystem::read_symlink("/proc/self/ns/time", none).string();
}

void answer_clock_questions(Bus& bus) {
  auto answers = bus.publisher<stillhand_msgs::ClockAnswer>(topics::kClockAnswer);
  stillhand_msgs::ClockAnswer answer;
  answer.service(bus.options().service);
  answer.clock(clock_identity());
  // Answered in the receiving thread: a question that waits for another gives a less certain
  // offset.
  bus.subscribe<stillhand_msgs::ClockQuestion>(
      topics::kClockQuestion, [answers, answer](const stillhand_msgs::ClockQuestion& question,
                                                const Arrival& arrival) mutable {
        answer.number(question.number());
        answer.asked_ns(question.stamp_ns());
        answer.received_ns(arrival.received_ns);
        answer.system_ns(system_ns());
        answers.write(answer);
      });
  bus.subscribe<stillhand_msgs::ClockOffset>(
      topics::kClockOffset, [&bus](const stillhand_msgs::ClockOffset& offset, const Arrival&) {
        bus.set_clock_offset(offset.service().c_str(), offset.offset_ns());
      });
}

}  // namespace stillhand::runtime
