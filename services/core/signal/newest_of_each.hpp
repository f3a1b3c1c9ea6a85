// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>

namespace stillhand::signal {

/// Which of the numbered requests of several senders are new, where each sender's numbers grow and
/// a request may come several times.  Remembers the kMost senders that were heard last, so that a
/// stranger's names fill no memory.  Pure; one thread.
template <typename Sender>
class NewestOfEach {
 public:
  static constexpr std::size_t kMost = 100;

  /// @returns true for a number above 0 and all that the sender had before
  bool take(const Sender& sender, std::uint64_t number) {
    const auto known =
        std::ranges::find(heard_, sender, [](const auto& each) { return each.first; });
    const std::uint64_t before = known == heard_.end() ? 0 : known->second;
    if (known != heard_.end()) heard_.erase(known);
    heard_.emplace_back(sender, std::max(before, number));
    if (heard_.size() > kMost) heard_.pop_front();
    return number > before;
  }

 private:
  std::deque<std::pair<Sender, std::uint64_t>> heard_;  // the last one at the end
};

}  // namespace stillhand::signal
