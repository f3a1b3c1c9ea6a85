// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/recover.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <system_error>

#include "apps/recordings/pending_file.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_loss.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "version.hpp"

namespace stillhand::recordings {
namespace {

namespace fs = std::filesystem;

// The metadata does not list each of thousands of damaged chunks.
constexpr std::size_t kMostNamed = 100;

// The new file, with the topics of the old one under their new numbers.
class Copy {
 public:
  Copy(recording::McapReader& reader, recording::ByteSink& sink, recording::Compression compression)
      : reader_(reader), writer_(sink, options_of(reader, compression)) {
    for (const recording::Metadata& metadata : reader.metadata()) {
      check(writer_.add_metadata(metadata.name, metadata.texts));
    }
    std::map<recording::SchemaId, recording::SchemaId> schemas;
    for (const auto& [id, schema] : reader.schemas()) {
      schemas[id] = writer_.add_schema(schema.name, schema.encoding, schema.bytes);
    }
    for (const auto& [id, channel] : reader.channels()) {
      const auto schema = schemas.find(channel.schema_id);
      channels_[id] = writer_.add_channel(
          channel.topic, schema == schemas.end() ? recording::SchemaId{0} : schema->second,
          channel.message_encoding, channel.metadata);
    }
  }

  std::uint64_t copy_messages() {
    std::uint64_t messages = 0;
    recording::Status written;
    check(reader_.for_each_message({}, [&](const recording::MessageView& message) {
      written = writer_.write(channels_.at(message.channel.id), message.sequence,
                              message.log_time_ns, message.publish_time_ns, message.bytes);
      ++messages;
      return written.ok();
    }));
    check(written);
    return messages;
  }

  void close(const recording::TextMap& recovery) {
    check(writer_.add_metadata("stillhand.recovery", recovery));
    check(writer_.close());
  }

 private:
  static recording::McapWriterOptions options_of(const recording::McapReader& reader,
                                                 recording::Compression compression) {
    recording::McapWriterOptions options;
    options.compression = compression;
    options.library = reader.library();
    options.profile = reader.profile();
    return options;
  }

  recording::McapReader& reader_;
  recording::McapWriter writer_;
  std::map<recording::ChannelId, recording::ChannelId> channels_;
};

recording::TextMap summary_of(const Recovered& result, const std::string& path) {
  recording::TextMap texts{{"from", fs::path(path).filename().string()},
                           {"program", std::string("stillhand ") + kVersion},
                           {"messages", std::to_string(result.messages)},
                           {"lost_bytes", std::to_string(result.lost_bytes)},
                           {"findings", std::to_string(result.findings.size())}};
  for (std::size_t i = 0; i < std::min(result.findings.size(), kMostNamed); ++i) {
    texts["finding " + std::to_string(i)] = result.findings[i];
  }
  return texts;
}

// The old file under a second name, without a moment in which it has none.
void keep_as(const std::string& path, const std::string& kept) {
  if (::link(path.c_str(), kept.c_str()) == 0) return;
  if (errno == EEXIST) {
    throw ConfigError(kept, "a file that exists", "a name that does not exist yet, or --out");
  }
  // A file system without second names.
  fs::copy_file(path, kept);
}

std::vector<std::string> findings_of(const std::string& path, const recording::McapReader& reader) {
  std::vector<std::string> findings;
  if (!reader.clock_steps().empty()) findings.push_back(recording::clock_line(path, reader));
  for (const recording::Damage& damage : reader.damage()) {
    findings.push_back(fmt::format(
        "byte {}: {}{}", damage.offset, damage.text,
        damage.lost_bytes == 0 ? "" : fmt::format(" ({} bytes lost)", damage.lost_bytes)));
  }
  return findings;
}

void refuse_what_cannot_be_mended(const OpenRecording& old) {
  if (old.source.being_written()) {
    throw ConfigError(old.path, "a file that is still being written",
                      "one whose recorder has ended");
  }
}

}  // namespace

Recovered recover(const std::string& path, const RecoverOptions& options) {
  OpenRecording old(path, options.stopped);
  refuse_what_cannot_be_mended(old);
  Recovered result;
  result.was_whole =
      old.reader.verify().ok() && old.reader.damage().empty() && old.reader.clock_steps().empty();
  check(old.reader.status());
  if (result.was_whole) {
    result.messages = old.reader.statistics().message_count;
    return result;
  }
  const bool in_place = options.out.empty();
  // A link of the file stands for the file.
  const std::string place = in_place ? fs::canonical(path).string() : options.out.string();
  const std::string kept = place + ".damaged";
  if (fs::exists(in_place ? kept : place)) {
    throw ConfigError(
        in_place ? kept : place, "a file that exists",
        in_place ? "a name that does not exist yet, or --out" : "a name that does not exist yet");
  }
  PendingFile pending(place);
  recording::FileSink sink(pending.path());
  Copy copy(old.reader, sink, options.compression);
  result.messages = copy.copy_messages();
  if (result.messages == 0 && old.reader.metadata().empty()) {
    throw std::runtime_error(path +
                             ": no message and no metadata can be read; no file was written");
  }
  result.lost_bytes = old.reader.lost_bytes();
  result.attachments = old.reader.statistics().attachment_count;
  result.findings = findings_of(path, old.reader);
  copy.close(summary_of(result, path));
  refuse_what_cannot_be_mended(old);  // it may have begun to grow again
  go_on_unless(options.stopped);
  if (in_place) {
    keep_as(place, kept);
    try {
      pending.publish();
    } catch (...) {
      ::unlink(kept.c_str());  // the old file still has its own name
      throw;
    }
    result.kept = kept;
  } else {
    pending.publish_new();
  }
  result.out = place;
  return result;
}

}  // namespace stillhand::recordings
