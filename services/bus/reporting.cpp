// SPDX-License-Identifier: Apache-2.0
#include "services/bus/reporting.hpp"

#include <sched.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <map>
#include <string>
#include <tuple>

#include "services/system/process/real_time.hpp"

namespace stillhand::runtime {
namespace {

constexpr std::chrono::milliseconds kStatusPeriod{100};
constexpr int kHostPeriod = 10;  // statuses

stillhand_msgs::TopicStatus to_idl(const EndpointReport& report) {
  stillhand_msgs::TopicStatus status;
  status.topic(std::string(report.topic->name));
  status.written(report.written);
  status.matched(report.matched);
  status.samples(report.samples);
  status.lost_ticks(report.lost_ticks);
  status.cycle_misses(report.cycle_misses);
  status.deadline_misses(report.deadline_misses);
  status.worst_interval_us(report.worst_interval_us);
  status.latency_p50_us(report.latency_p50_us);
  status.latency_p99_us(report.latency_p99_us);
  status.latency_max_us(report.latency_max_us);
  return status;
}

struct Memory {
  std::uint64_t resident_bytes = 0;
  bool locked = false;
};

// proc(5): "VmLck:", "VmRSS:", in kB.
Memory memory_of_process() {
  constexpr std::uint64_t kBytes = 1024;
  Memory memory;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kilobytes = 0;
    if (word == "VmRSS:" && status >> kilobytes) memory.resident_bytes = kilobytes * kBytes;
    if (word == "VmLck:" && status >> kilobytes) memory.locked = kilobytes > 0;
  }
  return memory;
}

std::string host_name() {
  std::array<char, 65> name{};  // string<64> in idl/session.idl
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

// The main thread's, which the receiving threads inherited.
int priority_of_process() {
  sched_param parameter{};
  if (const int policy = sched_getscheduler(getpid()); policy != SCHED_FIFO && policy != SCHED_RR) {
    return 0;
  }
  return sched_getparam(getpid(), &parameter) == 0 ? parameter.sched_priority : 0;
}

}  // namespace

Reporter::Reporter(Bus& bus, std::function<void(stillhand_msgs::ServiceStatus&)> complete)
    : bus_(bus),
      complete_(std::move(complete)),
      events_(bus.publisher<stillhand_msgs::Event>(topics::kEvent)),
      statuses_(bus.publisher<stillhand_msgs::ServiceStatus>(topics::kServiceStatus)),
      host_statuses_(bus.publisher<stillhand_msgs::HostStatus>(topics::kHostStatus)) {}

void Reporter::stop() {
  worker_.request_stop();
  if (worker_.joinable()) worker_.join();
}

void Reporter::start() {
  worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

void Reporter::publish(const Note& note) noexcept {
  if (!queue_.bounded_push(note)) dropped_.fetch_add(1, std::memory_order_relaxed);
}

void Reporter::work(const std::stop_token& stop) {
  become_background();
  for (int turn = 0; !stop.stop_requested(); ++turn) {
    publish_events();
    publish_status();
    if (turn % kHostPeriod == 0) publish_host_status();
    // systemd's watchdog, where the process is a unit's: it bites when this life sign ends.
    sd_notify(0, "WATCHDOG=1");
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, stop, kStatusPeriod, [] { return false; });
  }
  publish_events();
}

void Reporter::publish_events() {
  struct Merged {
    Note note;
    int count;
  };
  // Kind, code, topic, peer, text.
  using Key = std::tuple<stillhand_msgs::EventKind, stillhand_msgs::EventCode, const topics::Topic*,
                         std::string, std::string>;
  std::map<Key, Merged> merged;
  Note note{};
  while (queue_.pop(note)) {
    const auto [place, first] = merged.try_emplace(
        Key{note.kind, note.code, note.topic, note.peer, note.text}, Merged{note, 0});
    ++place->second.count;
    place->second.note.by_us = std::max(place->second.note.by_us, note.by_us);
  }
  for (const auto& [key, entry] : merged) {
    stillhand_msgs::Event event;
    event.kind(entry.note.kind);
    event.code(entry.note.code);
    event.tick(entry.note.tick);
    event.source(bus_.options().service);
    event.topic(entry.note.topic == nullptr ? std::string() : std::string(entry.note.topic->name));
    event.peer(std::string(entry.note.peer));
    event.by_us(entry.note.by_us);
    std::string text = entry.note.text;
    if (entry.count > 1)
      text += (text.empty() ? "" : ", ") + std::to_string(entry.count) + " times";
    event.text(text);
    events_.write(event);
  }
  if (const std::uint64_t dropped = dropped_.exchange(0); dropped > 0) {
    stillhand_msgs::Event event;
    event.kind(stillhand_msgs::EVENT_NOTE);
    event.tick(-1);
    event.source(bus_.options().service);
    event.text(std::to_string(dropped) + " events dropped, more than 256 in a tenth of a second");
    events_.write(event);
  }
}

void Reporter::publish_status() {
  bus_.note_silence();
  stillhand_msgs::ServiceStatus status;
  status.service(bus_.options().service);
  status.pid(static_cast<std::uint32_t>(getpid()));
  std::string missing;
  for (const std::string& peer : bus_.missing_peers()) {
    missing += (missing.empty() ? "" : ", ") + peer;
  }
  status.state(missing.empty() ? stillhand_msgs::SERVICE_READY : stillhand_msgs::SERVICE_STARTING);
  constexpr std::size_t kRoom = 199;  // string<200> in idl/session.idl
  status.missing(missing.substr(0, kRoom));
  constexpr std::size_t kMostTopics = 32;  // sequence<TopicStatus, 32> there
  for (const EndpointReport& report : bus_.report()) {
    if (status.topics().size() < kMostTopics) status.topics().push_back(to_idl(report));
  }
  complete_(status);
  statuses_.write(status);
}

void Reporter::publish_host_status() {
  static const std::string kHost = host_name();
  const Memory memory = memory_of_process();
  stillhand_msgs::HostStatus status;
  status.service(bus_.options().service);
  status.host(kHost);
  status.cores(static_cast<std::uint32_t>(sysconf(_SC_NPROCESSORS_ONLN)));
  status.host_cpu_share(host_cpu_.step());
  status.process_cpu_share(process_cpu_.step());
  status.priority(priority_of_process());
  status.memory_locked(memory.locked);
  status.resident_bytes(memory.resident_bytes);
  host_statuses_.write(status);
}

}  // namespace stillhand::runtime
