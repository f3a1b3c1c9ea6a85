// SPDX-License-Identifier: Apache-2.0
// MCAP files as the verbs read them: a session's trial, or every column of a recording of ROS 2.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <numeric>
#include <string>

#include "apps/libraries/measurement/read.hpp"
#include "apps/libraries/measurement/tables/bag_table.hpp"
#include "services/core/contract/config_error.hpp"

namespace {

using namespace stillhand;

constexpr std::size_t kMostValues = 1'000'000;

// A file without a disk, under a path of its own as long as it lives.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* bytes, std::size_t size) : descriptor_(memfd_create("bag", 0)) {
    if (descriptor_ < 0 || write(descriptor_, bytes, size) != static_cast<ssize_t>(size)) {
      std::abort();
    }
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

void read_every_column(const std::string& path) {
  const auto table = measurement::bag_table(path, kMostValues);
  std::vector<std::size_t> columns(table->head().columns.size());
  std::iota(columns.begin(), columns.end(), std::size_t{0});
  table->read(columns);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const MemoryFile file(bytes, size);
  // Other kinds of files are read by other libraries, in a process of their own.
  if (measurement::kind_of(file.path()) != measurement::FileKind::kMcap) return 0;
  try {
    measurement::read_measurement(file.path(), {.most_values = kMostValues});
  } catch (const ConfigError&) {
  }
  try {
    read_every_column(file.path());
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}
