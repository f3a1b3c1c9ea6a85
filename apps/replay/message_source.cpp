// SPDX-License-Identifier: Apache-2.0
#include "apps/replay/message_source.hpp"

#include <algorithm>
#include <map>

#include "services/system/process/real_time.hpp"

namespace stillhand::replay {

using recording::ChannelId;
using recording::HeldMessage;
using recording::MessageView;

namespace {

constexpr std::uint64_t kStretch_ns = 1'000'000'000;
constexpr std::size_t kReadAhead = 2;

std::vector<bool> flags_of(const std::vector<ChannelId>& ids) {
  std::vector<bool> flags(std::size_t{UINT16_MAX} + 1, false);
  for (const ChannelId id : ids) flags[id] = true;
  return flags;
}

std::uint64_t sum(std::uint64_t a, std::uint64_t b) {
  return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

void add(const MessageView& message, std::uint64_t at_ns, recording::MessageBatch& batch) {
  batch.add({message.channel.id, message.sequence, at_ns, message.publish_time_ns, 0, 0, 0},
            message.bytes);
}

}  // namespace

MessageSource::MessageSource(recording::FileSource& file, const std::vector<ChannelId>& wanted,
                             const std::vector<ChannelId>& latched)
    : reader_(file),
      wanted_(flags_of(wanted)),
      latched_(flags_of(latched)),
      any_latched_(!latched.empty()),
      reading_([this](const std::stop_token& stop) { work(stop); }) {}

MessageSource::~MessageSource() = default;

void MessageSource::seek(std::uint64_t from_ns, std::uint64_t to_ns) {
  const std::lock_guard lock(mutex_);
  request_ = {request_.generation + 1, from_ns, to_ns};
  ready_.clear();
  changed_.notify_all();
}

std::optional<Stretch> MessageSource::next() {
  const std::lock_guard lock(mutex_);
  if (ready_.empty()) return std::nullopt;
  Stretch stretch = std::move(ready_.front());
  ready_.pop_front();
  changed_.notify_all();
  return stretch;
}

Stretch MessageSource::wait_next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !ready_.empty(); });
  Stretch stretch = std::move(ready_.front());
  ready_.pop_front();
  changed_.notify_all();
  return stretch;
}

std::vector<recording::Damage> MessageSource::damage() const {
  const std::lock_guard lock(mutex_);
  return damage_;
}

bool MessageSource::superseded(std::uint64_t generation) const {
  const std::lock_guard lock(mutex_);
  return request_.generation != generation;
}

bool MessageSource::publish(Stretch stretch, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const bool wanted = changed_.wait(lock, stop, [&] {
    return ready_.size() < kReadAhead || request_.generation != stretch.generation;
  });
  if (!wanted || request_.generation != stretch.generation) return false;
  damage_ = reader_.damage();
  ready_.push_back(std::move(stretch));
  changed_.notify_all();
  return true;
}

void MessageSource::work(const std::stop_token& stop) {
  runtime::become_background();
  std::uint64_t served = 0;
  for (;;) {
    Request request;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [&] { return request_.generation != served; })) return;
      request = request_;
    }
    served = request.generation;
    if (!publish(state_before(request), stop)) continue;
    std::uint64_t from_ns = request.from_ns;
    for (bool last = false; !last && !stop.stop_requested() && !superseded(served);) {
      const std::uint64_t end_ns = std::min(sum(from_ns, kStretch_ns - 1), request.to_ns);
      Stretch stretch = read(from_ns, end_ns);
      std::optional<std::uint64_t> following = sum(end_ns, 1);
      if (end_ns >= request.to_ns) {
        following.reset();
      } else if (stretch.batch.messages.empty()) {
        following = first_after(end_ns + 1, request.to_ns);
      }
      last = !following;
      stretch.generation = served;
      stretch.last = last;
      from_ns = following.value_or(0);
      if ((last || !stretch.batch.messages.empty()) && !publish(std::move(stretch), stop)) break;
    }
  }
}

Stretch MessageSource::state_before(const Request& request) {
  Stretch stretch;
  stretch.generation = request.generation;
  if (!any_latched_ || request.from_ns == 0) return stretch;
  struct Newest {
    std::uint64_t time_ns;
    recording::MessageBatch batch;
  };
  std::map<ChannelId, Newest> newest;
  const recording::MessageFilter before{{}, 0, request.from_ns - 1};
  static_cast<void>(reader_.for_each_message(before, [&](const MessageView& message) {
    if (!latched_[message.channel.id]) return !superseded(request.generation);
    Newest& entry = newest[message.channel.id];
    if (message.log_time_ns >= entry.time_ns) {
      entry.time_ns = message.log_time_ns;
      entry.batch.clear();
      add(message, request.from_ns, entry.batch);
    }
    return true;
  }));
  for (const auto& [channel, entry] : newest) {
    stretch.batch.add(entry.batch.messages.front(),
                      entry.batch.content(entry.batch.messages.front()));
  }
  return stretch;
}

Stretch MessageSource::read(std::uint64_t from_ns, std::uint64_t to_ns) {
  Stretch stretch;
  static_cast<void>(reader_.for_each_message({{}, from_ns, to_ns}, [&](const MessageView& message) {
    if (wanted_[message.channel.id]) add(message, message.log_time_ns, stretch.batch);
    return true;
  }));
  std::ranges::stable_sort(stretch.batch.messages, {}, &HeldMessage::log_time_ns);
  return stretch;
}

// Stretches twice as long each time, so that a gap of years costs no more steps than its logarithm.
std::optional<std::uint64_t> MessageSource::first_after(std::uint64_t from_ns,
                                                        std::uint64_t to_ns) {
  for (std::uint64_t length_ns = kStretch_ns;; length_ns = sum(length_ns, length_ns)) {
    const std::uint64_t end_ns = std::min(sum(from_ns, length_ns), to_ns);
    std::optional<std::uint64_t> first;
    static_cast<void>(
        reader_.for_each_message({{}, from_ns, end_ns}, [&](const MessageView& message) {
          if (wanted_[message.channel.id] && (!first || message.log_time_ns < *first)) {
            first = message.log_time_ns;
          }
          return true;
        }));
    if (first || end_ns >= to_ns) return first;
    from_ns = end_ns + 1;
  }
}

}  // namespace stillhand::replay
