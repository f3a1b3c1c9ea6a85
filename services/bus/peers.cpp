// SPDX-License-Identifier: Apache-2.0
#include "services/bus/peers.hpp"

#include <algorithm>

#include "idl/topics.hpp"
#include "services/bus/replay_mark.hpp"

namespace stillhand::runtime {

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

void Peers::on_participant(const AnnouncedParticipant& announced) {
  const auto& [participant, name, user_data, here] = announced;
  if (writers_ != nullptr) writers_->note_participant(announced);
  if (sources_ != nullptr) {
    // A mark comes first: a replay is not a second writer.
    if (here && is_replay_mark(user_data)) sources_->note_replay(participant);
    if (here) sources_->note_participant(participant, name);
    if (!here) sources_->forget_participant(participant);
  }
  const std::lock_guard lock(mutex_);
  if (here) {
    if (name.starts_with(prefix_)) services_[participant] = name.substr(prefix_.size());
    if (is_replay_mark(user_data)) mark(participant);
  } else {
    services_.erase(participant);
    std::erase_if(heard_, [&participant = participant](const ertps::InstanceHandle_t& writer) {
      return ertps::iHandle2GUID(writer).guidPrefix == participant;
    });
    marked_now_.erase(participant);
    authenticated_.erase(participant);
    refresh_replay();
    refresh();
  }
}

void Peers::onParticipantAuthentication(edds::DomainParticipant* /*participant*/,
                                        ertps::ParticipantAuthenticationInfo&& info) {
  if (info.status != ertps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT) return;
  const std::lock_guard lock(mutex_);
  authenticated_.insert(info.guid.guidPrefix);
  refresh_replay();
}

bool Peers::counts(const ertps::GuidPrefix_t& participant) const {
  return !secured_ || authenticated_.count(participant) != 0;
}

// Comes before the writer is matched, unlike the discovery of its participant, which Fast DDS tells
// after it has begun to match (PDPListener::onNewCacheChangeAdded).
void Peers::on_writer(const AnnouncedWriter& announced) {
  if (writers_ != nullptr) writers_->note_writer(announced);
  const bool marked = is_replay_mark(announced.qos.m_userData.data_vec());
  if (sources_ != nullptr) {
    const ertps::InstanceHandle_t writer(announced.guid);
    if (announced.here && marked) sources_->note_replay(announced.guid.guidPrefix);
    if (announced.here) sources_->note_writer(writer, announced.topic);
    if (!announced.here) sources_->forget_writer(writer);
  }
  if (!announced.here || !marked) return;
  const std::lock_guard lock(mutex_);
  mark(announced.guid.guidPrefix);
}

void Peers::mark(const ertps::GuidPrefix_t& participant) {
  marked_now_.insert(participant);
  ever_marked_.insert(participant);
  replay_seen_.store(true, std::memory_order_release);
  refresh_replay();
}

void Peers::refresh_replay() {
  const bool present =
      std::any_of(marked_now_.begin(), marked_now_.end(),
                  [this](const ertps::GuidPrefix_t& participant) { return counts(participant); });
  replay_present_.store(present, std::memory_order_release);
}

bool Peers::refuses(const ertps::InstanceHandle_t& writer) const {
  if (answers_replay_ || !replay_seen()) return false;
  const auto guid = ertps::iHandle2GUID(writer);
  const std::lock_guard lock(mutex_);
  return ever_marked_.count(guid.guidPrefix) != 0;
}

std::string Peers::service_of(const ertps::InstanceHandle_t& endpoint) const {
  const auto guid = ertps::iHandle2GUID(endpoint);
  const std::lock_guard lock(mutex_);
  const auto found = services_.find(guid.guidPrefix);
  return found == services_.end() ? "" : found->second;
}

bool Peers::set_alive(const ertps::InstanceHandle_t& writer, bool alive) {
  const std::lock_guard lock(mutex_);
  return count_alive(writer, alive);
}

bool Peers::note_sample(const ertps::InstanceHandle_t& writer) {
  if (all_alive_.load(std::memory_order_acquire)) return false;
  const std::lock_guard lock(mutex_);
  return heard_.count(writer) == 0 && count_alive(writer, true);
}

bool Peers::count_alive(const ertps::InstanceHandle_t& writer, bool alive) {
  const auto found = services_.find(ertps::iHandle2GUID(writer).guidPrefix);
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
bool Peers::is_of(std::size_t service, const ertps::InstanceHandle_t& writer) const noexcept {
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
