// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/tdms_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/wire.hpp"

namespace stillhand::measurement::tdms {
namespace {

enum Contents : std::uint32_t {
  kMetaData = 1u << 1,
  kNewObjects = 1u << 2,
  kRawData = 1u << 3,
  kInterleaved = 1u << 5,
  kBigEndian = 1u << 6,
  kDaqmx = 1u << 7,
};
enum Type : std::uint32_t { kText = 0x20, kStamp = 0x44 };
constexpr std::uint32_t kNoRawData = 0xFFFFFFFF;
constexpr std::uint32_t kDaqmxIndex = 0x1269;         // "format changing scaler"
constexpr std::uint32_t kDaqmxDigitalIndex = 0x1369;  // "digital line scaler"
constexpr std::size_t kMostObjects = 1024;

// Numbers of either byte order; like WireReader, never outside its span.
class Source {
 public:
  Source(std::span<const std::byte> bytes, bool big_endian) : in_(bytes), big_(big_endian) {}

  std::uint64_t take(std::size_t bytes) {
    const auto raw = in_.take_bytes(bytes);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      value = value << 8 | std::to_integer<std::uint64_t>(raw[big_ ? i : raw.size() - 1 - i]);
    }
    return value;
  }
  std::uint32_t take_32() { return static_cast<std::uint32_t>(take(4)); }
  std::string take_text() {
    const auto raw = in_.take_bytes(take_32());
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }
  void skip(std::uint64_t bytes) { in_.take_bytes(bytes); }
  [[nodiscard]] bool is_big_endian() const { return big_; }
  [[nodiscard]] bool ok() const { return in_.ok(); }
  [[nodiscard]] std::size_t left() const { return in_.left(); }

 private:
  recording::WireReader in_;
  bool big_;
};

// Numbers with a unit are the same numbers, and a Boolean is a byte.
std::uint32_t without_unit(std::uint32_t type) {
  if (type == 0x19 || type == 0x1A) return type - 0x10;
  return type == 0x21 ? 5 : type;
}

// Bytes of a number; 0: of this type nothing is read.
std::size_t size_of(std::uint32_t type) {
  constexpr std::array<std::size_t, 11> kSizes{0, 1, 2, 4, 8, 1, 2, 4, 8, 4, 8};
  if (type == kStamp) return 16;
  return type < kSizes.size() ? kSizes[type] : 0;
}

// The names of a path: "/'group'/'it''s a channel'".
std::vector<std::string> names_of(const std::string& path) {
  std::vector<std::string> out;
  bool inside = false;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (path[i] != '\'') {
      if (inside) out.back() += path[i];
    } else if (!inside) {
      inside = true;
      out.emplace_back();
    } else if (i + 1 < path.size() && path[i + 1] == '\'') {
      out.back() += path[i++];
    } else {
      inside = false;
    }
  }
  return out;
}

class Parser {
 public:
  Parser(std::span<const std::byte> bytes, const std::string& path, std::size_t most_values)
      : rest_(bytes), all_bytes_(bytes.size()), path_(path), values_left_(most_values) {}

  File parse() {
    while (take_segment()) {
    }
    for (Object& object : file_.objects) {
      // Properties may follow the samples.
      if (object.blocks.size() == 1) object.blocks = {object.block_from(0)};
    }
    return std::move(file_);
  }

 private:
  [[nodiscard]] std::size_t at() const { return all_bytes_ - rest_.size(); }
  [[noreturn]] void contradicts() const {
    throw ConfigError(
        fmt::format("{}, byte {}", path_, at()),
        "a segment that contradicts itself, or too many values",
        fmt::format("TDMS, at most {} values left and {} objects", values_left_, kMostObjects));
  }

  // False at the end, or where the file is cut off.
  bool take_segment() {
    constexpr std::size_t kLeadIn_bytes = 28;
    if (rest_.empty()) return false;
    file_.cut = rest_.size() < kLeadIn_bytes;
    if (file_.cut) return false;
    if (std::memcmp(rest_.data(), "TDSm", 4) != 0) contradicts();
    const std::uint32_t contents = Source(rest_.subspan(4), false).take_32();
    const bool big_endian = (contents & kBigEndian) != 0;
    Source lead(rest_.subspan(12, 16), big_endian);  // behind the contents and the version
    const std::uint64_t next = lead.take(8);         // all ones: the writer did not end it
    const std::uint64_t raw_at = lead.take(8);
    if ((contents & kDaqmx) != 0) refuse_daqmx();
    auto body = rest_.subspan(kLeadIn_bytes);
    file_.cut = next > body.size();
    if (!file_.cut) body = body.first(next);
    if (raw_at > body.size() && !file_.cut) contradicts();
    if (raw_at > body.size()) return false;
    if ((contents & kMetaData) != 0) {
      take_objects(Source(body.first(raw_at), big_endian), (contents & kNewObjects) != 0);
    }
    if ((contents & kRawData) != 0) {
      take_raw(Source(body.subspan(raw_at), big_endian), (contents & kInterleaved) != 0);
    }
    rest_ = rest_.subspan(kLeadIn_bytes + body.size());
    return true;
  }

