// SPDX-License-Identifier: Apache-2.0
#include "services/files/recording/file_io.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/csv.hpp"

namespace stillhand::recording {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

Status failure(const std::string& path, const std::string& step, int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return Status::failure(full ? StatusKind::kNoSpace : StatusKind::kIo,
                         path + ": " + step + ": " + reason(error));
}

}  // namespace

Status write_all(int descriptor, const std::string& path, std::span<const std::byte> bytes,
                 std::uint64_t& written) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0) {
      if (errno == EINTR) continue;
      return failure(path, "cannot write", errno);
    }
    written += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return {};
}

FileSink::FileSink(const std::string& path, Existing existing, Durability durability)
    : path_(path),
      durability_(durability),
      descriptor_(::open(
          path.c_str(),
          O_WRONLY | O_CREAT | O_CLOEXEC | (existing == Existing::kRefuse ? O_EXCL : O_TRUNC),
          0644)) {
  if (descriptor_ < 0) {
    throw ConfigError(path, reason(errno),
                      errno == EEXIST ? "an unused name" : "a file that can be created");
  }
  // A failure is ignored: on a file system without locks, readers only lose this information.
  (void)::flock(descriptor_, LOCK_EX | LOCK_NB);
}

FileSink::~FileSink() { ::close(descriptor_); }

Status FileSink::write(std::span<const std::byte> bytes) {
  const Status written = write_all(descriptor_, path_, bytes, size_);
  return written.ok() && durability_ == Durability::kPower ? flush() : written;
}

Status FileSink::flush() {
  // EINVAL: a pipe or a device cannot be synchronised.
  if (::fdatasync(descriptor_) != 0 && errno != EINVAL) {
    return failure(path_, "cannot synchronise", errno);
  }
  return {};
}

FileSource::FileSource(const std::string& path)
    // Without O_NONBLOCK, a pipe without a writer would block, and every signal is masked.
    : path_(path), descriptor_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  if (descriptor_ < 0) throw ConfigError(path, reason(errno), "a file that can be read");
  struct stat facts = {};
  if (::fstat(descriptor_, &facts) != 0 || !S_ISREG(facts.st_mode)) {
    ::close(descriptor_);
    const auto session = std::filesystem::path(path) / "session.mcap";
    std::error_code ignored;
    throw ConfigError(path, "not a regular file",
                      std::filesystem::exists(session, ignored) ? session.string() : "a file");
  }
  size_ = static_cast<std::uint64_t>(facts.st_size);
}

FileSource::~FileSource() { ::close(descriptor_); }

bool FileSource::being_written() const {
  struct stat facts = {};
  if (::fstat(descriptor_, &facts) == 0 && static_cast<std::uint64_t>(facts.st_size) > size_) {
    return true;
  }
  if (::flock(descriptor_, LOCK_SH | LOCK_NB) != 0) return errno == EWOULDBLOCK;
  (void)::flock(descriptor_, LOCK_UN);
  return false;
}

Status FileSource::read_at(std::uint64_t offset, std::span<std::byte> into) {
  while (!into.empty()) {
    const ssize_t count =
        ::pread(descriptor_, into.data(), into.size(), static_cast<off_t>(offset));
    if (count < 0) {
      if (errno == EINTR) continue;
      return failure(path_, "cannot read", errno);
    }
    if (count == 0) {
      return Status::failure(StatusKind::kIo, path_ + ": cannot read: the file became shorter");
    }
    offset += static_cast<std::uint64_t>(count);
    into = into.subspan(static_cast<std::size_t>(count));
  }
  return {};
}

Status write_file_atomically(const std::string& path, std::string_view content) {
  // The process number distinguishes two writers of one name.
  const std::string temporary = path + ".new-" + std::to_string(::getpid());
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) return failure(temporary, "cannot create", errno);
  std::uint64_t written = 0;
  Status status = write_all(descriptor, temporary, std::as_bytes(std::span(content)), written);
  if (status.ok() && ::fsync(descriptor) != 0) {
    status = failure(temporary, "cannot synchronise", errno);
  }
  if (::close(descriptor) != 0 && status.ok()) status = failure(temporary, "cannot close", errno);
  if (status.ok() && std::rename(temporary.c_str(), path.c_str()) != 0) {
    status = failure(path, "cannot replace", errno);
  }
  if (!status.ok()) ::unlink(temporary.c_str());
  return status;
}

void write_file(const std::filesystem::path& path, std::string_view content) {
  const Status status = write_file_atomically(path.string(), content);
  if (!status.ok()) throw std::runtime_error(status.text);
}

std::string read_file(const std::string& path) {
  FileSource source(path);
  std::string text(static_cast<std::size_t>(source.size()), '\0');
  const Status status = source.read_at(0, std::as_writable_bytes(std::span(text)));
  if (!status.ok()) throw ConfigError(path, status.text, "a file that can be read");
  return text;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

Recording read_csv(const std::string& path) { return parse_csv(read_file(path), path); }

}  // namespace stillhand::recording
