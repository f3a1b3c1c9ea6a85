// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/switch_trace.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <vector>

namespace stillhand::runtime {
namespace {

constexpr pid_t kIdle = 0;

/// One line: who left the processor, how, and who came.
struct Switch {
  std::int64_t at_ns;
  pid_t left;
  char left_as;
  pid_t came;
  std::string_view program;
};

// A program chooses its own name, and may choose a mark of the format: so each field is looked for
// from the end of the line, where the kernel's own numbers stand.
struct Fields {
  std::string_view line;

  /// What stands behind the last `mark`, which goes with all behind it; empty without one.
  std::string_view cut(std::string_view mark) {
    const std::size_t begin = line.rfind(mark);
    if (begin == line.npos) return {};
    const std::string_view found = line.substr(begin + mark.size());
    line = line.substr(0, begin);
    return found;
  }
  pid_t number(std::string_view mark) {
    const std::string_view text = cut(mark);
    pid_t value = -1;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }
};

std::optional<Switch> switch_of(std::string_view line) {
  if (line.find(": sched_switch: ") == line.npos) return std::nullopt;
  Fields fields{line};
  Switch found{};
  found.came = fields.number(" next_pid=");
  found.program = fields.cut(" ==> next_comm=");
  const std::string_view state = fields.cut(" prev_state=");
  found.left = fields.number(" prev_pid=");
  fields.cut(": sched_switch: ");
  const std::string seconds(fields.cut(" "));
  if (state.empty() || seconds.empty()) return std::nullopt;
  found.left_as = state.front();
  found.at_ns = std::llround(1e9 * std::strtod(seconds.c_str(), nullptr));
  return found;
}

std::string printable(std::string_view name) {
  constexpr std::size_t kLongest = 15;  // TASK_COMM_LEN
  std::string out(name.substr(0, kLongest));
  std::ranges::replace_if(out, [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

// The longest time from a leaving of the thread, `from_ns` or later, until it came back.
struct Absence {
  std::int64_t from_ns = 0;
  std::int64_t until_ns = 0;
  char left_as = 0;
};

std::vector<Switch> switches_of(std::string_view trace) {
  std::vector<Switch> switches;
  while (!trace.empty()) {
    const std::string_view line = trace.substr(0, trace.find('\n'));
    trace.remove_prefix(std::min(trace.size(), line.size() + 1));
    if (const std::optional<Switch> found = switch_of(line)) switches.push_back(*found);
  }
  return switches;
}

Absence longest_absence(const std::vector<Switch>& switches, pid_t thread, std::int64_t from_ns,
                        std::int64_t until_ns) {
  constexpr std::int64_t kStamp_ns = 1000;  // the trace's stamps are whole microseconds
  Absence longest;
  Absence open;
  for (const Switch& each : switches) {
    if (each.left == thread) open = {each.at_ns, 0, each.left_as};
    if (each.came != thread || open.left_as == 0) continue;
    open.until_ns = each.at_ns;
    const bool within =
        open.from_ns >= from_ns - kStamp_ns && open.until_ns <= until_ns + kStamp_ns;
    if (within && open.until_ns - open.from_ns > longest.until_ns - longest.from_ns) longest = open;
    open = {};
  }
  return longest;
}

}  // namespace

Occupation occupation(std::string_view trace, pid_t thread, std::int64_t from_ns,
                      std::int64_t until_ns) {
  const std::vector<Switch> switches = switches_of(trace);
  const Absence away = longest_absence(switches, thread, from_ns, until_ns);
  Occupation found;
  found.left_as = away.left_as;
  std::map<std::string_view, std::int64_t> had_ns;
  for (std::size_t i = 0; i + 1 < switches.size(); ++i) {
    const std::int64_t spent_ns =
        std::min(switches[i + 1].at_ns, away.until_ns) - std::max(switches[i].at_ns, away.from_ns);
    if (spent_ns <= 0) continue;
    (switches[i].came == kIdle ? found.idle_ns : had_ns[switches[i].program]) += spent_ns;
  }
  const auto most =
      std::ranges::max_element(had_ns, {}, [](const auto& each) { return each.second; });
  if (most != had_ns.end()) {
    found.program = printable(most->first);
    found.had_ns = most->second;
  }
  return found;
}

SwitchTrace::SwitchTrace(const std::filesystem::path& tracefs)
    : instance_(tracefs / "instances" / "stillhand") {
  const auto set = [this](const char* file, const char* value) {
    std::ofstream(instance_ / file) << value;
  };
  // The last process of another session may remove it in between.
  for (int tried = 0; tried < 2 && joined_ < 0; ++tried) {
    const bool made = mkdir(instance_.c_str(), 0700) == 0;
    joined_ = open((instance_ / "trace_clock").c_str(), O_RDONLY | O_CLOEXEC);
    if (!made || joined_ < 0) continue;
    set("buffer_size_kb", "1024");
    set("trace_clock", "mono");
  }
  if (available()) set("events/sched/sched_switch/enable", "1");  // its maker may have died before
}

SwitchTrace::~SwitchTrace() {
  if (joined_ < 0) return;
  close(joined_);
  rmdir(instance_.c_str());  // refused while another process has joined
}

Occupation SwitchTrace::of(int processor, pid_t thread, std::int64_t from_ns,
                           std::int64_t until_ns) const {
  if (!available()) return {};
  std::ifstream file(instance_ / "per_cpu" / ("cpu" + std::to_string(processor)) / "trace");
  const std::string trace{std::istreambuf_iterator<char>(file), {}};
  return occupation(trace, thread, from_ns, until_ns);
}

}  // namespace stillhand::runtime