  void take_objects(Source in, bool new_list) {
    if (new_list) listed_.clear();
    const auto count = in.take_32();
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::string path = in.take_text();
      if (!in.ok()) contradicts();
      const auto [known, is_new] = numbers_.try_emplace(path, file_.objects.size());
      if (is_new) file_.objects.emplace_back().path = path;
      if (file_.objects.size() > kMostObjects) contradicts();
      take_index(in, known->second);
      const auto properties = in.take_32();
      for (std::uint32_t p = 0; p < properties && in.ok(); ++p) {
        take_property(in, file_.objects[known->second]);
      }
      if (!in.ok()) contradicts();
    }
  }

  void take_index(Source& in, std::size_t number) {
    Object& object = file_.objects[number];
    const auto length = in.take_32();
    if (length == kDaqmxIndex || length == kDaqmxDigitalIndex) refuse_daqmx();
    std::erase_if(listed_,
                  [&](std::size_t each) { return each == number && length == kNoRawData; });
    if (length == kNoRawData) return;
    if (std::ranges::find(listed_, number) == listed_.end()) listed_.push_back(number);
    if (length == 0) {  // as before
      if (object.type == 0) contradicts();
      return;
    }
    const std::uint32_t type = without_unit(in.take_32());
    const auto dimension = in.take_32();
    object.count = in.take(8);
    if (type == kText) object.text_bytes = in.take(8);
    if (dimension != 1 || (object.type != 0 && object.type != type)) contradicts();
    object.type = type;
    if (type != kText) check_type(type, title_of(object));
  }

  void check_type(std::uint32_t type, const std::string& name) const {
    if (size_of(type) > 0) return;
    refuse(path_, fmt::format("type 0x{:x} of '{}'", type, name),
           "whole numbers, or single or double precision");
  }

  void take_property(Source& in, Object& object) {
    const std::string name = in.take_text();
    const std::uint32_t type = without_unit(in.take_32());
    Property value;
    if (type == kText) {
      value.text = in.take_text();
    } else if (type != 0) {
      check_type(type, name);
      value.number = take_number(in, type);
    }
    if (name.starts_with("wf_") || name.starts_with("NI_") || name == "unit_string") {
      object.properties[name] = std::move(value);
    }
  }

  double take_number(Source& in, std::uint32_t type) {
    if (type == kStamp) return take_stamp(in);
    const std::size_t bytes = size_of(type);
    const std::uint64_t raw = in.take(bytes);
    if (type == 9) return std::bit_cast<float>(static_cast<std::uint32_t>(raw));
    if (type == 10) return std::bit_cast<double>(raw);
    if (type > 4) return static_cast<double>(raw);
    const std::size_t unused = 64 - 8 * bytes;
    return static_cast<double>(static_cast<std::int64_t>(raw << unused) >> unused);
  }

  // Seconds after the first stamp's, which keeps their digits; in the file they count from 1904.
  double take_stamp(Source& in) {
    const auto first = in.take(8);
    const auto second = in.take(8);
    const auto whole = in.is_big_endian() ? first : second;
    const auto part = in.is_big_endian() ? second : first;
    if (!first_s_) first_s_ = whole;
    return static_cast<double>(static_cast<std::int64_t>(whole - *first_s_)) +
           std::ldexp(static_cast<double>(part), -64);
  }

  void take_raw(Source in, bool interleaved) {
    std::vector<Object*> objects;
    for (const std::size_t number : listed_) {
      Object& object = file_.objects[number];
      if (object.count == 0 || (object.type == kText && object.text_bytes == 0)) continue;
      objects.push_back(&object);
      const Block block = object.block_from(object.values.size());
      const bool goes_on = !object.blocks.empty() &&
                           object.blocks.back().start_s == block.start_s &&
                           object.blocks.back().step_s == block.step_s;
      if (!goes_on) object.blocks.push_back(block);
    }
    while (in.left() > 0) {
      if (objects.empty()) contradicts();
      interleaved ? take_rows(in, objects) : take_columns(in, objects);
      if (in.ok()) continue;
      if (!file_.cut) contradicts();
      return;
    }
  }

  void take_columns(Source& in, const std::vector<Object*>& objects) {
    for (Object* object : objects) {
      if (object->type == kText) in.skip(object->text_bytes);
      for (std::uint64_t i = 0; object->type != kText && i < object->count; ++i) {
        if (!take_value(in, *object)) return;
      }
    }
  }

  void take_rows(Source& in, const std::vector<Object*>& objects) {
    for (const Object* object : objects) {
      if (object->type == kText || object->count != objects.front()->count) contradicts();
    }
    for (std::uint64_t i = 0; i < objects.front()->count; ++i) {
      for (Object* object : objects) {
        if (!take_value(in, *object)) return;
      }
    }
  }

  bool take_value(Source& in, Object& object) {
    const double value = take_number(in, object.type);
    if (!in.ok()) return false;
    if (values_left_-- == 0) contradicts();
    object.values.push_back(value);
    return true;
  }

  [[noreturn]] void refuse_daqmx() const {
    refuse(path_, "DAQmx raw data, whose layout its maker does not document",
           "a file whose logging wrote scaled values");
  }

  std::span<const std::byte> rest_;
  std::size_t all_bytes_;
  const std::string& path_;
  std::size_t values_left_;
  File file_;
  std::map<std::string, std::size_t> numbers_;  // of the objects, by path
  std::vector<std::size_t> listed_;             // objects with raw data, in its order
  std::optional<std::uint64_t> first_s_;
};

}  // namespace

std::string title_of(const Object& object) {
  const std::vector<std::string> names = names_of(object.path);
  return names.size() == 2 ? names[0] + "." + names[1] : object.path;
}

void refuse(const std::string& path, const std::string& what, const std::string& want) {
  throw ConfigError(
      path, what,
      fmt::format("{}; or a CSV: python3 -c \"import nptdms; nptdms.TdmsFile.read('{}')"
                  ".as_dataframe(time_index=True).to_csv('out.csv')\"",
                  want, path));
}

File parse(std::span<const std::byte> bytes, const std::string& path, std::size_t most_values) {
  return Parser(bytes, path, most_values).parse();
}

}  // namespace stillhand::measurement::tdms
