// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "services/recording/core/mcap/byte_stream.hpp"
#include "services/recording/core/recording.hpp"

namespace stillhand::recording {

/// What to do about a file that is already there.
enum class Existing { kRefuse, kReplace };

/// What write() to a file waits for.
enum class Durability {
  kProcess,  ///< the system has it: it survives the end of the process
  kPower     ///< the disk has it (fdatasync): it survives a loss of power, as far as the disk does
};

/// Sink on a file.  Unbuffered: what write() accepted survives the end of the process; flush()
/// makes it survive a loss of power (fdatasync).  Holds an advisory lock (flock) as long as it
/// lives, by which readers know that the file is still being written.  Thread-compatible.
class FileSink : public ByteSink {
 public:
  /// @throws ConfigError when the file cannot be made, with the system's reason.
  explicit FileSink(const std::string& path, Existing existing = Existing::kRefuse,
                    Durability durability = Durability::kProcess);
  ~FileSink() override;
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;

  Status write(std::span<const std::byte> bytes) override;
  Status flush() override;
  [[nodiscard]] std::uint64_t size() const override { return size_; }

 private:
  std::string path_;
  Durability durability_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

/// Source on a file; its size is taken once, at opening: what is appended later is not seen.
/// Thread-compatible.
class FileSource : public ByteSource {
 public:
  /// @throws ConfigError when the file cannot be opened or is no regular file.
  explicit FileSource(const std::string& path);
  ~FileSource() override;
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  Status read_at(std::uint64_t offset, std::span<std::byte> into) override;
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  /// A FileSink has it open at this moment, or it grew since it was opened here.
  [[nodiscard]] bool being_written() const;

 private:
  std::string path_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

/// Writes a file so that a reader sees the old one or the whole new one: temporary file beside it,
/// fsync, rename.  On failure the old file stays and the temporary one is removed.
Status write_file_atomically(const std::string& path, std::string_view content);

/// Whole file as text.  @throws ConfigError when it cannot be read.
std::string read_file(const std::string& path);

/// parse_csv() on a file.  @throws ConfigError as both do.
Recording read_csv(const std::string& path);
/// to_csv() into a file, atomically.
Status write_csv(const std::string& path, const Recording& recording);

}  // namespace stillhand::recording
