// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/remote.hpp"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>

#include "apps/libraries/report/command_line.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::lab {
namespace {

using report::in_shell_quotes;

constexpr std::int64_t kPatience_ns = 30 * runtime::kNsPerSecond;  // with a host that is silent
constexpr std::int64_t kPoll_ns = 5'000'000;
constexpr std::string_view kFolder = "/tmp/stillhand-";
constexpr std::string_view kMade = "\nstillhand made ";  // a line that nobody else prints

std::uintmax_t size_of(const std::filesystem::path& file) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(file, none);
  return none ? 0 : size;
}

// The words that reach the host's shell, which reads its script from standard input.
std::vector<std::string> to_shell(const deploy::Host& host) {
  std::vector<std::string> words(host.start.begin() + 1, host.start.end());
  words.insert(words.end(), {"bash", "-s"});
  return words;
}

// The first end mark that is no line of the text.
std::string end_mark(const std::string& text) {
  std::string mark = "END";
  while (("\n" + text + "\n").find("\n" + mark + "\n") != std::string::npos) mark += "_";
  return mark;
}

}  // namespace

std::string here_document(const std::string& text) {
  const std::string end = end_mark(text);
  const bool whole = text.empty() || text.ends_with('\n');
  return fmt::format("<<'{0}'\n{1}{2}{0}\n", end, text, whole ? "" : "\n");
}

std::string folder_made(const std::string& printed) {
  const std::size_t line = printed.rfind(kMade);
  if (line == std::string::npos) return "";
  const std::size_t from = line + kMade.size();
  const std::size_t end = printed.find('\n', from);
  if (end == std::string::npos) return "";
  std::string folder = printed.substr(from, end - from);
  return folder.starts_with(kFolder) ? folder : "";
}

RemoteHost::RemoteHost(const deploy::Host& host, std::filesystem::path log)
    : host_(host), log_(std::move(log)) {}

void RemoteHost::run(const std::string& script, const std::filesystem::path& output,
                     const runtime::Stop* stop) {
  Launch errand;
  errand.name = "the shell";
  errand.host = host_.name;
  errand.executable = host_.start.front();
  errand.arguments = to_shell(host_);
  errand.log = log_;
  errand.output = output;
  errand.standard_input = script;
  Processes processes;
  processes.start(errand);
  std::int64_t limit_ns = runtime::monotonic_ns() + kPatience_ns;
  std::uintmax_t printed = 0;
  std::optional<Ended> ended;
  while (!(ended = processes.reap())) {
    if (const std::uintmax_t now = size_of(output); now > printed) {
      printed = now;
      limit_ns = runtime::monotonic_ns() + kPatience_ns;
    }
    if (stop != nullptr && stop->requested()) throw Interrupted();
    if (runtime::monotonic_ns() > limit_ns) {
      throw std::runtime_error(fmt::format("host {} did not answer within 30 s", host_.name));
    }
    runtime::sleep_until_ns(runtime::monotonic_ns() + kPoll_ns);
  }
  if (ended->exit_status != 0) throw std::runtime_error(describe(*ended));
}

void RemoteHost::open(const runtime::Stop& stop) {
  std::string made;
  try {
    // The log also holds the lines of ssh and of the login.
    run(fmt::format("folder=$(mktemp -d {}XXXXXXXX) || exit 1\n"
                    "printf '\\nstillhand made %s\\n' \"$folder\"\n",
                    kFolder),
        {}, &stop);
    made = folder_made(recording::text_of(log_));
    if (made.empty()) throw std::runtime_error("no folder was made in /tmp");
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    throw ConfigError(
        fmt::format("{}: host {}", host_.place, host_.name), error.what(),
        fmt::format("a host that answers to: {} bash -s", fmt::join(host_.start, " ")));
  }
  folder_ = made;
}

void RemoteHost::check(const std::string& script, const std::string& want) {
  try {
    run(script);
  } catch (const std::exception& error) {
    throw ConfigError(fmt::format("{}: host {}", host_.place, host_.name), error.what(), want);
  }
}

void RemoteHost::close() {
  if (folder_.empty()) return;
  run("rm -r " + in_shell_quotes(folder_) + "\n");
  folder_.clear();
}

void RemoteHost::put(const std::map<std::string, std::string>& files) {
  std::string script = fmt::format("set -e\numask 077\ncd {}\n", in_shell_quotes(folder_));
  for (const auto& [name, text] : files) {
    const std::filesystem::path folder = std::filesystem::path(name).parent_path();
    if (!folder.empty()) script += fmt::format("mkdir -p {}\n", in_shell_quotes(folder.string()));
    script += fmt::format("cat > {} {}", in_shell_quotes(name), here_document(text));
  }
  run(script);
}

void RemoteHost::fetch(const std::string& name, const std::filesystem::path& to) {
  // Under its name only once it is whole.
  const std::filesystem::path part = to.string() + ".part";
  try {
    run("cat " + in_shell_quotes((std::filesystem::path(folder_) / name).string()) + "\n", part);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw;
  }
  std::filesystem::rename(part, to);
}

Launch RemoteHost::on_it(const Launch& local) const {
  Launch launch = local;
  std::string command =
      in_shell_quotes((host_.prefix / "bin" / local.executable.filename()).string());
  for (const std::string& word : local.arguments) command += ' ' + in_shell_quotes(word);
  launch.host = host_.name;
  launch.executable = host_.start.front();
  launch.arguments = to_shell(host_);
  // The process's own standard input is empty; the process ends when the shell's input, which the
  // lab holds, is closed.  In braces, so that the shell has read the whole script before another
  // command reads on.
  launch.standard_input = "{\n" + command +
                          " --end-with-parent $$ < /dev/null &\n"
                          "child=$!\n"
                          "{ cat; kill $child; sleep 10; kill -9 $child; } <&0 > /dev/null 2>&1 &\n"
                          "wait $child; status=$?\n"
                          "kill $! 2> /dev/null\n"
                          "exit $status\n}\n";
  launch.ends_with_input = true;
  return launch;
}

}  // namespace stillhand::lab
