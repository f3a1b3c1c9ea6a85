// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/switch_trace.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>

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

/// What stands between two marks; empty without them.
std::string_view between(std::string_view line, std::string_view before, std::string_view behind) {
  const std::size_t begin = line.find(before);
  if (begin == line.npos) return {};
  line.remove_prefix(begin + before.size());
  return line.substr(0, line.find(behind));
}

pid_t id_in(std::string_view line, std::string_view before) {
  return static_cast<pid_t>(std::atoi(std::string(between(line, before, " ")).c_str()));
}

std::optional<Switch> switch_of(std::string_view line) {
  constexpr std::string_view kEvent = ": sched_switch: ";
  const std::size_t event = line.find(kEvent);
  if (event == line.npos) return std::nullopt;
  const std::size_t stamp = line.rfind(' ', event);
  const std::string_view state = between(line, " prev_state=", " ");
  if (stamp == line.npos || state.empty()) return std::nullopt;
  const std::string seconds(line.substr(stamp + 1, event - stamp - 1));
  return Switch{std::llround(1e9 * std::strtod(seconds.c_str(), nullptr)),
                id_in(line, " prev_pid="), state.front(), id_in(line, " next_pid="),
                between(line, " next_comm=", " next_pid=")};
}

}  // namespace

Occupation occupation(std::string_view trace, pid_t thread, std::int64_t from_ns,
                      std::int64_t until_ns) {
  Occupation found;
  std::map<std::string_view, std::int64_t> had_ns;
  std::optional<Switch> before;
  const auto count = [&](std::int64_t end_ns) {
    if (!before || before->came == thread) return;
    const std::int64_t spent_ns = std::min(end_ns, until_ns) - std::max(before->at_ns, from_ns);
    if (spent_ns <= 0) return;
    (before->came == kIdle ? found.idle_ns : had_ns[before->program]) += spent_ns;
  };
  while (!trace.empty()) {
    const std::string_view line = trace.substr(0, trace.find('\n'));
    trace.remove_prefix(std::min(trace.size(), line.size() + 1));
    const std::optional<Switch> now = switch_of(line);
    if (!now) continue;
    if (now->at_ns > until_ns) break;
    count(now->at_ns);
    if (now->left == thread) found.left_as = now->left_as;
    before = now;
  }
  count(until_ns);
  const auto most =
      std::ranges::max_element(had_ns, {}, [](const auto& each) { return each.second; });
  if (most != had_ns.end()) {
    found.program = most->first;
    found.had_ns = most->second;
  }
  return found;
}

SwitchTrace::SwitchTrace(const std::filesystem::path& tracefs)
    : instance_(tracefs / "instances" / "stillhand") {
  const auto set = [this](const char* file, const char* value) {
    std::ofstream(instance_ / file) << value;
  };
  if (mkdir(instance_.c_str(), 0700) == 0) {  // else another process of the session made it
    set("buffer_size_kb", "1024");
    set("trace_clock", "mono");
    set("events/sched/sched_switch/enable", "1");
  }
  joined_ = open((instance_ / "trace_clock").c_str(), O_RDONLY | O_CLOEXEC);
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
