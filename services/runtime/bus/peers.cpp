// SPDX-License-Identifier: Apache-2.0
#include "services/runtime/bus/peers.hpp"

#include <algorithm>

#include "idl/topics.hpp"
#include "services/runtime/bus/replay_mark.hpp"

namespace stillhand::runtime {

using eprosima::fastrtps::rtps::GuidPrefix_t;
using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::ParticipantAuthenticationInfo;
using eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
using eprosima::fastrtps::rtps::WriterDiscoveryInfo;

Peers::Peers(std::string self, std::uint32_t rig, bool answers_replay, FoundWriters* writers,
             bool secured, Sources* sources)
    : self_(std::move(self)),
      prefix_(participant_name(rig, "")),
      answers_replay_(answers_replay),
      writers_(writers),
      secured_(secured),
      sources_(sources) {
  for (const std::string_view service : topics::kServices) {
    missing_lines_.push_back("a process is missing: " + std::string(service));
  }
}

std::string Peers::participant_name(std::uint32_t rig, const std::string& service) {
  return "stillhand/" + std::to_string(rig) + "/" + service;
}

void Peers::on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* /*participant*/,
                                     ParticipantDiscoveryInfo&& info) {
  if (writers_ != nullptr) writers_->note_participant(info);
  const std::string name = info.info.m_participantName.to_string();
  const bool here = info.status == ParticipantDiscoveryInfo::DISCOVERED_PARTICIPANT ||
                    info.status == ParticipantDiscoveryInfo::CHANGED_QOS_PARTICIPANT;
  if (sources_ != nullptr) {
    // A mark comes first: a replay is not a second writer.
    const auto& participant = info.info.m_guid.guidPrefix;
    if (here && is_replay_mark(info.info.m_userData.data_vec())) sources_->note_replay(participant);
    if (here) sources_->note_participant(participant, name);
    if (!here) sources_->forget_participant(participant);
  }
  const std::lock_guard lock(mutex_);
  if (here) {
    if (name.starts_with(prefix_)) {
      services_[info.info.m_guid.guidPrefix] = name.substr(prefix_.size());
    }
    if (is_replay_mark(info.info.m_userData.data_vec())) mark(info.info.m_guid.guidPrefix);
  } else {
    services_.erase(info.info.m_guid.guidPrefix);
    std::erase_if(heard_, [&](const InstanceHandle_t& writer) {
      return eprosima::fastrtps::rtps::iHandle2GUID(writer).guidPrefix ==
             info.info.m_guid.guidPrefix;
    });
    marked_now_.erase(info.info.m_guid.guidPrefix);
    authenticated_.erase(info.info.m_guid.guidPrefix);
    refresh_replay();
    refresh();
  }
}

void Peers::onParticipantAuthentication(eprosima::fastdds::dds::DomainParticipant* /*participant*/,
                                        ParticipantAuthenticationInfo&& info) {
  if (info.status != ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT) return;
  const std::lock_guard lock(mutex_);
  authenticated_.insert(info.guid.guidPrefix);
  refresh_replay();
}

bool Peers::counts(const GuidPrefix_t& participant) const {
  return !secured_ || authenticated_.count(participant) != 0;
}

// Comes before the writer is matched, unlike the discovery of its participant, which Fast DDS tells
// after it has begun to match (PDPListener::onNewCacheChangeAdded).
void Peers::on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* /*participant*/,
                                   WriterDiscoveryInfo&& info) {
  if (writers_ != nullptr) writers_->note_writer(info);
  const bool marked = is_replay_mark(info.info.m_qos.m_userData.data_vec());
  const bool here = info.status != WriterDiscoveryInfo::REMOVED_WRITER;
  if (sources_ != nullptr) {
    const InstanceHandle_t writer(info.info.guid());
    if (here && marked) sources_->note_replay(info.info.guid().guidPrefix);
    if (here) sources_->note_writer(writer, info.info.topicName().to_string());
    if (!here) sources_->forget_writer(writer);
  }
  if (!here || !marked) return;
  const std::lock_guard lock(mutex_);
  mark(info.info.guid().guidPrefix);
}

void Peers::mark(const GuidPrefix_t& participant) {
  marked_now_.insert(participant);
  ever_marked_.insert(participant);
  replay_seen_.store(true, std::memory_order_release);
  refresh_replay();
}

void Peers::refresh_replay() {
  const bool present =
      std::any_of(marked_now_.begin(), marked_now_.end(),
                  [this](const GuidPrefix_t& participant) { return counts(participant); });
  replay_present_.store(present, std::memory_order_release);
}

