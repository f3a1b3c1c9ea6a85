// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/tdms_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/libraries/measurement/tables/at_times.hpp"
#include "apps/libraries/measurement/tables/tdms_file.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

using tdms::Block;
using tdms::Object;
using tdms::title_of;

constexpr double kRawInput = 0xFFFFFFFF;  // of a scale
constexpr double kLatest_s = 1e12;

struct Line {
  double slope = 1.0;
  double intercept = 0.0;
};

// What the last scale makes of a raw value: a chain of lines down to the raw values.
Line scale_of(const Object& object, const std::string& path) {
  Line out;
  const auto refused = [&](const std::string& what) {
    tdms::refuse(path, fmt::format("{} of '{}'", what, title_of(object)), "linear scales");
  };
  const double scales = object.number("NI_Number_Of_Scales");
  const std::string status = object.text("NI_Scaling_Status");
  if (!(scales >= 1.0)) return out;
  if (!status.empty() && status != "unscaled") refused("values '" + status + "' with scales");
  for (double each = scales - 1.0; each != kRawInput;) {
    const std::string scale = fmt::format("NI_Scale[{:.0f}]_", each);
    const std::string type = object.text(scale + "Scale_Type");
    if (type != "Linear") refused("a scale '" + type + "'");
    const double slope = object.number(scale + "Linear_Slope");
    out = {out.slope * slope,
           out.slope * object.number(scale + "Linear_Y_Intercept") + out.intercept};
    const auto source = object.properties.find(scale + "Linear_Input_Source");
    const double input = source == object.properties.end() ? kRawInput : source->second.number;
    if (input != kRawInput && !(input < each && input >= 0.0)) refused("scales in a circle");
    each = input;
  }
  return out;
}

std::vector<double> times_of(const Object& object) {
  std::vector<double> out(object.values.size());
  auto block = object.blocks.begin();
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (block + 1 != object.blocks.end() && (block + 1)->first == i) ++block;
    out[i] = block->start_s + static_cast<double>(i - block->first) * block->step_s;
  }
  return out;
}

bool has_times(const Object& object) {
  return std::ranges::all_of(object.blocks, [](const Block& each) { return each.step_s > 0.0; });
}

class TdmsTable : public TableFile {
 public:
  TdmsTable(TableHead head, std::vector<Object> channels, bool cut)
      : TableFile(std::move(head)), channels_(std::move(channels)), cut_(cut) {}

  // The rows of the first column; those with other times are taken at its times.
  RawColumns read(const std::vector<std::size_t>& columns) override {
    RawColumns out;
    const Object& first = channels_.at(columns.at(0));
    const bool timed = std::ranges::all_of(
        columns, [&](std::size_t each) { return has_times(channels_.at(each)); });
    if (timed) out.time_s = checked_times(first);
    for (const std::size_t each : columns) {
      const Object& channel = channels_[each];
      std::vector<double> values = channel.values;
      const Line line = scale_of(channel, head().path);
      for (double& value : values) value = line.slope * value + line.intercept;
      const bool other_times =
          channel.blocks != first.blocks || values.size() != first.values.size();
      if (timed && other_times) {
        const std::vector<double> time_s = checked_times(channel);
        values = at_times(time_s, values, out.time_s, longest_bridge_s(time_s));
        out.notes.push_back("Values of " + title_of(channel) + " are taken at the times of " +
                            title_of(first) + ", by a cubic between its rows.");
      }
      out.values.push_back(std::move(values));
    }
    make_even(out.values);
    const double zero_s = out.time_s.empty() ? 0.0 : out.time_s.front();
    for (double& each : out.time_s) each -= zero_s;
    return out;
  }

 private:
  [[nodiscard]] std::vector<double> checked_times(const Object& channel) const {
    std::vector<double> out = times_of(channel);
    const auto stops = [](double a_s, double b_s) { return !(b_s > a_s && b_s < kLatest_s); };
    if (std::ranges::adjacent_find(out, stops) != out.end()) {
      throw ConfigError(head().path, "times of '" + title_of(channel) + "' that do not go on",
                        "a wf_start_time that increases from one recording to the next");
    }
    return out;
  }
  // Without times of their own, rows are one another's by their number.
  void make_even(std::vector<std::vector<double>>& values) const {
    std::size_t rows = values.front().size();
    for (const std::vector<double>& column : values) {
      if (column.size() != rows && !cut_) {
        throw ConfigError(head().path,
                          fmt::format("columns of {} and {} rows", rows, column.size()),
                          "channels of one length, or with wf_increment");
      }
      rows = std::min(rows, column.size());
    }
    for (std::vector<double>& column : values) column.resize(rows);
  }

  std::vector<Object> channels_;
  bool cut_;
};

// A channel without scales has those of its group, or of the file.
void inherit(std::vector<Object>& objects) {
  constexpr const char* kScales = "NI_Number_Of_Scales";
  const auto with_scales = [&](const std::string& path) {
    return std::ranges::find_if(objects, [&](const Object& each) {
      return each.path == path && each.properties.contains(kScales);
    });
  };
  for (Object& object : objects) {
    if (object.values.empty() || object.properties.contains(kScales)) continue;
    auto from = with_scales(object.path.substr(0, object.path.rfind("/'")));
    if (from == objects.end()) from = with_scales("/");
    if (from == objects.end()) continue;
    object.properties.insert(from->properties.begin(), from->properties.end());
  }
}

}  // namespace

std::unique_ptr<TableFile> tdms_table(const std::string& bytes, const std::string& path,
                                      std::size_t most_values) {
  tdms::File file = tdms::parse(std::as_bytes(std::span(bytes)), path, most_values);
  inherit(file.objects);
  std::erase_if(file.objects, [](const Object& each) { return each.values.empty(); });
  if (file.objects.empty())
    throw ConfigError(path, "no samples of numbers", "a TDMS file with some");
  TableHead head{.path = path, .form = "TDMS", .columns = {}, .notes = {}};
  head.has_times = std::ranges::all_of(file.objects, has_times);
  for (const Object& each : file.objects) {
    const std::string unit = each.text("unit_string");
    const std::string title = title_of(each);
    head.columns.push_back(
        {title, title, unit.empty() ? each.text("NI_UnitDescription") : unit, each.values.size()});
  }
  if (file.cut) {
    head.notes.push_back("The file is cut off: its last segment is read as far as it goes.");
  }
  return std::make_unique<TdmsTable>(std::move(head), std::move(file.objects), file.cut);
}

}  // namespace stillhand::measurement
