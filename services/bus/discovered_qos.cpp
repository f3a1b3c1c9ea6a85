// SPDX-License-Identifier: Apache-2.0
#include "services/bus/discovered_qos.hpp"

#include <cstdint>

#include "services/system/process/clock.hpp"

namespace stillhand::runtime {

namespace {

std::int64_t ns_of(const edds::Duration_t& duration) {
  if (duration == edds::c_TimeInfinite) return kForever_ns;
  return duration.seconds * kNsPerSecond + duration.nanosec;
}

// A recording may hold a duration that DDS's 32 bits of seconds do not: 68 years are for ever.
edds::Duration_t duration_of(std::int64_t ns) {
  if (ns / kNsPerSecond >= INT32_MAX) return edds::c_TimeInfinite;
  return {static_cast<std::int32_t>(ns / kNsPerSecond),
          static_cast<std::uint32_t>(ns % kNsPerSecond)};
}

// A writer that keeps less than a burst of its own loses what a reliable reader asks for again.
constexpr std::int32_t kUnknownDepth = 100;

}  // namespace

void announce(edds::DataRepresentationQosPolicy& policy,
              std::vector<edds::DataRepresentationId_t> offered) {
  policy.m_value = std::move(offered);
  policy.hasChanged = true;
}

WriterQos discovered_qos(const edds::WriterQos& announced) {
  WriterQos qos;
  qos.reliable = announced.m_reliability.kind == edds::RELIABLE_RELIABILITY_QOS;
  qos.durability = static_cast<Durability>(announced.m_durability.kind);
  qos.liveliness = static_cast<Liveliness>(announced.m_liveliness.kind);
  qos.exclusive = announced.m_ownership.kind == edds::EXCLUSIVE_OWNERSHIP_QOS;
  qos.deadline_ns = ns_of(announced.m_deadline.period);
  qos.lifespan_ns = ns_of(announced.m_lifespan.duration);
  qos.lease_ns = ns_of(announced.m_liveliness.lease_duration);
  // A writer uses the first that it offers; none is plain CDR.
  const auto& offered = announced.representation.m_value;
  qos.xcdr2 = !offered.empty() && offered.front() == edds::XCDR2_DATA_REPRESENTATION;
  return qos;
}

std::optional<WriterQos> profile_qos(const edds::Publisher& publisher, const std::string& name) {
  edds::DataWriterQos profile;
  if (!ok(publisher.get_datawriter_qos_from_profile(name, profile))) {
    return std::nullopt;
  }
  WriterQos qos = discovered_qos(profile.get_writerqos({}, {}));
  qos.depth = profile.history().kind == edds::KEEP_ALL_HISTORY_QOS ? -1 : profile.history().depth;
  return qos;
}

edds::DataWriterQos offered_qos(const WriterQos& wanted) {
  edds::DataWriterQos qos;
  qos.reliability().kind =
      wanted.reliable ? edds::RELIABLE_RELIABILITY_QOS : edds::BEST_EFFORT_RELIABILITY_QOS;
  // Kept in this process's memory only: what was persistent is offered as transient local.
  qos.durability().kind = wanted.durability == Durability::kVolatile
                              ? edds::VOLATILE_DURABILITY_QOS
                              : edds::TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.liveliness().kind = static_cast<edds::LivelinessQosPolicyKind>(wanted.liveliness);
  qos.liveliness().lease_duration = duration_of(wanted.lease_ns);
  if (qos.liveliness().lease_duration != edds::c_TimeInfinite) {
    qos.liveliness().announcement_period = duration_of(wanted.lease_ns * 3 / 10);
  }
  qos.ownership().kind =
      wanted.exclusive ? edds::EXCLUSIVE_OWNERSHIP_QOS : edds::SHARED_OWNERSHIP_QOS;
  qos.deadline().period = duration_of(wanted.deadline_ns);
  qos.lifespan().duration = duration_of(wanted.lifespan_ns);
  if (wanted.xcdr2) announce(qos.representation(), {edds::XCDR2_DATA_REPRESENTATION});
  const std::int32_t depth = wanted.depth > 0 ? wanted.depth : kUnknownDepth;
  if (wanted.depth < 0) {
    qos.history().kind = edds::KEEP_ALL_HISTORY_QOS;
  } else {
    qos.history().kind = edds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = depth;
    // A recording may hold several rigs and services, each a key of its own.
    constexpr std::int32_t kInstances = 64;
    qos.resource_limits().max_instances = kInstances;
    qos.resource_limits().max_samples_per_instance = depth;
    // The same from a recording may be too many for a product: no limit then.
    qos.resource_limits().max_samples =
        depth <= INT32_MAX / kInstances ? depth * kInstances : edds::LENGTH_UNLIMITED;
  }
  qos.data_sharing().off();
  qos.endpoint().history_memory_policy = ertps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  heartbeat_period(qos) = duration_of(kNsPerSecond / 10);
  return qos;
}

}  // namespace stillhand::runtime
