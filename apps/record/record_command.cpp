// SPDX-License-Identifier: Apache-2.0
#include "apps/record/record_command.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "apps/record/record.hpp"
#include "services/contract/config_error.hpp"
#include "services/recording/keep_options.hpp"
#include "services/recording/within.hpp"
#include "services/runtime/process/clock.hpp"
#include "services/runtime/process/real_time.hpp"
#include "services/runtime/process/shipped.hpp"
#include "services/settings/check_name.hpp"

namespace stillhand::record {
namespace {

constexpr double kBytesPerMb = 1e6;
constexpr double kMostSeconds = 1e7;  // four months
constexpr double kMostMb = 1e9;

struct Words {
  RecordOptions options;
  bool ordinary = false;
  std::string out, remote;
  recording::KeepOptions keep;
  double duration_s = 0, rotate_s = 0, rotate_mb = 0, window_s = 0;
};

std::int64_t ns_of(double seconds) {
  return std::llround(seconds * static_cast<double>(runtime::kNsPerSecond));
}

int run(Words words) {
  RecordOptions& options = words.options;
  if (words.remote.empty() && words.out.empty()) {
    throw ConfigError("--out", "none", "the MCAP file to write");
  }
  options.tape = recording::tape_options(words.keep, words.out);
  if (words.duration_s > 0) options.duration_ns = ns_of(words.duration_s);
  options.tape.rotation.max_ns = ns_of(words.rotate_s);
  options.tape.rotation.max_bytes = static_cast<std::uint64_t>(words.rotate_mb * kBytesPerMb);
  options.tape.window_ns = ns_of(words.window_s);
  if ((options.trigger_on_deadline || !options.triggers.empty()) && words.window_s <= 0) {
    throw ConfigError("--trigger", "one without --window", "--window S with it");
  }
  runtime::Stop stop;
  if (!words.remote.empty()) return run_remote(words.remote, options, stop);
  // Before the participant: Fast DDS's threads inherit it.  Where it is refused, it goes without.
  if (!words.ordinary) runtime::become_real_time(!options.security.empty());
  return run_record(options, stop);
}

}  // namespace

void add_record_command(CLI::App& cli, int& status) {
  auto words = std::make_shared<Words>();
  RecordOptions& options = words->options;
  options.profiles = runtime::shipped("qos/profiles.xml");
  CLI::App* verb = cli.add_subcommand(
      "record",
      "Records a running bus into an MCAP file, from outside: no session waits for it or ends "
      "with\n"
      "it. Every topic whose type is known, unless patterns say otherwise; in a pattern * stands\n"
      "for any run of characters and ? for one. Ends with Ctrl-C or --duration, and tells for "
      "each\n"
      "topic how many messages came, were lost and were written. Exit status 1 when any was lost.\n"
      "Example: stillhand record --out run.mcap --topics 'stillhand/*' --block '*status'");
  verb->add_option("--out", words->out, "MCAP file; must not be there yet");
  verb->add_option("--topics", options.topics.allow, "record topics that match; may be repeated")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--block", options.topics.block, "and none that match; may be repeated")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--require", options.required,
                   "topic that must be there: says in red when it is not, before a trial starts "
                   "and at the end; may be repeated")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--duration", words->duration_s, "stop after that long [s]")
      ->check(recording::within(0.001, kMostSeconds));
  verb->add_option("--rotate-s", words->rotate_s, "go on in another file after that long [s]")
      ->check(recording::within(0.1, kMostSeconds));
  verb->add_option("--rotate-mb", words->rotate_mb, "go on in another file after that much [MB]")
      ->check(recording::within(0.1, kMostMb));
  verb->add_option("--window", words->window_s,
                   "keep only that much in memory until something triggers [s]")
      ->check(recording::within(0.1, 3600.0));
  verb->add_option("--trigger", options.triggers,
                   "a signal beyond a threshold writes the window: TOPIC.FIELD>VALUE or <VALUE, "
                   "|FIELD| for its magnitude; may be repeated")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_flag("--trigger-on-deadline", options.trigger_on_deadline,
                 "a missed deadline writes the window");
  recording::add_keep_options(*verb, words->keep);
  verb->add_option("--remote", words->remote,
                   "instead: tell the recorder on this domain to pause, resume, trigger or stop");
  verb->add_flag("--no-real-time", words->ordinary, "do not ask for real-time priority");
  verb->add_option("--domain", options.domain, "DDS domain, 0 to 232")->capture_default_str();
  verb->add_option("--profiles", options.profiles, "QoS profiles")->capture_default_str();
  verb->add_option("--security", options.security,
                   "folder of certificates (deploy/security/make.sh), of which this verb is the "
                   "tap; none: no security")
      ->check(settings::check_name);
  verb->callback([words, &status] { status = run(*words); });
}

}  // namespace stillhand::record
