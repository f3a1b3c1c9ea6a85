// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "services/core/recording/mcap/byte_stream.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::recording {

/// Action if the file already exists.
enum class Existing { kRefuse, kReplace };

/// Condition for the return of write().
enum class Durability {
  kProcess,  ///< the operating system has the bytes: they survive the end of the process
  kPower     ///< the disk has the bytes (fdatasync): they survive a power failure, if the disk does
};

/// Sink on a file.  It is unbuffered: bytes accepted by write() survive the end of the process, and
/// after flush() (fdatasync) they survive a power failure.  The sink holds an advisory lock (flock)
/// for its lifetime; readers use the lock to detect a file in writing.  Thread-compatible.
class FileSink : public ByteSink {
 public:
  /// @throws ConfigError with the reason of the system if the file cannot be created.
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

/// Source on a file.  It reads the size once, at opening, and ignores bytes appended later.
/// Thread-compatible.
class FileSource : public ByteSource {
 public:
  /// @throws ConfigError if the file cannot be opened or is not a regular file.
  explicit FileSource(const std::string& path);
  ~FileSource() override;
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  Status read_at(std::uint64_t offset, std::span<std::byte> into) override;
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  /// True if a FileSink has the file open, or if the file has grown since its opening here.
  [[nodiscard]] bool being_written() const;

 private:
  std::string path_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

/// Writes all bytes, also if the system accepts them in parts.  @param written  grows by what it
/// took
Status write_all(int descriptor, const std::string& path, std::span<const std::byte> bytes,
                 std::uint64_t& written);

/// Replaces a file atomically: a reader sees either the old file or the complete new file.  Writes
/// a temporary file in the same folder, then calls fsync and rename.  After a failure the old file
/// remains and the temporary file is removed.
Status write_file_atomically(const std::string& path, std::string_view content);
/// The same.  @throws std::runtime_error with the file and the reason where that fails
void write_file(const std::filesystem::path& path, std::string_view content);

/// The whole file as text.  @throws ConfigError if it cannot be read.
std::string read_file(const std::string& path);
/// The same; empty if it cannot be read.  It may be one that the kernel makes, as in /proc.
std::string text_of(const std::filesystem::path& file);

/// parse_csv() of a file.  @throws ConfigError like read_file() and parse_csv().
Recording read_csv(const std::string& path);

}  // namespace stillhand::recording
