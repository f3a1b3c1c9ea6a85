// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/dashboard.hpp"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <cstdio>
#include <optional>

#include "apps/dashboard/feed/recorded_run.hpp"
#include "apps/dashboard/feed/rigs.hpp"
#include "apps/dashboard/remote.hpp"
#include "apps/dashboard/view/snapshot_json.hpp"
#include "apps/dashboard/view/view_json.hpp"
#include "services/cancellation/core/canceller.hpp"
#include "services/contract/config_error.hpp"
#include "services/rig/core/rig.hpp"
#include "services/runtime/process/clock.hpp"
#include "services/runtime/process/cpu_share.hpp"
#include "services/runtime/process/real_time.hpp"
#include "services/settings/load.hpp"

namespace stillhand::dashboard {

namespace {

constexpr std::chrono::milliseconds kDrain{20};
constexpr std::int64_t kFrame_ns = runtime::kNsPerSecond / 10;
constexpr std::uint64_t kGraphEvery = 5, kSpectrumEvery = 10;  // frames

bool is_loopback(const std::string& address) {
  boost::system::error_code error;
  const auto parsed = boost::asio::ip::make_address(address, error);
  if (error) throw ConfigError("--bind", address, "an address of this host");
  return parsed.is_loopback();
}

Access access_of(const DashboardOptions& options) {
  if (!options.token_file.empty()) return Access(read_token(options.token_file));
  if (!is_loopback(options.server.address)) {
    throw ConfigError("--bind", options.server.address + " without --token-file",
                      "a file with a token: others than this host could look in");
  }
  return Access("");
}

// The narrower of the two holds; each is its process's own.
double motor_limit_n(const std::filesystem::path& config) {
  const auto canceller =
      settings::load<cancellation::Config>(config / "cancellation.yaml", "cancellation");
  const auto rig = settings::load<rig::RigConfig>(config / "rig.yaml", "rig");
  return std::min(canceller.limits.max_force_n, rig.motor.limits.max_force_n);
}

// What a request of the page comes to.
Outcome act(std::string_view path, MessageFeed& feed, std::optional<Remote>& remote) {
  if (path == "/acknowledge") {
    const Outcome told = remote ? remote->note("alarms acknowledged") : Outcome{};
    if (told.kind == Outcome::Kind::kDone) feed.acknowledge();
    return told;
  }
  if (!remote) {
    return {Outcome::Kind::kRefused, "this dashboard only looks: a recording, or --read-only"};
  }
  return remote->ask(path);
}

}  // namespace

int run_dashboard(const DashboardOptions& options, runtime::Stop& stop) {
  const Pages pages(options.pages);
  const Access access = access_of(options);
  const bool live = options.recording.empty();
  Surroundings around;
  around.mode = live ? "live" : "recording";
  around.file = std::filesystem::path(options.recording).filename().string();
  around.domain = options.bus.domain;
  FeedOptions feed_options;
  feed_options.config = settings::load<Config>(options.config / "dashboard.yaml", "dashboard");
  feed_options.rig = options.rig;
  feed_options.blinded = options.blinded;
  feed_options.listener = live ? "experiment" : "recorder";
  Rigs rigs(feed_options);
  MessageFeed& feed = rigs.shown();
  around.motor_limit_n = motor_limit_n(options.config);
  around.screen =
      settings::load<display::TrackingDisplay::Config>(options.config / "display.yaml", "display");

  std::int64_t now_ns = runtime::system_ns();
  std::optional<Remote> remote;
  std::optional<RecordedRun> run;
  const auto snapshot = [&](std::optional<double> at_s) {
    if (!run || !at_s) return snapshot_json(feed, around, now_ns, -1);
    const std::int64_t at_ns = run->instant_ns(*at_s);
    return snapshot_json(run->as_of(at_ns), around, at_ns, -1);
  };
  const auto timeline = [&] { return timeline_json(run->timeline()).dump(); };
  const Served served{snapshot, live ? std::function<std::string()>() : timeline,
                      [&](std::string_view path) { return act(path, feed, remote); }};
  HttpServer server(options.server, pages, access, served);
  std::optional<LiveBus> bus;
  if (live) {
    // For Fast DDS's threads, which inherit it: on a busy machine a sample would else be stamped
    // when this process gets its turn.  Below the control path, and they only copy.  Not with
    // security: they would share Fast DDS's locks with the ordinary thread here, see
    // become_real_time().
    const bool plain = options.bus.security.empty();
    if (options.real_time && plain && runtime::become_real_time()) runtime::become_background();
    bus.emplace(options.bus, rigs);
    bus->start();
    if (!options.read_only) remote.emplace(options.bus, options.rig);
    around.actions = remote.has_value();
  } else {
    run.emplace(options.recording, feed_options, [&stop] { return stop.requested(); });
    now_ns = run->timeline().end_ns();
    feed = run->as_of(now_ns);
  }
  const runtime::OrdinaryWhile ordinary;
  const bool six = options.server.address.find(':') != std::string::npos;
  std::printf("http://%s%s%s:%u/\n", six ? "[" : "", options.server.address.c_str(), six ? "]" : "",
              server.port());
  std::fflush(stdout);

  runtime::ProcessCpu cpu;
  Tick told_tick = -1;
  std::int64_t framed_ns = 0;
  std::uint64_t frame = 0;
  while (!stop.requested()) {
    server.run_for(kDrain);
    if (bus) {
      // Before what it is compared with: held up in between, this process would call others silent.
      now_ns = runtime::system_ns();
      bus->drain();
    }
    const std::int64_t monotonic_ns = runtime::monotonic_ns();
    if (monotonic_ns - framed_ns < kFrame_ns) continue;
    framed_ns = monotonic_ns;
    around.cpu_share = cpu.step();
    around.clients = server.listeners();
    if (bus) {
      around.dropped = bus->dropped();
      around.trouble = bus->trouble();
      rigs.step(now_ns);
      around.rigs = rigs.summaries();
      if (remote) remote->step();
    }
    const Parts parts{frame % kGraphEvery == 0, frame % kSpectrumEvery == 0};
    ++frame;
    if (around.clients > 0) {
      // A recording is asked for instant by instant; the page only hears that somebody is there.
      server.broadcast(bus ? snapshot_json(feed, around, now_ns, told_tick, parts)
                           : R"({"mode":"recording"})");
    }
    const auto rows = feed.traces().rows(told_tick);
    if (!rows.empty()) told_tick = rows.back().tick;
  }
  return 0;
}

}  // namespace stillhand::dashboard
