// SPDX-License-Identifier: Apache-2.0
#include "apps/ros2_bridge/ros2_bridge.hpp"

#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <utility>

#include "apps/libraries/ros2/converter.hpp"
#include "services/bus/ros2_writers.hpp"
#include "services/bus/tap.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::ros2_bridge {
namespace {

constexpr std::chrono::milliseconds kPoll{20};
// Half a second of a session: 4 topics at 1 kHz.
constexpr std::size_t kMostWaiting = 2000;

struct Sample {
  std::string topic;
  std::uint64_t time_ns = 0;
  std::vector<std::byte> bytes;
};

/// Samples on their way from the bus's threads to the one that writes.  put() never waits for that
/// one: when it is slow, the newest samples are dropped and counted.
class Waiting {
 public:
  void put(Sample sample) {
    const std::lock_guard lock(mutex_);
    if (samples_.size() >= kMostWaiting) {
      ++dropped_;
      return;
    }
    samples_.push_back(std::move(sample));
    came_.notify_one();
  }
  /// All that wait, after kPoll at the latest.
  std::deque<Sample> take() {
    std::unique_lock lock(mutex_);
    came_.wait_for(lock, kPoll, [this] { return !samples_.empty(); });
    return std::exchange(samples_, {});
  }
  [[nodiscard]] std::uint64_t dropped() {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<Sample> samples_;
  std::uint64_t dropped_ = 0;
};

/// The topics of ROS 2, each made with its first message.
class Published {
 public:
  explicit Published(const BridgeOptions& options)
      : writers_(options.ros_domain, "stillhand_ros2_bridge", addresses(options)) {
    fmt::print("domain {} of ROS 2, on {}{}\n", options.ros_domain,
               fmt::join(addresses(options), ", "),
               options.addresses.empty() ? ": nodes with default settings need --ros-address" : "");
    std::fflush(stdout);
  }

  void write(const ros2::Message& message) {
    auto found = topics_.find(message.topic);
    if (found == topics_.end()) {
      const ros2::Definition& type = *message.type;
      const Topic topic{writers_.add(message.topic, ros2::dds_type(type), type.hash), type.name};
      found = topics_.emplace(message.topic, topic).first;
    }
    ++(writers_.write(found->second.writer, message.cdr) ? found->second.messages : refused_);
  }
  void print_readers() {
    for (auto& [name, topic] : topics_) {
      const std::int64_t readers = writers_.matched(topic.writer);
      if (std::exchange(topic.readers, readers) == readers) continue;
      fmt::print("{}  {}  {} reader{}\n", name, topic.type, readers, readers == 1 ? "" : "s");
      std::fflush(stdout);
    }
  }
  void print_counts() const {
    for (const auto& [name, topic] : topics_) fmt::print("{:<40} {:>12}\n", name, topic.messages);
    std::fflush(stdout);
  }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  [[nodiscard]] bool empty() const { return topics_.empty(); }

 private:
  // Always the loopback too: Fast DDS sends there what is for an address of its own machine.
  static std::vector<std::string> addresses(const BridgeOptions& options) {
    std::vector<std::string> all{"127.0.0.1"};
    all.insert(all.end(), options.addresses.begin(), options.addresses.end());
    return all;
  }

  struct Topic {
    std::size_t writer;
    std::string type;
    std::uint64_t messages = 0;
    std::int64_t readers = -1;  ///< printed last
  };
  runtime::Ros2Writers writers_;
  std::map<std::string, Topic> topics_;
  std::uint64_t refused_ = 0;
};

/// One run of the verb.
class Run {
 public:
  Run(const BridgeOptions& options, runtime::Stop& stop)
      : options_(options),
        stop_(stop),
        filter_{options.topics, {}},
        tap_(tap_options()),
        published_(options) {}

  /// @returns the exit status
  int operator()() {
    tap_.start();
    while (!stop_.requested()) {
      for (const Sample& sample : waiting_.take()) convert(sample);
      published_.print_readers();
      if (other_kind_.load(std::memory_order_relaxed) && !std::exchange(said_, true)) {
        runtime::remark(options_.replay
                            ? "a session runs on this domain; without --replay it is published"
                            : "a replay runs on this domain; --replay publishes it");
      }
    }
    tap_.stop();
    published_.print_counts();
    return print_faults() ? 1 : 0;
  }

 private:
  runtime::Tap::Options tap_options() {
    runtime::Tap::Options tap;
    tap.name = fmt::format("stillhand-ros2-bridge/{}", getpid());
    tap.domain = options_.domain;
    tap.profiles = options_.profiles;
    tap.security = options_.security;
    tap.wanted = [this](const std::string& topic) {
      return filter_.wants(topic) &&
             std::ranges::find(ros2::sources(), topic) != ros2::sources().end();
    };
    tap.on_sample = [this](const runtime::FoundWriter& writer,
                           const runtime::TappedSample& sample) {
      if (writer.replayed != options_.replay) {
        other_kind_.store(true, std::memory_order_relaxed);
        return;
      }
      waiting_.put({writer.topic,
                    static_cast<std::uint64_t>(sample.logged_ns),
                    {sample.bytes.begin(), sample.bytes.end()}});
    };
    return tap;
  }

  void convert(const Sample& sample) {
    const auto messages = ros2::converted(sample.topic, sample.bytes, sample.time_ns);
    if (!messages) {
      ++unread_;
      return;
    }
    for (const ros2::Message& each : *messages) published_.write(each);
  }

  /// @returns true when a message was left out
  bool print_faults() {
    std::vector<std::string> faults = tap_.trouble();
    const auto count = [&faults](std::uint64_t messages, const char* why) {
      if (messages > 0) faults.push_back(fmt::format("{} messages {}", messages, why));
    };
    count(waiting_.dropped(), "were dropped: this machine is too slow for them");
    count(unread_, "do not match their type");
    count(published_.refused(), "were refused by DDS");
    for (const std::string& fault : faults) runtime::remark(fault);
    if (published_.empty()) {
      runtime::remark(fmt::format("no message was published: domain {} had none of the topics",
                                  options_.domain));
    }
    return !faults.empty() || published_.empty();
  }

  const BridgeOptions& options_;
  runtime::Stop& stop_;
  recording::TopicFilter filter_;
  Waiting waiting_;
  std::atomic<bool> other_kind_{false};  ///< of samples came: a replay's, or a session's
  bool said_ = false;
  std::uint64_t unread_ = 0;
  runtime::Tap tap_;  // its threads use the members above
  Published published_;
};

}  // namespace

int run_bridge(const BridgeOptions& options, runtime::Stop& stop) {
  Run run(options, stop);
  return run();
}

}  // namespace stillhand::ros2_bridge
