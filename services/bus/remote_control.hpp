// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "services/bus/bus.hpp"
#include "services/core/signal/newest_of_each.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::runtime {

/// How long a verb waits for the answer to a command.  On a busy machine DDS now and then takes
/// more than 3 s to match two participants, and a command takes two matches: there and back.
inline constexpr std::int64_t kAnswerLimit_ns = 15 * kNsPerSecond;

/// Bus options of a verb that is outside of every session.  Each process has a name of its own, so
/// that no session counts two of them as one service that runs twice.
inline Bus::Options outsider(const std::string& verb, std::uint32_t domain,
                             const std::filesystem::path& profiles, bool answers_replay) {
  Bus::Options options;
  options.service = verb + "-" + std::to_string(getpid());
  options.domain = domain;
  options.profiles = profiles;
  options.answers_replay = answers_replay;
  return options;
}

/// The side that carries out commands; its status names the answered command and the answer.
/// next(), answer() and publish() from one thread.
template <typename Command, typename Status>
class RemoteControl {
 public:
  RemoteControl(Bus::Options options, const topics::Topic& commands, const topics::Topic& statuses)
      : bus_(std::move(options)), statuses_(bus_.publisher<Status>(statuses)) {
    bus_.subscribe<Command>(commands, [this](const Command& command, const Arrival& arrival) {
      const std::lock_guard lock(mutex_);
      // ask() writes it again for others.
      if (newest_.take(arrival.participant, command.request())) waiting_.push_back(command);
    });
    bus_.start();
  }
  ~RemoteControl() { bus_.stop_receiving(); }
  RemoteControl(const RemoteControl&) = delete;
  RemoteControl& operator=(const RemoteControl&) = delete;

  /// The oldest command that waits.
  std::optional<Command> next() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return std::nullopt;
    Command command = waiting_.front();
    waiting_.pop_front();
    return command;
  }
  /// @param refusal  why the command was refused; empty: it was carried out
  void answer(const Command& command, const std::string& refusal) {
    constexpr std::size_t kMost = 8;  // that are still waited for
    answers_.emplace_back(command.request(), refusal);
    if (answers_.size() > kMost) answers_.pop_front();
  }
  /// At least one command was answered.
  [[nodiscard]] bool asked() const noexcept { return !answers_.empty(); }
  /// Publishes a status with each of the newest answers.
  void publish(Status status) {
    if (answers_.empty()) statuses_.write(status);
    for (const auto& [request, refusal] : answers_) {
      constexpr std::size_t kRoom = 99;  // string<100> in idl/recording.idl
      status.answered(request);
      status.accepted(refusal.empty());
      status.answer(refusal.substr(0, kRoom));
      statuses_.write(status);
    }
  }
  /// The last status, repeated for half a second: it is best effort, and the sender of a stop may
  /// not be matched with it yet.
  void publish_last(const Status& status) {
    constexpr int kTimes = 10;
    constexpr std::int64_t kPause_ns = 50'000'000;
    for (int i = 0; i < kTimes; ++i) {
      publish(status);
      sleep_until_ns(monotonic_ns() + kPause_ns);
    }
  }
  [[nodiscard]] const std::string& name() const noexcept { return bus_.options().service; }

 private:
  Bus bus_;
  Publisher<Status> statuses_;
  std::mutex mutex_;
  std::deque<Command> waiting_;
  signal::NewestOfEach<ParticipantId> newest_;
  std::deque<std::pair<std::uint64_t, std::string>> answers_;  // request, refusal
};

/// The side that sends commands: sends one to every listener that is found until one answers, and
/// waits at most `limit_ns`.
/// @returns the status with the answer; nothing without an answer
template <typename Command, typename Status>
std::optional<Status> ask(const Bus::Options& options, const topics::Topic& commands,
                          const topics::Topic& statuses, Command command, std::int64_t limit_ns,
                          const Stop& stop) {
  Bus bus(options);
  std::mutex mutex;
  std::optional<Status> answer;
  const auto request = static_cast<std::uint64_t>(monotonic_ns());
  command.request(request);
  Publisher<Command> publisher = bus.publisher<Command>(commands);
  bus.subscribe<Status>(statuses, [&](const Status& status, const Arrival&) {
    const std::lock_guard lock(mutex);
    if (status.answered() == request && !answer) answer = status;
  });
  bus.start();
  const std::int64_t end_ns = monotonic_ns() + limit_ns;
  constexpr std::int64_t kPoll_ns = 10'000'000;
  std::size_t told = 0;
  while (monotonic_ns() < end_ns && !stop.requested()) {
    {
      const std::lock_guard lock(mutex);
      if (answer) break;
    }
    // A command reaches only readers that are matched when it is written; a tap matches, too, and
    // does not answer.
    const std::size_t there = bus.matched_peers(commands).size();
    if (there > told) publisher.write(command);
    told = there;
    sleep_until_ns(monotonic_ns() + kPoll_ns);
  }
  bus.stop_receiving();
  return answer;
}

}  // namespace stillhand::runtime
