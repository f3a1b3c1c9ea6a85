// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/xdf_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "apps/libraries/measurement/tables/at_times.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/wire.hpp"
#include "services/core/statistics/descriptive.hpp"

namespace stillhand::measurement {
namespace {

using recording::WireReader;

enum Tag : std::uint16_t { kStreamHeader = 2, kSamples = 3, kClockOffset = 4 };
constexpr std::array<std::string_view, 6> kNumbers{"double64", "float32", "int8",
                                                   "int16",    "int32",   "int64"};
constexpr double kMostChannels = 1024;
constexpr std::size_t kMostStreams = 256;
constexpr std::size_t kMostHeader_bytes = 1 << 20;
constexpr std::size_t kMostOffsets = 400;  // of more, so many, evenly spread
// Of the line from a tenth of the clock offsets at least: 2.9 degrees at 4 Hz between two streams.
constexpr double kWorstOffset_s = 0.002;
constexpr double kLatest_s = 1e10;
constexpr double kJump_s = 1.0;        // pyxdf's, between two segments
constexpr double kLeastStep_s = 1e-3;  // LabRecorder asks every 5 s

struct Stream {
  std::uint32_t id = 0;
  std::string name, format;
  double rate_hz = 0.0;  // nominal; 0: irregular
  std::vector<std::string> labels, units;
  std::vector<double> time_s;                 // clock of its sender
  std::vector<std::vector<double>> values;    // of each channel; none of a stream of texts
  std::vector<double> offset_at_s, offset_s;  // what makes that the recorder's clock
};

struct File {
  std::vector<Stream> streams;
  std::size_t read_bytes = 0;  // up to the end of the last whole chunk
};

// Text between the first <tag> and its end; these elements have no attributes.
std::string text_of(std::string_view xml, const std::string& tag) {
  const std::size_t begin = xml.find("<" + tag + ">");
  const std::size_t end = xml.find("</" + tag + ">", begin);
  if (begin == std::string_view::npos || end == std::string_view::npos) return {};
  return std::string(xml.substr(begin + tag.size() + 2, end - begin - tag.size() - 2));
}

double number_of(const std::string& text) {
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return std::isfinite(value) ? std::max(value, 0.0) : 0.0;
}

std::uint64_t take_length(WireReader& in) {
  const auto bytes = in.take<std::uint8_t>();
  if (bytes == 1) return in.take<std::uint8_t>();
  if (bytes == 4) return in.take<std::uint32_t>();
  if (bytes != 8) in.take_bytes(UINT64_MAX);  // no such length: not ok
  return in.take<std::uint64_t>();
}

double take_double(WireReader& in) { return std::bit_cast<double>(in.take<std::uint64_t>()); }

double take_value(WireReader& in, std::string_view format) {
  if (format == "double64") return take_double(in);
  if (format == "float32") return std::bit_cast<float>(in.take<std::uint32_t>());
  if (format == "int32") return static_cast<std::int32_t>(in.take<std::uint32_t>());
  if (format == "int16") return static_cast<std::int16_t>(in.take<std::uint16_t>());
  if (format == "int8") return static_cast<std::int8_t>(in.take<std::uint8_t>());
  return static_cast<double>(static_cast<std::int64_t>(in.take<std::uint64_t>()));
}

Stream header_of(std::uint32_t id, std::string_view xml) {
  Stream stream;
  stream.id = id;
  stream.name = text_of(xml, "name");
  stream.format = text_of(xml, "channel_format");
  stream.rate_hz = number_of(text_of(xml, "nominal_srate"));
  const double channels = std::min(number_of(text_of(xml, "channel_count")), kMostChannels);
  const std::string channels_xml = text_of(xml, "channels");
  std::string_view list = channels_xml;
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels); ++i) {
    const std::string channel = text_of(list, "channel");
    const std::string label = text_of(channel, "label");
    stream.labels.push_back(label.empty() ? std::to_string(i + 1) : label);
    stream.units.push_back(text_of(channel, "unit"));
    list.remove_prefix(std::min(list.size(), list.find("</channel>")));
    list.remove_prefix(std::min<std::size_t>(list.size(), 1));
  }
  if (std::ranges::count(kNumbers, stream.format) > 0) stream.values.resize(stream.labels.size());
  return stream;
}

// False if the content contradicts itself.
bool take_samples(WireReader& in, Stream& stream, std::size_t& values_left) {
  const double step_s = stream.rate_hz > 0.0 ? 1.0 / stream.rate_hz : 0.0;
  const std::uint64_t samples = take_length(in);
  for (std::uint64_t i = 0; i < samples && in.ok(); ++i) {
    const auto stamp_bytes = in.take<std::uint8_t>();
    const bool first = stream.time_s.empty();
    if ((stamp_bytes != 8 && (stamp_bytes != 0 || first)) || values_left < stream.values.size()) {
      return false;
    }
    values_left -= stream.values.size();
    stream.time_s.push_back(stamp_bytes == 8 ? take_double(in) : stream.time_s.back() + step_s);
    for (auto& column : stream.values) column.push_back(take_value(in, stream.format));
  }
  return in.ok();
}

