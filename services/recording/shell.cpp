// SPDX-License-Identifier: Apache-2.0
#include "recording/shell.hpp"

#include <unistd.h>

#include <chrono>
#include <cstring>

#include "idl/idl_text.hpp"
#include "recording/sample_clock.hpp"
#include "runtime/real_time.hpp"

namespace stillhand::recording {
namespace {

constexpr std::chrono::milliseconds kWriteInterval{50};

std::string_view idl_of(std::string_view type) {
  for (const std::string_view text :
       {topics::kControlLoopIdl, topics::kSessionIdl, topics::kModelIdl}) {
    const std::string_view name = type.substr(type.rfind(':') + 1);
    if (text.find("struct " + std::string(name) + " {") != std::string_view::npos) return text;
  }
  return {};
}

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof(name) - 1) == 0 ? name : "unknown";
}

McapWriterOptions writer_options(const KeepOptions& keep) {
  McapWriterOptions options;
  options.compression = keep.compression;
  return options;
}

}  // namespace

Shell::Shell(runtime::Service& service, const KeepOptions& keep)
    : service_(service),
      flush_interval_(keep.flush_interval),
      file_(service.options().out.string(), Existing::kRefuse, keep.durability),
      writer_(file_, writer_options(keep)) {
  TextMap session{{"host", host_name()},
                  {"rig", std::to_string(service.options().rig)},
                  {"domain", std::to_string(service.options().domain)},
                  {"seed", std::to_string(service.options().seed)},
                  {"stillhand", STILLHAND_VERSION}};
  if (const Status status = writer_.add_metadata("stillhand.session", session); !status.ok()) {
    throw std::runtime_error(service.options().out.string() + ": " + status.text);
  }
  for (const topics::Topic* topic : topics::kCatalogue) subscribe(*topic);
  service.on_trial([&](const Trial& trial, const auto&) { service.note_armed(trial.number); });
}

void Shell::subscribe(const topics::Topic& topic) {
  const std::string type(topic.type);
  if (schemas_.count(type) == 0) {
    schemas_[type] = writer_.add_schema(type, kSchemaEncoding, idl_of(type));
  }
  const ChannelId channel =
      writer_.add_channel(std::string(topic.name), schemas_[type], kMessageEncoding,
                          {{"qos_profile", std::string(topics::profile_of(topic.pattern))}});
  const bool stream = topic.pattern == topics::Pattern::kStream1khz;
  service_.bus().subscribe_serialized(
      topic,
      [this, channel, stream](std::span<const std::byte> bytes,
                              const runtime::Arrival& arrival) -> runtime::detail::SampleClock {
        {
          const std::lock_guard lock(mutex_);
          filling_.messages.push_back({channel, static_cast<std::uint64_t>(arrival.logged_ns),
                                       static_cast<std::uint64_t>(arrival.source_ns),
                                       filling_.bytes.size(), bytes.size()});
          filling_.bytes.insert(filling_.bytes.end(), bytes.begin(), bytes.end());
        }
        const SampleHead head = stream ? sample_head(bytes) : SampleHead{};
        if (head.tick >= 0) service_.note_tick(head.tick);
        return {true, head.tick, head.stamp_ns};
      });
}

void Shell::run() {
  {
    std::jthread writing([this](const std::stop_token& stop) { write_batches(stop); });
    service_.run();
  }
  write_counts();
  if (const Status status = writer_.close(); !status.ok()) {
    throw std::runtime_error(service_.options().out.string() + ": " + status.text);
  }
}

void Shell::write_batches(const std::stop_token& stop) {
  runtime::become_background();
  Batch batch;
  auto flushed = std::chrono::steady_clock::now();
  for (bool last = false; !last;) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, stop, kWriteInterval, [] { return false; });
      last = stop.stop_requested();
      batch.messages.clear();
      batch.bytes.clear();
      std::swap(batch, filling_);
    }
    write_batch(batch);
    if (std::chrono::steady_clock::now() - flushed > flush_interval_) {
      flushed = std::chrono::steady_clock::now();
      // A failure shows in writer_.status(), which write_batch() reports.
      static_cast<void>(writer_.flush_chunk());
    }
  }
}

void Shell::write_batch(const Batch& batch) {
  for (const Held& held : batch.messages) {
    const Status status =
        writer_.write(held.channel, sequences_[held.channel]++, held.log_time_ns,
                      held.publish_time_ns, {batch.bytes.data() + held.begin, held.size});
    if (!status.ok() && !told_failure_) {
      told_failure_ = true;
      service_.note_event(stillhand_msgs::EVENT_NOTE,
                          "recording stopped: the file cannot be written");
      // A trial that nobody keeps is no trial: the process ends, run() says why.
      service_.stop().request();
    }
  }
}

void Shell::write_counts() {
  TextMap counts;
  for (const runtime::EndpointReport& report : service_.bus().report()) {
    if (report.written) continue;
    const std::string topic(report.topic->name);
    counts[topic + " received"] = std::to_string(report.samples);
    counts[topic + " lost_ticks"] = std::to_string(report.lost_ticks);
  }
  static_cast<void>(writer_.add_metadata("stillhand.counts", counts));
}

}  // namespace stillhand::recording
