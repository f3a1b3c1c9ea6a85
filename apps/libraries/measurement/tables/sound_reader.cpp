// SPDX-License-Identifier: Apache-2.0
// Sound files: WAV of data loggers and accelerometers, and what else libsndfile reads.
#include <sndfile.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

#include "apps/libraries/measurement/tables/guarded_table.hpp"
#include "apps/libraries/measurement/tables/in_child.hpp"

namespace stillhand::measurement {
namespace {

constexpr int kMostChannels = 256;
constexpr sf_count_t kBlockFrames = 4096;

struct SoundClose {
  void operator()(SNDFILE* file) const { sf_close(file); }
};

struct Sound {
  SF_INFO info{};
  std::unique_ptr<SNDFILE, SoundClose> file;

  explicit Sound(const std::string& path) {
    file.reset(sf_open(path.c_str(), SFM_READ, &info));
    if (!file) throw Refused{path, sf_strerror(nullptr), "a sound file (WAV, FLAC, ...)"};
    if (info.channels < 1 || info.channels > kMostChannels || info.frames < 1 ||
        info.samplerate < 1) {
      throw Refused{path,
                    std::to_string(info.frames) + " samples of " + std::to_string(info.channels) +
                        " channels at " + std::to_string(info.samplerate) + " Hz",
                    "a sound file with samples"};
    }
  }
};

// Size of the whole file that the head of a RIFF (WAV) or FORM (AIFF) file states; 0: it states
// none, as one that was written into a pipe.
std::uint64_t stated_bytes(const std::string& path) {
  std::array<unsigned char, 8> head{};
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(head.data()), head.size())) return 0;
  const std::string_view magic(reinterpret_cast<const char*>(head.data()), 4);
  if (magic != "RIFF" && magic != "FORM") return 0;
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < 4; ++i) size = size << 8U | head.at(magic == "RIFF" ? 7 - i : 4 + i);
  return size == 0 || size == UINT32_MAX ? 0 : std::uint64_t{size} + head.size();
}

TableHead sound_head(const std::string& path) {
  const Sound sound(path);
  TableHead head;
  head.path = path;
  const std::uint64_t bytes = std::filesystem::file_size(path);
  // One byte may be the padding of an odd chunk.
  if (const std::uint64_t stated = stated_bytes(path); stated > bytes + 1) {
    head.notes.push_back("The file is cut off: " + std::to_string(bytes) + " of " +
                         std::to_string(stated) + " bytes.");
  }
  head.form = "Sound file of " + std::to_string(sound.info.samplerate) +
              " Hz; full scale of whole numbers is 1";
  head.rate_hz = sound.info.samplerate;
  for (int i = 1; i <= sound.info.channels; ++i) {
    const std::string title = "channel " + std::to_string(i);
    head.columns.push_back({title, title, {}, static_cast<std::size_t>(sound.info.frames)});
  }
  return head;
}

RawColumns sound_values(const std::string& path, const TableHead& /*head*/,
                        const std::vector<std::size_t>& columns) {
  const Sound sound(path);
  const auto channels = static_cast<std::size_t>(sound.info.channels);
  RawColumns out;
  out.values.resize(columns.size());
  for (auto& values : out.values) values.reserve(static_cast<std::size_t>(sound.info.frames));
  std::vector<double> block(static_cast<std::size_t>(kBlockFrames) * channels);
  sf_count_t total = 0;
  for (;;) {
    const sf_count_t frames = sf_readf_double(sound.file.get(), block.data(), kBlockFrames);
    if (frames <= 0) break;
    total += frames;
    for (sf_count_t i = 0; i < frames; ++i) {
      for (std::size_t c = 0; c < columns.size(); ++c) {
        out.values[c].push_back(block[static_cast<std::size_t>(i) * channels + columns[c]]);
      }
    }
  }
  if (total != sound.info.frames) {
    out.notes.push_back("The file is cut off: " + std::to_string(total) + " of " +
                        std::to_string(sound.info.frames) + " samples.");
  }
  return out;
}

}  // namespace

BinaryReader sound_reader() { return {sound_head, sound_values}; }

}  // namespace stillhand::measurement
