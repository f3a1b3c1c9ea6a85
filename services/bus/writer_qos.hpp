// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand::runtime {

/// No deadline, lifespan or lease: DDS's infinite duration.
inline constexpr std::int64_t kForever_ns = INT64_MAX;

enum class Durability : std::uint8_t { kVolatile, kTransientLocal, kTransient, kPersistent };
enum class Liveliness : std::uint8_t { kAutomatic, kManualByParticipant, kManualByTopic };

/// The policies of a writer that a recording keeps and a replay offers again.
/// Plain, without DDS.
struct WriterQos {
  bool reliable = false;
  Durability durability = Durability::kVolatile;
  Liveliness liveliness = Liveliness::kAutomatic;
  bool exclusive = false;  ///< OWNERSHIP
  std::int64_t deadline_ns = kForever_ns;
  std::int64_t lifespan_ns = kForever_ns;
  std::int64_t lease_ns = kForever_ns;  ///< of LIVELINESS
  /// Discovery does not carry HISTORY: 0 unless the writer's profile is known.
  std::int32_t depth = 0;  ///< [-] KEEP_LAST, -1: KEEP_ALL, 0: not known
  bool xcdr2 = false;      ///< DATA_REPRESENTATION: samples are XCDR 2 instead of plain CDR
  bool keyed = false;      ///< its type has a key: a reader without one does not match
  bool operator==(const WriterQos&) const = default;
};

}  // namespace stillhand::runtime
