// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/core/recording/mcap/byte_stream.hpp"
#include "services/core/recording/mcap/clock_steps.hpp"
#include "services/core/recording/mcap/mcap_damage.hpp"
#include "services/core/recording/mcap/mcap_format.hpp"
#include "services/core/recording/mcap/source_window.hpp"

namespace stillhand::recording {

/// Limits of the memory that a file can make the reader allocate.
struct McapReaderOptions {
  std::uint64_t max_chunk_bytes = 256u << 20;  ///< [B] of one chunk (unpacked), record or summary
};

/// One message, valid only during the call.
struct MessageView {
  const Channel& channel;
  const Schema* schema;  ///< nullptr if the channel has none or it is lost
  std::uint32_t sequence;
  std::uint64_t log_time_ns;  ///< straight: without the steps of clock_steps()
  std::uint64_t publish_time_ns;
  std::span<const std::byte> bytes;
};

/// Selection of messages; the default is all.
struct MessageFilter {
  std::vector<std::string> topics;         ///< exact names; empty: every topic
  std::uint64_t start_time_ns = 0;         ///< first log time wanted
  std::uint64_t end_time_ns = UINT64_MAX;  ///< last log time wanted
};

/// Reads an MCAP file, whole or damaged, ours or foreign.
/// With a valid footer, the reader uses the summary.  Otherwise it scans the file from its start
/// and recovers every complete chunk with the right checksum (FORMAT.md, "Recovery").  It repairs
/// nothing by guessing; damage() lists everything that it drops.  It never allocates more than the
/// options allow, whatever a length field states.  Of a recording of Stillhand whose clock somebody
/// set, it gives the log times as if nobody had (FORMAT.md, "A clock that was set").
/// The source must outlive the reader.  Thread-compatible.  Throws only std::bad_alloc and the
/// exceptions of source and callback; after such an exception the reader must not be used.
class McapReader {
 public:
  explicit McapReader(ByteSource& source, McapReaderOptions options = {});

  /// Not ok if the source failed, contains no MCAP, or has a later version; all else is then empty.
  [[nodiscard]] const Status& status() const noexcept { return status_; }
  /// False if the reader scanned the file because it has no usable index.
  [[nodiscard]] bool indexed() const noexcept { return indexed_; }
  [[nodiscard]] const std::string& profile() const noexcept { return profile_; }
  [[nodiscard]] const std::string& library() const noexcept { return library_; }
  [[nodiscard]] const std::map<SchemaId, Schema>& schemas() const noexcept { return schemas_; }
  [[nodiscard]] const std::map<ChannelId, Channel>& channels() const noexcept { return channels_; }
  [[nodiscard]] const std::vector<Metadata>& metadata() const noexcept { return metadata_; }
  /// Compressions of the chunks read so far.
  [[nodiscard]] const std::set<Compression>& compressions() const noexcept { return compressions_; }
  /// From the summary, or counted by the scan.
  [[nodiscard]] const Statistics& statistics() const noexcept { return statistics_; }
  /// Steps of the recorder's clock, which are taken out of all log times and of statistics().
  [[nodiscard]] const std::vector<ClockStep>& clock_steps() const noexcept { return clock_steps_; }
  /// First metadata record of that name, or nullptr.
  [[nodiscard]] const Metadata* find_metadata(std::string_view name) const noexcept;

  /// Calls `take` for every selected message, in the order of the file; `take` returns false to
  /// stop.  Skips a damaged chunk and adds it to damage().
  Status for_each_message(const MessageFilter& filter,
                          const std::function<bool(const MessageView&)>& take);

  /// Reads the whole file, checks every checksum and adds the findings to damage().
  /// @param take  called for every message, as by for_each_message(); may be empty
  Status verify(const std::function<void(const MessageView&)>& take = {});

  /// Findings so far: of the opening, for_each_message() and verify().
  [[nodiscard]] const std::vector<Damage>& damage() const noexcept { return damage_; }
  /// Sum of lost_bytes.
  [[nodiscard]] std::uint64_t lost_bytes() const noexcept;

 private:
  struct Piece {  // a chunk record or a run of records outside chunks
    std::uint64_t offset;
    std::uint64_t length;
    bool is_chunk;
    std::uint64_t start_time_ns;  // of a chunk in the index; otherwise unlimited
    std::uint64_t end_time_ns;
  };
  struct Pass;     // one walk over messages
  struct Summary;  // temporary data from the summary

  // mcap_summary.cpp: opening with the index
  bool open_by_summary();
  bool take_summary(std::span<const std::byte> records, std::uint64_t summary_start);
  bool take_summary_record(Opcode opcode, std::span<const std::byte> content, Summary& summary);
  bool take_chunk_index(const ChunkIndex& index, std::uint64_t summary_start);
  void find_data_end(std::uint64_t summary_start);
  void load_metadata(std::uint64_t offset, std::uint64_t length, std::uint64_t end);
  void forget();

  // mcap_scan.cpp: opening without it
  void scan();
  std::uint64_t scan_record(std::uint64_t offset);
  bool scan_content(Opcode opcode, std::uint64_t offset, std::uint64_t length);
  bool scan_bounded(Opcode opcode, std::uint64_t offset, std::uint64_t length);
  bool scan_header(std::uint64_t length);
  bool scan_chunk(std::uint64_t offset, std::uint64_t length);
  bool proves_length(std::uint64_t offset, std::uint64_t length, std::uint64_t extra_bytes);
  bool may_follow(std::uint64_t offset);
  std::uint64_t next_chunk(std::uint64_t offset, std::uint64_t end);

  // mcap_reader.cpp
  std::optional<char> version_at(std::uint64_t offset);
  bool is_newer();
  bool read_header();
  void define(Schema schema, std::uint64_t offset);
  void define(Channel channel, std::uint64_t offset);
  void add_damage(DamageKind kind, std::uint64_t offset, std::uint64_t lost_bytes,
                  std::string text);

  // mcap_walk.cpp: from messages to the caller
  void count_messages();
  void walk(Pass& pass);
  void walk_piece(const Piece& piece, Pass& pass);
  void walk_chunk(const Piece& piece, Pass& pass);
  std::optional<std::span<const std::byte>> unpack_chunk(const Piece& piece);
  void walk_loose(const Piece& piece, Pass& pass);
  void walk_record(Opcode opcode, std::span<const std::byte> content, std::uint64_t offset,
                   Pass& pass);

  // mcap_clock.cpp: log times as if nobody had set the recorder's clock
  void straighten_clock();
  bool clock_may_have_stepped() const;
  std::optional<std::int64_t> clock_set_by_ns() const;
  std::uint64_t straight_time_ns(std::uint64_t log_time_ns, std::uint64_t offset, Pass& pass) const;

  ByteSource& source_;
  McapReaderOptions options_;
  Status status_;
  SourceWindow window_;
  bool indexed_ = false;
  std::string profile_;
  std::string library_;
  std::map<SchemaId, Schema> schemas_;
  std::map<ChannelId, Channel> channels_;
  std::vector<Metadata> metadata_;
  Statistics statistics_;
  std::set<Compression> compressions_;
  std::vector<Piece> pieces_;
  std::vector<Damage> damage_;
  std::vector<ClockStep> clock_steps_;
  std::optional<std::uint64_t> data_end_;  // offset of the Data End record
  std::vector<std::byte> packed_;
  std::vector<std::byte> unpacked_;
};

}  // namespace stillhand::recording
