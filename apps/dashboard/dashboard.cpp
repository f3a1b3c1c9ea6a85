// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/dashboard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <cstdio>
#include <optional>

#include "apps/dashboard/feed/recorded_run.hpp"
#include "apps/dashboard/feed/rigs.hpp"
#include "apps/dashboard/remote.hpp"
#include "apps/dashboard/view/snapshot_json.hpp"
#include "apps/dashboard/view/view_json.hpp"
#include "apps/libraries/session/answer_settings.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/cpu_share.hpp"
#include "services/system/process/real_time.hpp"

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
  if (options.token_file.empty() && !options.watch_token_file.empty()) {
    throw ConfigError("--watch-token-file", "it without --token-file",
                      "--token-file FILE too, for those who act");
  }
  if (!options.token_file.empty()) {
    const std::string token = read_token("--token-file", options.token_file);
    if (options.watch_token_file.empty()) return Access(token);
    const std::string watch_token = read_token("--watch-token-file", options.watch_token_file);
    if (watch_token == token) {
      throw ConfigError("--watch-token-file", "the token of --token-file", "another token");
    }
    return Access(token, watch_token);
  }
  if (!is_loopback(options.server.address)) {
    throw ConfigError("--bind", options.server.address + " without --token-file",
                      "--token-file FILE, since other hosts can reach this address");
  }
  return Access("");
}

FeedOptions feed_options(const DashboardOptions& options) {
  FeedOptions feed;
  feed.config = settings::load<Config>(options.config / "dashboard.yaml", "dashboard");
  feed.rig = options.rig;
  feed.blinded = options.blinded;
  feed.listener = options.recording.empty() ? "experiment" : "recorder";
  feed.answers = session::load_answers(options.config);
  return feed;
}

Surroundings surroundings(const DashboardOptions& options, const FeedOptions& feed) {
  Surroundings around;
  around.mode = options.recording.empty() ? "live" : "recording";
  around.file = std::filesystem::path(options.recording).filename().string();
  around.domain = options.bus.domain;
  // Canceller and drive limit the force separately: the smaller limit holds.
  around.motor_limit_n = std::min(feed.answers->cancellation.limits.max_force_n,
                                  feed.answers->motor.limits.max_force_n);
  around.screen =
      settings::load<display::TrackingDisplay::Config>(options.config / "display.yaml", "display");
  return around;
}

// Fast DDS's threads inherit the priority.  On a busy machine a thread without it would stamp a
// sample when this process is scheduled.  The priority is below the control path, and the threads
// only copy.  Not with security: they would share Fast DDS's locks with the ordinary thread here,
// see become_real_time().
void raise_priority(const DashboardOptions& options) {
  const bool plain = options.bus.security.empty();
  if (options.real_time && plain && runtime::become_real_time()) runtime::become_background();
}

/// A running bus or a recording, and its page.
class Dashboard {
 public:
  Dashboard(const DashboardOptions& options, runtime::Stop& stop)
      : stop_(stop),
        pages_(options.pages),
        access_(access_of(options)),
        feed_options_(feed_options(options)),
        rigs_(feed_options_),
        around_(surroundings(options, feed_options_)),
        server_(options.server, pages_, access_, served(options)) {
    if (options.recording.empty()) {
      listen(options);
    } else {
      read(options.recording);
    }
  }

  [[nodiscard]] std::uint16_t port() const { return server_.port(); }

  void run() {
    const runtime::OrdinaryWhile ordinary;
    for (std::int64_t framed_ns = 0; !stop_.requested();) {
      server_.run_for(kDrain);
      if (bus_) {
        // The time is read before the messages that it is compared with.  In the other order a
        // delay of this process between the two would make every topic look silent.
        now_ns_ = runtime::system_ns();
        bus_->drain();
      }
      const std::int64_t monotonic_ns = runtime::monotonic_ns();
      if (monotonic_ns - framed_ns < kFrame_ns) continue;
      framed_ns = monotonic_ns;
      frame();
    }
  }

