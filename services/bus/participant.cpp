// SPDX-License-Identifier: Apache-2.0
#include "services/bus/participant.hpp"

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <set>

#include "fast_dds/discovery.hpp"
#include "fast_dds/profiles.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/replay_mark.hpp"
#include "services/bus/security.hpp"
#include "services/bus/surroundings.hpp"
#include "services/system/process/domain.hpp"

namespace stillhand::runtime {
namespace {

// What Fast DDS logs meanwhile, in place of its lines on standard error.
class ParserMessages {
 public:
  ParserMessages() {
    edds::Log::ClearConsumers();
    edds::Log::RegisterConsumer(std::make_unique<Collector>(*this));
  }
  ~ParserMessages() { edds::Log::Reset(); }
  ParserMessages(const ParserMessages&) = delete;
  ParserMessages& operator=(const ParserMessages&) = delete;

  /// The first of them; empty without one.
  std::string first() {
    edds::Log::Flush();
    const std::lock_guard lock(mutex_);
    return text_;
  }

 private:
  class Collector : public edds::LogConsumer {
   public:
    explicit Collector(ParserMessages& of) : of_(of) {}
    void Consume(const edds::Log::Entry& entry) override {
      const bool of_the_parser = std::string_view(entry.context.category) == "XMLPARSER";
      const std::lock_guard lock(of_.mutex_);
      if (of_the_parser && of_.text_.empty()) of_.text_ = entry.message;
    }

   private:
    ParserMessages& of_;
  };

  std::mutex mutex_;  // Fast DDS's thread writes
  std::string text_;
};

}  // namespace

// The factory keeps profiles for the whole process and refuses a file it has already read.
void load_profiles(const std::filesystem::path& file) {
  static std::mutex mutex;
  static std::set<std::string> loaded;
  const std::lock_guard lock(mutex);
  if (!std::filesystem::is_regular_file(file)) {
    throw ConfigError("QoS profiles", "no file " + file.string(), "the path of qos/profiles.xml");
  }
  const std::string path = std::filesystem::canonical(file).string();
  if (loaded.count(path) != 0) return;
  std::ifstream in(path);
  const std::string text = readable_profiles({std::istreambuf_iterator(in), {}});
  ParserMessages messages;
  const bool read = ok(edds::DomainParticipantFactory::get_instance()->load_XML_profiles_string(
      text.data(), text.size()));
  // It may also log what it cannot read and go on without it.
  const std::string why = messages.first();
  if (!read || !why.empty()) {
    throw ConfigError("QoS profiles",
                      path + ", which Fast DDS cannot read" + (why.empty() ? "" : ": " + why),
                      "an XML file such as qos/profiles.xml");
  }
  loaded.insert(path);
}

ConfigError missing_profile(const std::filesystem::path& profiles, const char* kind,
                            std::string_view name) {
  return {profiles.string(), "no " + std::string(kind) + " profile",
          "a profile named \"" + std::string(name) + "\""};
}

edds::DomainParticipant* create_participant(std::uint32_t domain, edds::DomainParticipantQos qos,
                                            DiscoveryListener* listener) {
  static DiscoveryListener quiet;  // none would let type objects through: fast_dds/v2/discovery.hpp
  // Nothing is sent to a group that a peer announces.  Cyclone's readers announce one.  Where two
  // reliable ones share it, Fast DDS 2.9.1 opens a channel to the group alone, and Debian's ends
  // the process with a failed assertion when it then sends to the second by itself.
  qos.allocation().locators.max_multicast_locators = 0;
  auto* participant = edds::DomainParticipantFactory::get_instance()->create_participant(
      domain, qos, listener != nullptr ? listener : &quiet, edds::StatusMask::none());
  if (participant != nullptr) return participant;
  throw BusError("Fast DDS created no participant on domain " + std::to_string(domain) +
                 ": are its UDP ports free?");
}

edds::DomainParticipant* create_participant(const std::filesystem::path& profiles,
                                            std::uint32_t domain, const std::string& name,
                                            bool marked, const Identity& identity,
                                            DiscoveryListener* listener) {
  if (domain > kMaxDomain) {
    throw ConfigError("domain", std::to_string(domain), "0 to " + std::to_string(kMaxDomain));
  }
  if (!identity.none()) check_identity(identity, domain);
  edds::Log::SetVerbosity(edds::Log::Kind::Error);
  load_profiles(profiles);
  auto* factory = edds::DomainParticipantFactory::get_instance();
  edds::DomainParticipantQos qos;
  if (!ok(factory->get_participant_qos_from_profile("stillhand_participant", qos))) {
    throw missing_profile(profiles, "participant", "stillhand_participant");
  }
  check_surroundings(qos, profiles.string() + ": interfaceWhiteList");
  qos.name(name);
  if (marked) qos.user_data().data_vec(replay_mark());
  if (!identity.none()) secure(qos, identity);
  auto* participant = create_participant(domain, qos, listener);
  if (!identity.none() && !is_secured(*participant, identity)) {
    factory->delete_participant(participant);
    throw BusError("Fast DDS created a participant without the security of " +
                   identity.folder.string());
  }
  return participant;
}

}  // namespace stillhand::runtime
