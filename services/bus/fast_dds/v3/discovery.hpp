// SPDX-License-Identifier: Apache-2.0
// Fast DDS 3.
#pragma once

#include <fastdds/dds/builtin/topic/PublicationBuiltinTopicData.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/xtypes/dynamic_types/DynamicTypeBuilder.hpp>
#include <fastdds/dds/xtypes/dynamic_types/DynamicTypeBuilderFactory.hpp>
#include <fastdds/dds/xtypes/type_representation/ITypeObjectRegistry.hpp>
#include <fastdds/dds/xtypes/type_representation/TypeObject.hpp>
#include <fastdds/dds/xtypes/utils.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "services/bus/announced.hpp"

namespace stillhand::runtime {

/// What idl_serialize() writes as "struct a::B {...};" is "module a { struct B {...}; };" in IDL.
inline std::string in_modules(const std::string& text) {
  std::istringstream lines(text);
  std::string result, annotations, line;
  std::size_t open = 0;
  while (std::getline(lines, line)) {
    if (line.starts_with('@')) {
      annotations += line + "\n";
      continue;
    }
    const bool defines = !line.empty() && line.front() >= 'a' && line.front() <= 'z';
    if (defines) {
      const std::size_t name =
          (line.starts_with("typedef ") ? line.rfind(' ') : line.find(' ')) + 1;
      for (std::size_t end = line.find("::", name); end < line.find_first_of(" ;[", name);
           end = line.find("::", name)) {
        result += "module " + line.substr(name, end - name) + " {\n";
        line.erase(name, end + 2 - name);
        ++open;
      }
    }
    result += annotations + line + "\n";
    annotations.clear();
    if (!line.starts_with("};") && !(defines && line.ends_with(';'))) continue;
    for (; open > 0; --open) result += "};\n";
  }
  return result;
}

/// Text of a type that discovery describes, or "".  Fast DDS has fetched the objects of its peers'
/// types before it announces an endpoint; what another vendor describes it passes over.
inline std::string idl_of(const edds::xtypes::TypeInformationParameter& announced) {
  if (!announced.assigned()) return "";
  const auto& described = announced.type_information.complete();
  std::vector<std::uint32_t> object_bytes{
      described.typeid_with_size().typeobject_serialized_size()};
  for (const auto& each : described.dependent_typeids()) {
    object_bytes.push_back(each.typeobject_serialized_size());
  }
  if (!is_bounded(object_bytes)) return "";
  edds::xtypes::TypeObject object;
  auto& registry = edds::DomainParticipantFactory::get_instance()->type_object_registry();
  if (!ok(registry.get_type_object(described.typeid_with_size().type_id(), object))) return "";
  const auto builder =
      edds::DynamicTypeBuilderFactory::get_instance()->create_type_w_type_object(object);
  const auto type = builder ? builder->build() : nullptr;
  std::ostringstream text;
  return type && ok(edds::idl_serialize(type, text)) ? in_modules(text.str()) : "";
}

/// Passes on what discovery announces, in the form that does not depend on Fast DDS's version.
class DiscoveryListener : public edds::DomainParticipantListener {
 public:
  virtual void on_participant(const AnnouncedParticipant& /*participant*/) {}
  virtual void on_writer(const AnnouncedWriter& /*writer*/) {}

 private:
  void on_participant_discovery(edds::DomainParticipant* /*own*/,
                                ertps::ParticipantDiscoveryStatus reason,
                                const edds::ParticipantBuiltinTopicData& info,
                                bool& /*ignore*/) final {
    using Status = ertps::ParticipantDiscoveryStatus;
    on_participant(
        {info.guid.guidPrefix, info.participant_name.to_string(), info.user_data.data_vec(),
         reason == Status::DISCOVERED_PARTICIPANT || reason == Status::CHANGED_QOS_PARTICIPANT});
  }
  void on_data_writer_discovery(edds::DomainParticipant* /*own*/,
                                ertps::WriterDiscoveryStatus reason,
                                const edds::PublicationBuiltinTopicData& info,
                                bool& /*ignore*/) final {
    edds::WriterQos qos;
    qos.m_reliability = info.reliability;
    qos.m_durability = info.durability;
    qos.m_liveliness = info.liveliness;
    qos.m_ownership = info.ownership;
    qos.m_deadline = info.deadline;
    qos.m_lifespan = info.lifespan;
    qos.m_userData = info.user_data;
    qos.m_partition = info.partition;
    qos.representation = info.representation;
    on_writer({info.guid, info.topic_name.to_string(), info.type_name.to_string(), qos,
               reason != ertps::WriterDiscoveryStatus::REMOVED_WRITER,
               idl_of(info.type_information)});
  }
};

}  // namespace stillhand::runtime