 private:
  Served served(const DashboardOptions& options) {
    std::function<std::string()> timeline;
    if (!options.recording.empty()) {
      timeline = [this] { return timeline_json(run_->timeline()).dump(); };
    }
    return {[this](std::optional<double> at_s) { return snapshot(at_s); }, timeline,
            [this](std::string_view path, const std::string& text) { return act(path, text); }};
  }

  void listen(const DashboardOptions& options) {
    raise_priority(options);
    bus_.emplace(options.bus, rigs_);
    bus_->start();
    if (!options.read_only) remote_.emplace(options.bus, options.rig);
    around_.actions = remote_.has_value();
  }

  void read(const std::string& recording) {
    run_.emplace(recording, feed_options_, [this] { return stop_.requested(); });
    now_ns_ = run_->timeline().end_ns();
    feed() = run_->as_of(now_ns_);
  }

  [[nodiscard]] MessageFeed& feed() { return rigs_.shown(); }

  std::string snapshot(std::optional<double> at_s) {
    if (!run_ || !at_s) return snapshot_json(feed(), around_, now_ns_, -1);
    const std::int64_t at_ns = run_->instant_ns(*at_s);
    return snapshot_json(run_->as_of(at_ns), around_, at_ns, -1);
  }

  // The outcome of a request of the page.
  Outcome act(std::string_view path, const std::string& text) {
    if (path == "/acknowledge" && run_) {
      return {Outcome::Kind::kRefused, "alarms of a recording cannot be acknowledged"};
    }
    if (path == "/acknowledge") {
      const Outcome noted = remote_ ? remote_->note("alarms acknowledged") : Outcome{};
      if (noted.kind == Outcome::Kind::kDone) feed().acknowledge();
      return noted;
    }
    if (!remote_) {
      return {Outcome::Kind::kRefused,
              "this dashboard is read-only: it shows a recording, or was started with --read-only"};
    }
    return remote_->ask(path, text);
  }

  // Ten times a second.
  void frame() {
    around_.cpu_share = cpu_.step();
    around_.clients = server_.listeners();
    if (bus_) {
      around_.dropped = bus_->dropped();
      around_.trouble = bus_->trouble();
      rigs_.step(now_ns_);
      around_.rigs = rigs_.summaries();
      if (remote_) remote_->step();
    }
    const Parts parts{frame_ % kGraphEvery == 0, frame_ % kSpectrumEvery == 0};
    ++frame_;
    if (around_.clients > 0) {
      // The page asks for each instant of a recording; the stream only shows that the process
      // lives.
      server_.broadcast(bus_ ? snapshot_json(feed(), around_, now_ns_, sent_tick_, parts)
                             : R"({"mode":"recording"})");
    }
    const auto rows = feed().traces().rows(sent_tick_);
    if (!rows.empty()) sent_tick_ = rows.back().tick;
  }

  runtime::Stop& stop_;
  Pages pages_;
  Access access_;
  FeedOptions feed_options_;
  Rigs rigs_;
  Surroundings around_;
  std::int64_t now_ns_ = runtime::system_ns();
  std::optional<Remote> remote_;
  std::optional<RecordedRun> run_;
  HttpServer server_;
  std::optional<LiveBus> bus_;
  runtime::ProcessCpu cpu_;
  Tick sent_tick_ = -1;
  std::uint64_t frame_ = 0;
};

}  // namespace

int run_dashboard(const DashboardOptions& options, runtime::Stop& stop) {
  Dashboard dashboard(options, stop);
  const std::string& address = options.server.address;
  const bool six = address.find(':') != std::string::npos;
  fmt::print("http://{}{}{}:{}/\n", six ? "[" : "", address, six ? "]" : "", dashboard.port());
  std::fflush(stdout);
  dashboard.run();
  return 0;
}

}  // namespace stillhand::dashboard
