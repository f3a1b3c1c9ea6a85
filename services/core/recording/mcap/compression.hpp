// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "services/core/recording/mcap/mcap_format.hpp"
#include "services/core/recording/mcap/status.hpp"

namespace stillhand::recording {

/// The name in a Chunk record: "", "lz4" or "zstd".
std::string_view compression_name(Compression compression) noexcept;
/// The reverse; nullopt for an unknown name.
std::optional<Compression> compression_of(std::string_view name) noexcept;

/// Compresses the records of a chunk: zstd level 1 or one LZ4 frame.  Keeps its working memory, so
/// a steady stream of chunks does not allocate.  Thread-compatible.
class Compressor {
 public:
  explicit Compressor(Compression compression);
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  /// Appends the compressed form of `plain` to `out`.
  Status append(std::span<const std::byte> plain, std::vector<std::byte>& out);

 private:
  struct Contexts;
  Compression compression_;
  std::unique_ptr<Contexts> contexts_;
};

/// Decompresses `packed` into `plain`; the result must have exactly `plain_bytes`.  Memory grows
/// with the real data, so a false `plain_bytes` causes no allocation of that size.
/// @returns kDamaged with the reason if the data do not fit.
Status unpack(Compression compression, std::span<const std::byte> packed, std::uint64_t plain_bytes,
              std::vector<std::byte>& plain);

}  // namespace stillhand::recording
