// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "fast_dds/cdr.hpp"

namespace stillhand_msgs {
class MotorCommand;
class TrackingSample;
class TrialAssignment;
class FeedthroughModel;
class AugmentedModel;
class Event;
}  // namespace stillhand_msgs

namespace stillhand {

/// A message as it was before fields were added at its end: how to recognise it, and how many zero
/// bytes make it one of today.  Zero is what the added fields are without a mitigation.
struct EarlierForm {
  std::size_t size = 0;     ///< [bytes] with the encapsulation; 0: any
  std::size_t missing = 0;  ///< [bytes] to add behind a multiple of 4; 0: no earlier form
  [[nodiscard]] bool fits(std::size_t bytes) const noexcept {
    // A transport fills a message up to four bytes.
    return missing > 0 && (size == 0 || bytes == size || bytes == (size + 3) / 4 * 4);
  }
};
template <typename Message>
inline constexpr EarlierForm kEarlierForm{};
// Sizes follow from the fields before the added ones, by CDR's alignment to 8 bytes.
template <>
inline constexpr EarlierForm kEarlierForm<stillhand_msgs::MotorCommand>{80, 16};
template <>
inline constexpr EarlierForm kEarlierForm<stillhand_msgs::TrackingSample>{56, 12};
template <>
inline constexpr EarlierForm kEarlierForm<stillhand_msgs::TrialAssignment>{77, 11};
// Ends in a text, so its size varies: the one byte that was added is missing.
template <>
inline constexpr EarlierForm kEarlierForm<stillhand_msgs::FeedthroughModel>{0, 1};

// Ended in numbers of 8 bytes behind sequences: the length of an empty sequence, and a number of 4.
template <>
inline constexpr EarlierForm kEarlierForm<stillhand_msgs::AugmentedModel>{0, 8};

// Ends in a text, too.
template <>
inline constexpr EarlierForm kEarlierForm<stillhand_msgs::Event>{0, 4};

/// True for the types above, by their names in a schema.
inline bool has_earlier_form(std::string_view type) noexcept {
  return type == "stillhand_msgs::MotorCommand" || type == "stillhand_msgs::TrackingSample" ||
         type == "stillhand_msgs::TrialAssignment" || type == "stillhand_msgs::FeedthroughModel" ||
         type == "stillhand_msgs::AugmentedModel" || type == "stillhand_msgs::Event";
}

/// A message as it is sent and recorded: CDR with the 4-byte encapsulation header.  Padding is
/// zero, so equal messages are equal bytes.
template <typename Message>
std::vector<std::byte> to_cdr(const Message& message) {
  const auto written = [&message](eprosima::fastcdr::FastBuffer& buffer) {
    fast_cdr::PlainCdr cdr(buffer);
    cdr.serialize_encapsulation();
    fast_cdr::write(cdr, message);
    return cdr.length();
  };
  eprosima::fastcdr::FastBuffer grown;
  std::vector<std::byte> bytes(written(grown));  // Fast CDR leaves padding as it was
  eprosima::fastcdr::FastBuffer exact(reinterpret_cast<char*>(bytes.data()), bytes.size());
  written(exact);
  return bytes;
}

/// Decodes one message from its recorded bytes: CDR with the 4-byte encapsulation header.  A
/// message of the earlier form has zeros in the fields that were added since.
/// @return false if the bytes are another message; `message` is then unspecified.
template <typename Message>
bool from_cdr(std::span<const std::byte> bytes, Message& message) {
  const auto decoded = [&message](std::byte* begin, std::size_t size) {
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(begin), size);
    fast_cdr::PlainCdr cdr(buffer);
    try {
      cdr.read_encapsulation();
      return fast_cdr::read(cdr, size, message);
    } catch (const eprosima::fastcdr::exception::Exception&) {
      return false;
    }
  };
  // Fast CDR only reads here, but its buffer type needs a non-const pointer.
  if (decoded(const_cast<std::byte*>(bytes.data()), bytes.size())) return true;
  constexpr EarlierForm kEarlier = kEarlierForm<Message>;
  if (!kEarlier.fits(bytes.size())) return false;
  std::vector<std::byte> filled(bytes.begin(), bytes.end());
  filled.resize((filled.size() + 3) / 4 * 4 + kEarlier.missing);
  return decoded(filled.data(), filled.size());
}

}  // namespace stillhand
