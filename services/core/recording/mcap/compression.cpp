// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/compression.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <string>

namespace stillhand::recording {
namespace {

// With level 1, a 1 kHz recorder needs far less than one core; RESULTS.md has the measurements.
constexpr int kZstdLevel = 1;

Status damaged(const std::string& what) { return Status::failure(StatusKind::kDamaged, what); }

// One step of a streaming decoder: advances `in` and returns the number of bytes in `room`.
struct Step {
  std::size_t consumed = 0;
  std::size_t produced = 0;
  bool frame_ended = false;
  const char* error = nullptr;
};

class ZstdStream {
 public:
  Step step(std::span<const std::byte> in, std::span<std::byte> room) {
    if (!context_) return {0, 0, false, "no memory for a decoder"};
    ZSTD_inBuffer source{in.data(), in.size(), 0};
    ZSTD_outBuffer target{room.data(), room.size(), 0};
    const std::size_t result = ZSTD_decompressStream(context_.get(), &target, &source);
    if (ZSTD_isError(result) != 0U) return {0, 0, false, ZSTD_getErrorName(result)};
    return {source.pos, target.pos, result == 0, nullptr};
  }

 private:
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context_{ZSTD_createDCtx(), &ZSTD_freeDCtx};
};

class Lz4Stream {
 public:
  Lz4Stream() {
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) == 0U) {
      context_.reset(context);
    }
  }
  Step step(std::span<const std::byte> in, std::span<std::byte> room) {
    if (!context_) return {0, 0, false, "no memory for a decoder"};
    std::size_t consumed = in.size();
    std::size_t produced = room.size();
    const std::size_t result =
        LZ4F_decompress(context_.get(), room.data(), &produced, in.data(), &consumed, nullptr);
    if (LZ4F_isError(result) != 0U) return {0, 0, false, LZ4F_getErrorName(result)};
    return {consumed, produced, result == 0, nullptr};
  }

 private:
  std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context_{
      nullptr, &LZ4F_freeDecompressionContext};
};

template <typename Stream>
Status unpack_stream(std::span<const std::byte> packed, std::uint64_t plain_bytes,
                     std::vector<std::byte>& plain) {
  // The first estimate is 16:1, then four times more each time: at most four times the real size.
  const std::uint64_t first_guess = 16 * static_cast<std::uint64_t>(packed.size()) + 4096;
  plain.resize(static_cast<std::size_t>(std::min(plain_bytes, first_guess)));
  Stream stream;
  std::size_t filled = 0;
  bool frame_ended = false;
  while (true) {
    const Step step = stream.step(packed, std::span(plain).subspan(filled));
    if (step.error != nullptr) return damaged(std::string("cannot be unpacked: ") + step.error);
    packed = packed.subspan(step.consumed);
    filled += step.produced;
    frame_ended = step.frame_ended;
    if (frame_ended && packed.empty()) break;
    if (filled == plain.size() && plain.size() < plain_bytes) {
      const std::uint64_t more = 4 * static_cast<std::uint64_t>(plain.size());
      plain.resize(static_cast<std::size_t>(std::min(plain_bytes, more)));
    } else if (step.consumed == 0 && step.produced == 0) {
      break;
    }
  }
  if (!frame_ended || !packed.empty() || filled != plain_bytes) {
    return damaged("unpacks to " + std::to_string(filled) + " bytes or more, not to " +
                   std::to_string(plain_bytes));
  }
  return {};
}

}  // namespace

std::string_view compression_name(Compression compression) noexcept {
  switch (compression) {
    case Compression::kLz4:
      return "lz4";
    case Compression::kZstd:
      return "zstd";
    case Compression::kNone:
      break;
  }
  return "";
}

std::optional<Compression> compression_of(std::string_view name) noexcept {
  if (name.empty()) return Compression::kNone;
  if (name == "lz4") return Compression::kLz4;
  if (name == "zstd") return Compression::kZstd;
  return std::nullopt;
}

struct Compressor::Contexts {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> zstd{nullptr, &ZSTD_freeCCtx};
};

Compressor::Compressor(Compression compression)
    : compression_(compression), contexts_(std::make_unique<Contexts>()) {
  if (compression_ == Compression::kZstd) contexts_->zstd.reset(ZSTD_createCCtx());
}

Compressor::~Compressor() = default;

Status Compressor::append(std::span<const std::byte> plain, std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  if (compression_ == Compression::kNone) {
    out.insert(out.end(), plain.begin(), plain.end());
    return {};
  }
  const bool zstd = compression_ == Compression::kZstd;
  const std::size_t room =
      zstd ? ZSTD_compressBound(plain.size()) : LZ4F_compressFrameBound(plain.size(), nullptr);
  out.resize(start + room);
  std::size_t packed = 0;
  const char* error = nullptr;
  if (zstd) {
    packed = ZSTD_compressCCtx(contexts_->zstd.get(), out.data() + start, room, plain.data(),
                               plain.size(), kZstdLevel);
    if (ZSTD_isError(packed) != 0U) error = ZSTD_getErrorName(packed);
  } else {
    packed = LZ4F_compressFrame(out.data() + start, room, plain.data(), plain.size(), nullptr);
    if (LZ4F_isError(packed) != 0U) error = LZ4F_getErrorName(packed);
  }
  if (error != nullptr) {
    out.resize(start);
    return Status::failure(StatusKind::kIo, std::string("chunk cannot be packed: ") + error);
  }
  out.resize(start + packed);
  return {};
}

Status unpack(Compression compression, std::span<const std::byte> packed, std::uint64_t plain_bytes,
              std::vector<std::byte>& plain) {
  switch (compression) {
    case Compression::kLz4:
      return unpack_stream<Lz4Stream>(packed, plain_bytes, plain);
    case Compression::kZstd:
      return unpack_stream<ZstdStream>(packed, plain_bytes, plain);
    case Compression::kNone:
      break;
  }
  if (packed.size() != plain_bytes) {
    return damaged("holds " + std::to_string(packed.size()) + " bytes, not " +
                   std::to_string(plain_bytes));
  }
  plain.assign(packed.begin(), packed.end());
  return {};
}

}  // namespace stillhand::recording