bool Peers::refuses(const InstanceHandle_t& writer) const {
  if (answers_replay_ || !replay_seen()) return false;
  const auto guid = eprosima::fastrtps::rtps::iHandle2GUID(writer);
  const std::lock_guard lock(mutex_);
  return ever_marked_.count(guid.guidPrefix) != 0;
}

std::string Peers::service_of(const InstanceHandle_t& endpoint) const {
  const auto guid = eprosima::fastrtps::rtps::iHandle2GUID(endpoint);
  const std::lock_guard lock(mutex_);
  const auto found = services_.find(guid.guidPrefix);
  return found == services_.end() ? "" : found->second;
}

bool Peers::set_alive(const InstanceHandle_t& writer, bool alive) {
  const std::lock_guard lock(mutex_);
  return count_alive(writer, alive);
}

bool Peers::note_sample(const InstanceHandle_t& writer) {
  if (all_alive_.load(std::memory_order_acquire)) return false;
  const std::lock_guard lock(mutex_);
  return heard_.count(writer) == 0 && count_alive(writer, true);
}

bool Peers::count_alive(const InstanceHandle_t& writer, bool alive) {
  const auto found = services_.find(eprosima::fastrtps::rtps::iHandle2GUID(writer).guidPrefix);
  const std::string service = found == services_.end() ? "" : found->second;
  bool changed = false;
  if (!service.empty()) heard_.insert(writer);
  if (alive && !service.empty()) {
    changed = alive_writers_.emplace(writer, service).second;
    if (topics::is_service(service)) ever_alive_.insert(service);
  } else if (!alive) {
    changed = alive_writers_.erase(writer) > 0;
  }
  refresh();
  return changed;
}

void Peers::refresh() {
  const auto missing =
      std::ranges::find_if(topics::kServices, [this](const std::string_view& service) {
        const auto place = static_cast<std::size_t>(&service - topics::kServices.data());
        return service != self_ && std::ranges::none_of(alive_writers_, [&](const auto& writer) {
                 return writer.second == service && is_of(place, writer.first);
               });
      });
  const bool all = missing == topics::kServices.end();
  if (!all) {
    newest_missing_.store(static_cast<std::size_t>(missing - topics::kServices.begin()),
                          std::memory_order_release);
  }
  all_alive_.store(all, std::memory_order_release);
}

// A stranger's life sign, under whatever name, hides no loss.
bool Peers::is_of(std::size_t service, const InstanceHandle_t& writer) const noexcept {
  return sources_ == nullptr || !sources_->named() || sources_->admits(service, writer);
}

const char* Peers::why_not_alive() const noexcept {
  if (answers_replay_) return "no replay is on the bus";
  if (replay_present()) return "a replay is on the bus";
  if (sources_ != nullptr && (!sources_->sound() || all_alive_.load(std::memory_order_acquire))) {
    return sources_->why_not();
  }
  return missing_lines_[newest_missing_.load(std::memory_order_acquire)].c_str();
}

std::vector<Source> Peers::sources_found(const ParticipantId& own) const {
  std::vector<Source> found{{self_, own}};
  const std::lock_guard lock(mutex_);
  for (const auto& [prefix, service] : services_) {
    if (!counts(prefix) || !topics::is_service(service)) continue;
    Source source{service, {}};
    std::ranges::copy(prefix.value, source.participant.begin());
    found.push_back(std::move(source));
  }
  return found;
}

bool Peers::take_sources(const ParticipantId& from, const std::vector<Source>& sources) {
  if (sources_ == nullptr || !sources_->take(from, sources)) return false;
  const std::lock_guard lock(mutex_);
  refresh();
  return true;
}

std::vector<std::string> Peers::lost() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> gone = ever_alive_;
  for (const auto& [writer, service] : alive_writers_) {
    const auto place = std::ranges::find(topics::kServices, service) - topics::kServices.begin();
    if (is_of(static_cast<std::size_t>(place), writer)) gone.erase(service);
  }
  return {gone.begin(), gone.end()};
}

std::vector<std::string> Peers::duplicates() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, int> count{{self_, 1}};
  for (const auto& [prefix, service] : services_) {
    if (counts(prefix)) ++count[service];
  }
  std::vector<std::string> twice;
  for (const auto& [service, times] : count) {
    if (times > 1) twice.push_back(service);
  }
  return twice;
}

}  // namespace stillhand::runtime
