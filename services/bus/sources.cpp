// SPDX-License-Identifier: Apache-2.0
#include "services/bus/sources.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <iterator>

#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {

namespace {

constexpr std::size_t kFront = 8;  // bytes of a participant in Named::front; the rest is in back
constexpr std::size_t kMostLines = 200;
constexpr const char* kContested = "two experiments name the session's sources";
constexpr const char* kManyMore = "more second writers than are named";

ParticipantId id_of(const ertps::GuidPrefix_t& prefix) {
  ParticipantId id{};
  std::copy(std::begin(prefix.value), std::end(prefix.value), id.begin());
  return id;
}

std::size_t place_of(std::string_view service) {
  return static_cast<std::size_t>(std::ranges::find(topics::kServices, service) -
                                  topics::kServices.begin());
}

// The name is a stranger's: it may hold anything, and a line for a person holds this much of it.
std::string printable(const std::string& name) {
  constexpr std::size_t kMost = 31;  // BusIncident::peer
  std::string text = name.empty() ? "a participant without a name" : name.substr(0, kMost);
  std::ranges::replace_if(text, [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

}  // namespace

std::string text_of(const ParticipantId& participant) {
  return fmt::format("{:02x}", fmt::join(participant, ""));
}

ParticipantId participant_of(const std::string& text, const std::string& name) {
  ParticipantId id{};
  const bool digits = text.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (text.size() != 2 * id.size() || !digits) {
    throw ConfigError(name, text, "the number of a participant, 24 hexadecimal digits");
  }
  for (std::size_t i = 0; i < id.size(); ++i) {
    constexpr int kHexadecimal = 16;
    id[i] = static_cast<std::uint8_t>(std::stoi(text.substr(2 * i, 2), nullptr, kHexadecimal));
  }
  return id;
}

std::size_t Sources::writer_of(const topics::Topic& topic) {
  return topic.writers.size() == 1 ? place_of(topic.writers.front()) : kAnybody;
}

Sources::Sources(Options options) : options_(std::move(options)) {
  if (options_.experiment) set(place_of("experiment"), *options_.experiment);
}

bool Sources::acceptable(const ParticipantId& from, const std::vector<Source>& sources) const {
  if (options_.experiment && from != *options_.experiment) return false;
  if (sources.size() != topics::kServices.size()) return false;
  std::set<std::size_t> seen;
  for (const Source& source : sources) {
    const std::size_t place = place_of(source.service);
    if (place == kAnybody || !seen.insert(place).second) return false;
    if (source.service == "experiment" && source.participant != from) return false;
    if (!options_.identities.empty() &&
        !std::equal(options_.identities[place].begin(), options_.identities[place].end(),
                    source.participant.begin())) {
      return false;
    }
  }
  return true;
}

bool Sources::take(const ParticipantId& from, const std::vector<Source>& sources) {
  if (!acceptable(from, sources)) return false;
  std::vector<Second> fresh;
  {
    const std::lock_guard lock(mutex_);
    const auto known =
        std::ranges::find(announced_, from, [](const auto& entry) { return entry.first; });
    if (known == announced_.end()) {
      announced_.emplace_back(from, sources);
    } else if (known->second == sources) {
      return true;  // said again, while samples of these sources arrive
    } else {
      known->second = sources;
    }
    adopt();
    fresh = judge();
  }
  report(fresh);
  return true;
}

void Sources::set(std::size_t service, const ParticipantId& participant) {
  std::uint64_t front = 0;
  std::uint32_t back = 0;
  std::memcpy(&front, participant.data(), kFront);
  std::memcpy(&back, participant.data() + kFront, sizeof(back));
  Named& named = sources_.at(service);
  named.known.store(false, std::memory_order_release);
  named.front.store(front, std::memory_order_release);
  named.back.store(back, std::memory_order_release);
  named.known.store(true, std::memory_order_release);
}

void Sources::adopt() {
  // Before a name changes, and set back after it: admits() sees no moment in which any experiment
  // counts that did not count before.
  if (announced_.size() > 1) contested_.store(true, std::memory_order_release);
  if (announced_.size() != 1) {
    named_.store(false, std::memory_order_release);
    for (Named& named : sources_) named.known.store(false, std::memory_order_release);
    if (options_.experiment) set(place_of("experiment"), *options_.experiment);
    if (announced_.empty()) contested_.store(false, std::memory_order_release);
    return;
  }
  for (const Source& source : announced_.front().second) {
    set(place_of(source.service), source.participant);
  }
  named_.store(true, std::memory_order_release);
  ever_named_.store(true, std::memory_order_release);
  contested_.store(false, std::memory_order_release);
}

bool Sources::admits(std::size_t service, const Handle& writer) const noexcept {
  if (service >= sources_.size()) return true;
  const Named& named = sources_[service];
  if (!named.known.load(std::memory_order_acquire)) {
    return topics::kServices[service] == "experiment" && !options_.experiment && !this->named() &&
           !contested();
  }
  return is(named, static_cast<const ertps::octet*>(writer.value));
}

bool Sources::awaits(std::size_t service) const noexcept {
  return service < sources_.size() && topics::kServices[service] != "experiment" &&
         !ever_named_.load(std::memory_order_acquire);
}

bool Sources::speaks_for(std::string_view service,
                         const ParticipantId& participant) const noexcept {
  const std::size_t place = place_of(service);
  if (place == kAnybody || !sources_[place].known.load(std::memory_order_acquire)) return !named();
  return is(sources_[place], participant.data());
}

bool Sources::is(const Named& named, const std::uint8_t* participant) noexcept {
  std::uint64_t front = 0;
  std::uint32_t back = 0;
  std::memcpy(&front, participant, kFront);
  std::memcpy(&back, participant + kFront, sizeof(back));
  return front == named.front.load(std::memory_order_acquire) &&
         back == named.back.load(std::memory_order_acquire);
}

void Sources::note_participant(const Prefix& participant, const std::string& name) {
  std::vector<Second> fresh;
  {
    const std::lock_guard lock(mutex_);
    names_[participant] = name;
    fresh = judge();
  }
  report(fresh);
}

void Sources::forget_participant(const Prefix& participant) {
  std::vector<Second> fresh;
  {
    const std::lock_guard lock(mutex_);
    names_.erase(participant);
    replays_.erase(participant);
    std::erase_if(writers_, [&](const auto& entry) {
      return ertps::iHandle2GUID(entry.first).guidPrefix == participant;
    });
    if (std::erase_if(announced_,
                      [&](const auto& entry) { return entry.first == id_of(participant); }) > 0) {
      adopt();
    }
    fresh = judge();
  }
  report(fresh);
}

void Sources::note_replay(const Prefix& participant) {
  const std::lock_guard lock(mutex_);
  replays_.insert(participant);
}

void Sources::note_writer(const Handle& writer, const std::string& topic) {
  const topics::Topic* row = topics::find(topic);
  if (row == nullptr) return;
  std::vector<Second> fresh;
  {
    const std::lock_guard lock(mutex_);
    writers_.emplace(writer, Writer{row, false, std::nullopt});
    fresh = judge();
  }
  report(fresh);
}

void Sources::forget_writer(const Handle& writer) {
  const std::lock_guard lock(mutex_);
  if (writers_.erase(writer) > 0) judge();
}

void Sources::note_refused(const Handle& writer) {
  if (!named()) return;
  std::vector<Second> fresh;
  {
    const std::lock_guard lock(mutex_);
    // A writer that left has samples in a reader's history.
    const auto found = writers_.find(writer);
    if (found == writers_.end() || found->second.refused) return;
    found->second.refused = true;
    fresh = judge();
  }
  report(fresh);
}

// A bus may carry other rigs: "stillhand/7/cancellation" writes the same topic for rig 7.
bool Sources::of_another_rig(const std::string& name, const topics::Topic& topic) const {
  const std::string own = "stillhand/" + std::to_string(options_.rig) + "/";
  return name.starts_with("stillhand/") && !name.starts_with(own) &&
         name.ends_with("/" + std::string(topic.writers.front()));
}

bool Sources::is_second(const Handle& handle, const Writer& writer) const {
  const bool anybodys = writer_of(*writer.topic) == kAnybody;
  if (!named() || (!anybodys && admits(writer_of(*writer.topic), handle))) return false;
  const Prefix prefix = ertps::iHandle2GUID(handle).guidPrefix;
  if (replays_.count(prefix) != 0) return false;
  if (writer.refused || anybodys) return writer.refused;
  // DDS announces a writer before the name of its participant.
  const auto name = names_.find(prefix);
  return name != names_.end() && !of_another_rig(name->second, *writer.topic);
}

const char* Sources::kept(std::string line) {
  const auto known = std::ranges::find(lines_, line);
  if (known != lines_.end()) return known->c_str();
  if (lines_.size() >= kMostLines) return kManyMore;
  return lines_.emplace_back(std::move(line)).c_str();
}

Sources::Second Sources::second_of(const Handle& handle, const Writer& writer) {
  const Prefix prefix = ertps::iHandle2GUID(handle).guidPrefix;
  const auto found = names_.find(prefix);
  const std::string name = printable(found == names_.end() ? "" : found->second);
  if (writer_of(*writer.topic) != kAnybody) {
    newest_second_.store(
        kept("a second writer of " + std::string(writer.topic->name) + ": " + name),
        std::memory_order_release);
  }
  return {writer.topic, name, kept("participant " + text_of(id_of(prefix)))};
}

std::vector<Sources::Second> Sources::judge() {
  std::vector<Second> fresh;
  bool present = false;
  for (auto& [handle, writer] : writers_) {
    if (!is_second(handle, writer)) {
      writer.second.reset();
      continue;
    }
    // A word in another's name is dropped, and drives nothing.
    present = present || writer_of(*writer.topic) != kAnybody;
    if (writer.second) continue;
    writer.second = second_of(handle, writer);
    fresh.push_back(*writer.second);
  }
  second_present_.store(present, std::memory_order_release);
  return fresh;
}

void Sources::report(const std::vector<Second>& fresh) const {
  if (!options_.on_second) return;
  for (const Second& second : fresh) options_.on_second(second);
}

const char* Sources::why_not() const noexcept {
  if (contested()) return kContested;
  if (!named()) return "the session has not named its sources";
  const char* second = newest_second_.load(std::memory_order_acquire);
  return second != nullptr ? second : "the sources of the session were not sound";
}

}  // namespace stillhand::runtime