// What the end of the file cuts off is not read; chunks of other kinds are passed over.
File parse(std::span<const std::byte> bytes, const std::string& path, std::size_t most_values) {
  File file;
  WireReader rest(bytes);
  rest.take_bytes(4);  // "XDF:"
  for (file.read_bytes = 4; rest.left() > 0; file.read_bytes = bytes.size() - rest.left()) {
    const std::uint64_t length = take_length(rest);
    WireReader in(rest.take_bytes(length));
    if (!rest.ok()) break;
    const auto tag = in.take<std::uint16_t>();
    if (tag < kStreamHeader || tag > kClockOffset) continue;
    const auto id = in.take<std::uint32_t>();
    auto stream = std::ranges::find(file.streams, id, &Stream::id);
    bool good = (stream == file.streams.end()) == (tag == kStreamHeader);
    if (tag == kStreamHeader) {
      good = good && in.left() <= kMostHeader_bytes && file.streams.size() < kMostStreams;
    }
    if (good && tag == kStreamHeader) {
      const auto xml = in.take_bytes(in.left());
      file.streams.push_back(
          header_of(id, {reinterpret_cast<const char*>(xml.data()), xml.size()}));
      good = !file.streams.back().labels.empty();
    } else if (good && tag == kClockOffset) {
      stream->offset_at_s.push_back(take_double(in));
      stream->offset_s.push_back(take_double(in));
      good = std::abs(stream->offset_at_s.back()) < kLatest_s &&
             std::abs(stream->offset_s.back()) < kLatest_s;
    } else if (good && !stream->values.empty()) {
      good = take_samples(in, *stream, most_values);
    }
    if (!good || !in.ok()) {
      throw ConfigError(
          fmt::format("{}, byte {}", path, file.read_bytes),
          "a chunk that contradicts itself or its stream, or too many values",
          fmt::format("XDF 1.0, at most {} values and {} streams", most_values, kMostStreams));
    }
  }
  return file;
}

// Eq. ME-18.  @throws ConfigError if the offsets leave their line
std::vector<double> on_recorders_clock(const Stream& stream, const std::string& path) {
  std::vector<double> at_s, by_s, slopes, left_s;
  const std::size_t every = stream.offset_s.size() / kMostOffsets + 1;
  for (std::size_t i = 0; i < stream.offset_s.size(); i += every) {
    at_s.push_back(stream.offset_at_s[i]);
    by_s.push_back(stream.offset_s[i]);
    for (std::size_t j = 0; j + 1 < at_s.size(); ++j) {
      if (at_s.back() - at_s[j] > kLeastStep_s) {
        slopes.push_back((by_s.back() - by_s[j]) / (at_s.back() - at_s[j]));
      }
    }
  }
  if (at_s.empty()) return stream.time_s;
  const double slope = slopes.empty() ? 0.0 : statistics::median(slopes);
  for (std::size_t i = 0; i < at_s.size(); ++i) left_s.push_back(by_s[i] - slope * at_s[i]);
  const double offset_s = statistics::median(left_s);
  const auto off = std::ranges::count_if(
      left_s, [&](double each_s) { return !(std::abs(each_s - offset_s) < kWorstOffset_s); });
  if (10 * off > static_cast<std::ptrdiff_t>(left_s.size())) {
    throw ConfigError(path,
                      fmt::format("{} of {} clock offsets of '{}' that leave their line by 2 ms",
                                  off, left_s.size(), stream.name),
                      "a sender whose clock ran on, or a part of the file");
  }
  std::vector<double> time_s = stream.time_s;
  for (double& each : time_s) each += offset_s + slope * each;
  return time_s;
}

bool go_on(const std::vector<double>& time_s) {
  const auto stops = [](double a_s, double b_s) { return !(b_s > a_s && b_s < kLatest_s); };
  return std::ranges::adjacent_find(time_s, stops) == time_s.end();
}

// Eq. ME-20.  @param first, end  rows of a segment  @returns false if its stamps have no such line
bool make_even(std::vector<double>& time_s, std::size_t first, std::size_t end, double rate_hz) {
  constexpr std::size_t kParts = 8;
  constexpr std::size_t kLeastRows = 25;  // of a part
  constexpr double kRateWithin = 0.005;   // of the nominal one: rows are missing, or it is not that
  const std::size_t rows = end - first;
  if (rows < kParts * kLeastRows) return false;
  const double middle = 0.5 * static_cast<double>(rows - 1);
  double mean_s = 0.0, products = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    mean_s += (time_s[first + i] - time_s[first]) / static_cast<double>(rows);
    products += (static_cast<double>(i) - middle) * (time_s[first + i] - time_s[first]);
    squares += std::pow(static_cast<double>(i) - middle, 2.0);
  }
  const double step_s = products / squares;
  if (!(std::abs(step_s * rate_hz - 1.0) < kRateWithin)) return false;
  const double start_s = time_s[first] + mean_s - middle * step_s;
  std::array<double, kParts> off_s{};
  for (std::size_t i = 0; i < rows; ++i) {
    const double even_s = start_s + static_cast<double>(i) * step_s;
    off_s[i * kParts / rows] += (time_s[first + i] - even_s) * kParts / static_cast<double>(rows);
    time_s[first + i] = even_s;
  }
  return std::ranges::all_of(off_s, [](double each) { return std::abs(each) < kWorstOffset_s; });
}

