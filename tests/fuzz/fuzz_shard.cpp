// SPDX-License-Identifier: Apache-2.0
// The file of a shard without its digest, which is added here: what only its writer could damage.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "apps/study/shard.hpp"
#include "services/contract/config_error.hpp"
#include "services/rig/sealed_file.hpp"

namespace {

using namespace stillhand;

std::string cbor_of(const std::string& text) {
  std::string bytes;
  nlohmann::json::to_cbor(text, bytes);
  return bytes;
}

// Of this process, for the one file.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("fuzz_shard_" + std::to_string(::getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

const std::filesystem::path& folder() {
  static const Folder own;
  return own.path;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string items(reinterpret_cast<const char*>(bytes), size);
  std::ofstream(folder() / study::kShardFile, std::ios::binary)
      << items << cbor_of(rig::sha256(items));
  try {
    const study::StudyRecord record = study::merged({folder()});
    // What is accepted can be written and read again.
    if (study::shard_file(record, {1, 1}).empty()) std::abort();
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}
