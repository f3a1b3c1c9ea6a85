// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <string>

#include "services/core/contract/time_difference.hpp"
#include "services/core/recording/mcap/mcap_pass.hpp"

namespace stillhand::recording {
namespace {

std::optional<std::int64_t> number_in(const std::vector<Metadata>& metadata, const char* key) {
  for (const Metadata& record : metadata) {
    const auto found = record.texts.find(key);
    if (found == record.texts.end()) continue;
    const std::string& text = found->second;
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size()) return value;
  }
  return std::nullopt;
}

std::uint64_t distance(std::uint64_t a, std::uint64_t b) { return a < b ? b - a : a - b; }

}  // namespace

// What the recorder noted of the offset of its two clocks.
std::optional<std::int64_t> McapReader::clock_set_by_ns() const {
  const auto start = number_in(metadata_, "clock_offset_ns at start");
  const auto end = number_in(metadata_, "clock_offset_ns at end");
  if (!start || !end) return std::nullopt;
  return difference_ns(*end, *start);
}

// Without a look at the messages: a clock that was set, or a chunk that begins before the end of
// the one before it.
bool McapReader::clock_may_have_stepped() const {
  constexpr auto kLeast_ns = ClockStepFinder::kLeast_ns;
  if (std::abs(clock_set_by_ns().value_or(0)) > kLeast_ns) return true;
  const auto goes_back = [](const Piece& a, const Piece& b) {
    return b.start_time_ns < a.end_time_ns && a.end_time_ns - b.start_time_ns > kLeast_ns;
  };
  return std::ranges::adjacent_find(pieces_, goes_back) != pieces_.end();
}

void McapReader::straighten_clock() {
  const Metadata* session = find_metadata("stillhand.session");
  // Recorders of today log by a clock that nobody sets, and say so.
  if (profile_ != kProfile || session == nullptr || session->texts.contains("log_clock")) return;
  if (indexed_ && !clock_may_have_stepped()) return;
  const MessageFilter everything;
  const std::function<bool(const MessageView&)> nothing = [](const MessageView&) { return true; };
  const bool streams = std::ranges::any_of(channels_, [this](const auto& entry) {
    return Pass::is_stream(entry.second) &&
           statistics_.channel_message_counts.contains(entry.first);
  });
  ClockStepFinder finder(streams);
  Pass looking{everything, nothing};
  looking.finder = &finder;
  walk(looking);
  clock_steps_ = finder.found(clock_set_by_ns());
  if (clock_steps_.empty()) return;

  statistics_.start_time_ns = UINT64_MAX;
  statistics_.end_time_ns = 0;
  Piece* current = nullptr;
  const std::function<bool(const MessageView&)> extend = [&](const MessageView& message) {
    current->start_time_ns = std::min(current->start_time_ns, message.log_time_ns);
    current->end_time_ns = std::max(current->end_time_ns, message.log_time_ns);
    return true;
  };
  Pass extending{everything, extend};
  for (Piece& piece : pieces_) {
    piece.start_time_ns = UINT64_MAX;
    piece.end_time_ns = 0;
    current = &piece;
    walk_piece(piece, extending);
    statistics_.start_time_ns = std::min(statistics_.start_time_ns, piece.start_time_ns);
    statistics_.end_time_ns = std::max(statistics_.end_time_ns, piece.end_time_ns);
  }
}

// Threads of a recorder overtake each other: around a step in this chunk a message may still, or
// already, have its time of the other side.  It belongs next to the one before it.
std::uint64_t McapReader::straight_time_ns(std::uint64_t log_time_ns, std::uint64_t offset,
                                           Pass& pass) const {
  const auto step_ns = [&](std::size_t i) {
    return static_cast<std::uint64_t>(clock_steps_[i].by_ns);
  };
  const auto in_this = [&](std::size_t i) { return clock_steps_[i].chunk == offset; };
  const std::size_t count = clock_steps_.size();
  for (; pass.step < count &&
         (clock_steps_[pass.step].chunk < offset ||
          (in_this(pass.step) && clock_steps_[pass.step].message <= pass.message));
       ++pass.step) {
    pass.shift_ns += step_ns(pass.step);
  }
  std::uint64_t best_ns = log_time_ns - pass.shift_ns;
  const auto consider = [&](std::uint64_t shift_ns) {
    const std::uint64_t other_ns = log_time_ns - shift_ns;
    if (pass.newest_ns &&
        distance(other_ns, *pass.newest_ns) < distance(best_ns, *pass.newest_ns)) {
      best_ns = other_ns;
    }
  };
  if (pass.step > 0 && in_this(pass.step - 1)) consider(pass.shift_ns - step_ns(pass.step - 1));
  if (pass.step < count && in_this(pass.step)) consider(pass.shift_ns + step_ns(pass.step));
  pass.newest_ns = best_ns;
  return best_ns;
}

}  // namespace stillhand::recording
