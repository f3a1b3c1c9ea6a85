// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stillhand::recording {

/// Kind of a damage.
enum class DamageKind {
  kNoMagic,         ///< the file does not begin like an MCAP file
  kNoFooter,        ///< no valid footer: cut off, or its end is damaged; the file was scanned
  kBadSummary,      ///< footer valid, summary not; the file was scanned
  kBadRecord,       ///< a record whose length or fields contradict themselves
  kCutOff,          ///< the last record is not complete
  kBadChunk,        ///< cannot be decompressed, or its checksum differs: the whole chunk is lost
  kTooLarge,        ///< a chunk or record beyond McapReaderOptions; not read
  kUnknownChannel,  ///< messages whose Channel record is lost
  kUnknownRecord,   ///< a record of an unknown kind; the scan skipped it
  kBadDataSection,  ///< found by verify(): the checksum of the whole data section differs
};

/// One finding.
struct Damage {
  DamageKind kind;
  std::uint64_t offset;      ///< [B] in the file
  std::uint64_t lost_bytes;  ///< [B] of the file that are lost by this damage
  std::string text;          ///< one line for a person
};

/// [B] lost by all of the damage.
inline std::uint64_t lost_bytes(const std::vector<Damage>& damage) noexcept {
  std::uint64_t sum = 0;
  for (const Damage& each : damage) sum += each.lost_bytes;
  return sum;
}

}  // namespace stillhand::recording
