// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/bus_recording.hpp"

#include <utility>

#include "services/bus/recording/session_texts.hpp"

namespace stillhand::recording {

namespace {

TapeOptions with_words(TapeOptions options, std::function<std::vector<Metadata>()> words) {
  options.last_words = std::move(words);
  return options;
}

}  // namespace

BusRecording::BusRecording(TapeOptions options)
    : tally_(&tape_), tape_(with_words(std::move(options), [this] { return last_words(); })) {}

void BusRecording::take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample) {
  tally_.take(writer, sample);
  trials_.take(writer, sample);
}

std::vector<Metadata> BusRecording::last_words() const {
  std::vector<Metadata> words{{"stillhand.counts", tally_.texts()},
                              {"stillhand.trials", trials_.texts()}};
  words.front().texts["clock_offset_ns at end"] = clock_offset();
  return words;
}

}  // namespace stillhand::recording
