// SPDX-License-Identifier: Apache-2.0
#include "services/bus/playback.hpp"

#include "fast_dds/discovery.hpp"
#include "services/bus/discovered_qos.hpp"
#include "services/bus/found_writers.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/replay_mark.hpp"
#include "services/bus/serialized_writers.hpp"
#include "services/bus/type_tag.hpp"

namespace stillhand::runtime {

struct Playback::Impl final : DiscoveryListener {
  Impl(const std::filesystem::path& profiles, std::uint32_t domain, const std::string& name)
      : writers(create_participant(profiles, domain, name, true, {}, this)) {}

  void on_participant(const AnnouncedParticipant& announced) override {
    found.note_participant(announced);
  }
  void on_writer(const AnnouncedWriter& announced) override { found.note_writer(announced); }

  FoundWriters found;
  SerializedWriters writers;  // discovery calls this object as long as its participant is there
};

Playback::Playback(const std::filesystem::path& profiles, std::uint32_t domain,
                   const std::string& name)
    : impl_(std::make_unique<Impl>(profiles, domain, name)) {}

Playback::~Playback() = default;
Playback::Playback(Playback&&) noexcept = default;

bool Playback::knows(const std::string& type) { return find_type(type) != nullptr; }

bool Playback::offers(const WriterQos& qos) { return kHasXcdr2 || !qos.xcdr2; }

std::optional<WriterQos> Playback::profile(const std::string& name) const {
  return profile_qos(impl_->writers.publisher(), name);
}

std::size_t Playback::add_writer(const std::string& topic, const std::string& type,
                                 const WriterQos& wanted) {
  edds::DataWriterQos qos = offered_qos(wanted);
  qos.user_data().data_vec(replay_mark());
  return impl_->writers.add(topic, type, wanted.keyed, qos);
}

bool Playback::write(std::size_t writer, std::span<const std::byte> bytes) {
  return impl_->writers.write(writer, bytes);
}

std::map<std::string, std::string> Playback::other_writers() const {
  std::map<std::string, std::string> names;
  for (const FoundWriter& each : impl_->found.all()) {
    if (!each.present || each.replayed) continue;
    names[each.topic] = each.participant.empty() ? each.id : each.participant;
  }
  return names;
}

std::uint32_t Playback::matched(std::size_t writer) const { return impl_->writers.matched(writer); }

bool Playback::wait_for_acknowledgments(std::int64_t limit_ns) {
  return impl_->writers.wait_for_acknowledgments(limit_ns);
}

}  // namespace stillhand::runtime
