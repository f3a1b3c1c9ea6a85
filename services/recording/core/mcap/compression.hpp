// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "services/recording/core/mcap/mcap_format.hpp"
#include "services/recording/core/status.hpp"

namespace stillhand::recording {

/// The name that a Chunk record carries: "", "lz4" or "zstd".
std::string_view compression_name(Compression compression) noexcept;
/// The reverse; nullopt for a name that Stillhand does not know.
std::optional<Compression> compression_of(std::string_view name) noexcept;

/// Packs the records of a chunk: zstd level 1 or one LZ4 frame.  Keeps its working memory, so that
/// a steady stream of chunks does not allocate.  Thread-compatible.
class Compressor {
 public:
  explicit Compressor(Compression compression);
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  /// Appends the packed form of `plain` to `out`.
  Status append(std::span<const std::byte> plain, std::vector<std::byte>& out);

 private:
  struct Contexts;
  Compression compression_;
  std::unique_ptr<Contexts> contexts_;
};

/// Unpacks `packed` into `plain`, which must come out at exactly `plain_bytes`.  Memory grows with
/// what is really there, so that a false `plain_bytes` costs no allocation of that size.
/// @returns kDamaged, saying why, when it does not fit.
Status unpack(Compression compression, std::span<const std::byte> packed, std::uint64_t plain_bytes,
              std::vector<std::byte>& plain);

}  // namespace stillhand::recording
