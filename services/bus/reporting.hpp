// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <boost/lockfree/queue.hpp>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "idl/session.h"
#include "services/bus/bus.hpp"
#include "services/system/process/cpu_share.hpp"

namespace stillhand::runtime {

/// One event, plain enough to leave a control path without lock or allocation.
struct Note {
  stillhand_msgs::EventKind kind;
  stillhand_msgs::EventCode code;
  const topics::Topic* topic;  ///< nullptr: none
  Tick tick;
  double by_us;
  char peer[32];
  char text[128];
};

/// Publishes this process's status ten times a second, its host's once a second, and its events as
/// they occur; equal events within a tenth of a second become one, with their number and the worst
/// figure.
class Reporter {
 public:
  /// Endpoints are made here, so before Bus::start().
  Reporter(Bus& bus, std::function<void(stillhand_msgs::ServiceStatus&)> complete);
  ~Reporter() { stop(); }
  Reporter(const Reporter&) = delete;
  Reporter& operator=(const Reporter&) = delete;

  void start();
  /// Publishes the waiting events and ends the thread; nothing is published afterwards.
  void stop();
  /// Any thread; drops the note, and counts it, when 256 wait.
  void publish(const Note& note) noexcept;

 private:
  void work(const std::stop_token& stop);
  void publish_events();
  void publish_status();
  void publish_host_status();

  Bus& bus_;
  std::function<void(stillhand_msgs::ServiceStatus&)> complete_;
  Publisher<stillhand_msgs::Event> events_;
  Publisher<stillhand_msgs::ServiceStatus> statuses_;
  Publisher<stillhand_msgs::HostStatus> host_statuses_;
  ProcessCpu process_cpu_;
  HostCpu host_cpu_;
  boost::lockfree::queue<Note, boost::lockfree::capacity<256>> queue_;
  std::atomic<std::uint64_t> dropped_{0};
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread worker_;
};

}  // namespace stillhand::runtime