// Each segment without a jump, of a stream with a rate.
bool make_even(std::vector<double>& time_s, double rate_hz) {
  for (std::size_t first = 0, i = 1; i <= time_s.size(); ++i) {
    if (i < time_s.size() && std::abs(time_s[i] - time_s[i - 1]) < kJump_s) continue;
    if (rate_hz == 0.0 || !make_even(time_s, first, i, rate_hz)) return false;
    first = i;
  }
  return true;
}

class XdfTable : public TableFile {
 public:
  using Column = std::pair<std::size_t, std::size_t>;  // stream, channel
  XdfTable(TableHead head, File file, std::vector<Column> columns)
      : TableFile(std::move(head)), file_(std::move(file)), columns_(std::move(columns)) {}

  // The rows of the first column's stream; the others are taken at its times.
  RawColumns read(const std::vector<std::size_t>& columns) override {
    RawColumns out;
    const std::size_t first = columns_.at(columns.at(0)).first;
    std::map<std::size_t, std::vector<double>> times;
    for (const std::size_t each : columns) times[columns_.at(each).first];
    for (auto& [number, time_s] : times) {
      const Stream& stream = file_.streams[number];
      time_s = on_recorders_clock(stream, head().path);
      if (!go_on(time_s)) {
        if (!make_even(time_s, stream.rate_hz) || !go_on(time_s)) {
          throw ConfigError(head().path, "time stamps of '" + stream.name + "' that do not go on",
                            "stamps that increase, or that their number puts within 2 ms on the "
                            "mean of each eighth; pyxdf.load_xdf() evens others, too: save its "
                            "arrays as CSV");
        }
        out.notes.push_back(
            "Stamps of " + stream.name +
            " overlap, as of chunks that came "
            "unevenly: its rows are spread evenly over each stretch without a jump.");
      }
      if (times.size() > 1 && stream.offset_s.empty()) {
        throw ConfigError(head().path, "no clock offsets of '" + stream.name + "'",
                          "channels of one stream, or a file with the offsets of each");
      }
      if (number == first) continue;
      out.notes.push_back("Values of " + stream.name + " are taken at the times of " +
                          file_.streams[first].name + ", by a cubic between its rows.");
    }
    const double zero_s = times.at(first).front();
    for (auto& [number, time_s] : times) {
      for (double& each : time_s) each -= zero_s;
    }
    out.time_s = times.at(first);
    for (const std::size_t each : columns) {
      const auto [number, channel] = columns_[each];
      const std::vector<double>& values = file_.streams[number].values[channel];
      const std::vector<double>& time_s = times.at(number);
      out.values.push_back(number == first
                               ? values
                               : at_times(time_s, values, out.time_s, longest_bridge_s(time_s)));
    }
    return out;
  }

 private:
  File file_;
  std::vector<Column> columns_;
};

}  // namespace

std::unique_ptr<TableFile> xdf_table(const std::string& bytes, const std::string& path,
                                     std::size_t most_values) {
  File file = parse(std::as_bytes(std::span(bytes)), path, most_values);
  TableHead head{.path = path, .form = "XDF", .columns = {}, .has_times = true, .notes = {}};
  std::vector<XdfTable::Column> columns;
  std::map<std::string, int> streams_of_name;
  for (const Stream& stream : file.streams) ++streams_of_name[stream.name];
  for (std::size_t s = 0; s < file.streams.size(); ++s) {
    Stream& stream = file.streams[s];
    if (streams_of_name[stream.name] > 1) stream.name += fmt::format(" {}", stream.id);
    for (std::size_t c = 0; c < stream.values.size() && !stream.time_s.empty(); ++c) {
      const std::string title = stream.name + "." + stream.labels[c];
      head.columns.push_back({title, title, stream.units[c], stream.time_s.size()});
      columns.emplace_back(s, c);
    }
  }
  if (columns.empty()) throw ConfigError(path, "no samples of numbers", "an XDF file with some");
  if (file.read_bytes < bytes.size()) {
    head.notes.push_back(fmt::format("The file is cut off: {} of {} bytes are read.",
                                     file.read_bytes, bytes.size()));
  }
  return std::make_unique<XdfTable>(std::move(head), std::move(file), std::move(columns));
}

}  // namespace stillhand::measurement
