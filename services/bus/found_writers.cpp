// SPDX-License-Identifier: Apache-2.0
#include "services/bus/found_writers.hpp"

#include <algorithm>
#include <sstream>

#include "idl/idl_text.hpp"
#include "idl/topics.hpp"
#include "services/bus/discovered_qos.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/replay_mark.hpp"
#include "services/bus/type_tag.hpp"

namespace stillhand::runtime {

namespace {

// RTPS 2.3, table 9.1: kind of a writer of an application whose type has a key.
constexpr ertps::octet kWriterWithKey = 0x02;

/// "" of bytes that are no text of one line.
std::string text_of(const std::vector<std::uint8_t>& user_data) {
  constexpr std::size_t kMost = 256;
  const bool text = user_data.size() <= kMost && std::ranges::all_of(user_data, [](std::uint8_t c) {
                      return c >= ' ' && c < 0x7f;
                    });
  return text ? std::string(user_data.begin(), user_data.end()) : "";
}

}  // namespace

void FoundWriters::learn_depths(const edds::Publisher& publisher,
                                const std::filesystem::path& profiles) {
  const std::lock_guard lock(mutex_);
  for (const topics::Topic* row : topics::kCatalogue) {
    const std::string name(topics::profile_of(*row));
    const std::optional<WriterQos> qos = profile_qos(publisher, name);
    if (!qos) throw missing_profile(profiles, "data_writer", name);
    depth_of_[name] = qos->depth;
  }
}

void FoundWriters::note_participant(const ertps::GuidPrefix_t& prefix, const std::string& name) {
  const std::lock_guard lock(mutex_);
  participants_[prefix] = name;
  for (const auto& [handle, number] : by_handle_) {
    if (ertps::iHandle2GUID(handle).guidPrefix == prefix) {
      writers_.at(number).writer.participant = name;
    }
  }
}

void FoundWriters::note_participant(const AnnouncedParticipant& announced) {
  if (announced.here) return note_participant(announced.prefix, announced.name);
  const std::lock_guard lock(mutex_);
  participants_.erase(announced.prefix);
  for (const auto& [handle, number] : by_handle_) {
    if (ertps::iHandle2GUID(handle).guidPrefix == announced.prefix) {
      writers_.at(number).writer.present = false;
    }
  }
}

std::optional<std::size_t> FoundWriters::note_writer(const AnnouncedWriter& announced,
                                                     bool wanted) {
  const Handle handle(announced.guid);
  const std::lock_guard lock(mutex_);
  const auto known = by_handle_.find(handle);
  if (!announced.here) {
    if (known != by_handle_.end()) writers_.at(known->second).writer.present = false;
    return std::nullopt;
  }
  if (known != by_handle_.end() || !make_room()) return std::nullopt;
  FoundWriter writer;
  writer.topic = announced.topic;
  writer.type = announced.type;
  std::ostringstream id;
  id << announced.guid;
  writer.id = id.str();
  const auto name = participants_.find(announced.guid.guidPrefix);
  if (name != participants_.end()) writer.participant = name->second;
  writer.qos = discovered_qos(announced.qos);
  writer.replayed = is_replay_mark(announced.qos.m_userData.data_vec());
  writer.user_data = text_of(announced.qos.m_userData.data_vec());
  writer.type_known = find_type(writer.type) != nullptr;
  writer.idl = writer.type_known ? topics::idl_of(writer.type) : keep(announced.idl);
  writer.qos.keyed = announced.guid.entityId.value[3] == kWriterWithKey;
  writer.wanted = wanted;
  if (const topics::Topic* row = topics::find(writer.topic); row != nullptr) {
    writer.profile = std::string(topics::profile_of(*row));
  }
  by_handle_.emplace(handle, next_);
  writers_.emplace(next_, Entry{std::move(writer), handle, false});
  return next_++;
}

std::string_view FoundWriters::keep(const std::string& idl) {
  const auto known = idl_.find(idl);
  if (known != idl_.end()) return *known;
  if (idl.size() > kMostIdlBytes - idl_bytes_) return {};
  idl_bytes_ += idl.size();
  return *idl_.insert(idl).first;
}

bool FoundWriters::make_room() {
  if (writers_.size() < kMost) return true;
  const auto left = std::ranges::find_if(
      writers_, [](const auto& each) { return !each.second.writer.present && !each.second.heard; });
  if (left == writers_.end()) return false;
  by_handle_.erase(left->second.handle);
  writers_.erase(left);
  return true;
}

std::optional<std::size_t> FoundWriters::find(const Handle& writer) {
  const std::lock_guard lock(mutex_);
  const auto found = by_handle_.find(writer);
  if (found == by_handle_.end()) return std::nullopt;
  writers_.at(found->second).heard = true;
  return found->second;
}

FoundWriter FoundWriters::complete(FoundWriter writer) const {
  const auto depth = depth_of_.find(writer.profile);
  if (depth != depth_of_.end()) writer.qos.depth = depth->second;
  return writer;
}

FoundWriter FoundWriters::at(std::size_t number) const {
  const std::lock_guard lock(mutex_);
  return complete(writers_.at(number).writer);
}

std::vector<FoundWriter> FoundWriters::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<FoundWriter> all;
  for (const auto& [number, entry] : writers_) all.push_back(complete(entry.writer));
  return all;
}

const SampleWriters::Entry* SampleWriters::of(const FoundWriters::Handle& writer) {
  if (entry_ != nullptr && writer == newest_) return entry_;
  auto known = known_.find(writer);
  if (known == known_.end()) {
    const std::optional<std::size_t> number = all_.find(writer);
    if (!number) return nullptr;
    known = known_.emplace(writer, Entry{*number, all_.at(*number)}).first;
  }
  newest_ = writer;
  entry_ = &known->second;
  return entry_;
}

}  // namespace stillhand::runtime
