// SPDX-License-Identifier: Apache-2.0
#include "apps/record/record_command.hpp"

#include <cmath>
#include <memory>

#include "apps/record/record.hpp"
#include "services/bus/recording/keep_options.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"
#include "services/system/process/shipped.hpp"

namespace stillhand::record {
namespace {

constexpr double kBytesPerMb = 1e6;
constexpr double kMostSeconds = 1e7;  // four months
constexpr double kMostMb = 1e9;

struct Arguments {
  RecordOptions options;
  bool ordinary = false;
  std::string out, remote;
  recording::KeepOptions keep;
  double duration_s = 0, rotate_s = 0, rotate_mb = 0, window_s = 0;
};

std::int64_t ns_of(double seconds) {
  return std::llround(seconds * static_cast<double>(runtime::kNsPerSecond));
}

int run(Arguments arguments) {
  RecordOptions& options = arguments.options;
  if (arguments.remote.empty() && arguments.out.empty()) {
    throw ConfigError("--out", "none", "the MCAP file to write");
  }
  options.tape = recording::tape_options(arguments.keep, arguments.out);
  if (arguments.duration_s > 0) options.duration_ns = ns_of(arguments.duration_s);
  options.tape.rotation.max_ns = ns_of(arguments.rotate_s);
  options.tape.rotation.max_bytes = static_cast<std::uint64_t>(arguments.rotate_mb * kBytesPerMb);
  options.tape.window_ns = ns_of(arguments.window_s);
  if ((options.trigger_on_deadline || !options.triggers.empty()) && arguments.window_s <= 0) {
    throw ConfigError("--trigger", "no --window", "--window S together with a trigger");
  }
  runtime::Stop stop;
  if (!arguments.remote.empty()) return run_remote(arguments.remote, options, stop);
  // Before the participant exists, since Fast DDS's threads inherit the priority.  If the system
  // refuses it, the verb runs without.
  if (!arguments.ordinary) {
    runtime::become_real_time(!options.security.empty(), runtime::kListenerPriority);
  }
  return run_record(options, stop);
}

}  // namespace

void add_record_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  RecordOptions& options = arguments->options;
  options.profiles = runtime::shipped("qos/profiles.xml");
  command_line::Command verb = cli.add_subcommand(
      "record",
      "Records a running bus into an MCAP file. The verb is outside of every session: no\n"
      "session waits for it or ends with it. It records every topic of any DDS program, unless\n"
      "patterns select fewer; in a pattern * stands for any run of characters and ? for one\n"
      "character. A type that neither the bus nor --idl describes is recorded as bytes. It ends\n"
      "with Ctrl-C or after --duration, and prints for each topic how many messages it received,\n"
      "lost and wrote. Exit status 1 when a message was lost.\n"
      "Example: stillhand record --out run.mcap --topics 'stillhand/*' --block '*status'");
  verb.add_option("--out", arguments->out, "MCAP file to write; it must not exist yet");
  verb.add_option("--topics", options.topics.allow, "pattern of topics to record; may be repeated")
      .repeatable();
  verb.add_option("--block", options.topics.block,
                  "pattern of topics not to record; may be repeated")
      .repeatable();
  verb.add_option(
          "--require", options.required,
          "required topic: a warning in red when it is silent before a trial starts, and exit "
          "status 1 when it is silent at the end; may be repeated")
      .repeatable();
  verb.add_option("--idl", options.idl,
                  "IDL file with types that the bus does not describe; may be repeated")
      .repeatable();
  verb.add_option("--duration", arguments->duration_s, "end after this time [s]")
      .default_str("")
      .check(settings::number_between(0.001, kMostSeconds));
  verb.add_option("--rotate-s", arguments->rotate_s, "continue in a new file after this time [s]")
      .default_str("")
      .check(settings::number_between(0.1, kMostSeconds));
  verb.add_option("--rotate-mb", arguments->rotate_mb,
                  "continue in a new file after this size [MB]")
      .default_str("")
      .check(settings::number_between(0.1, kMostMb));
  verb.add_option("--window", arguments->window_s,
                  "event window: keep the last seconds in memory and write them at a trigger [s]")
      .default_str("")
      .check(settings::number_between(0.1, 3600.0));
  verb.add_option("--trigger", options.triggers,
                  "write the window when a field crosses a threshold: TOPIC.FIELD>VALUE or "
                  "TOPIC.FIELD<VALUE, |FIELD| for its magnitude; may be repeated")
      .repeatable();
  verb.add_flag("--trigger-on-deadline", options.trigger_on_deadline,
                "write the window when a process reports a missed deadline");
  recording::add_keep_options(verb, arguments->keep);
  verb.add_option("--remote", arguments->remote,
                  "do not record; send this to the recorders of the domain")
      .type_name("{pause,resume,trigger,stop}");
  verb.add_flag("--no-real-time", arguments->ordinary, "do not ask for real-time priority");
  verb.add_option("--domain", options.domain, "DDS domain, 0 to 232");
  verb.add_option("--profiles", options.profiles, "QoS profiles");
  verb.add_option("--security", options.security,
                  "folder of certificates (deploy/security/make.sh); the verb uses that of the tap "
                  "[no security]")
      .check(settings::check_name);
  verb.callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace stillhand::record
