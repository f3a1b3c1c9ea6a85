// SPDX-License-Identifier: Apache-2.0
#include "dashboard/dashboard.hpp"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <cstdio>
#include <ctime>
#include <optional>

#include "cancellation/core/canceller.hpp"
#include "contract/config_error.hpp"
#include "dashboard/recorded_run.hpp"
#include "dashboard/snapshot_json.hpp"
#include "rig/core/rig.hpp"
#include "runtime/clock.hpp"
#include "runtime/real_time.hpp"
#include "settings/load.hpp"

namespace stillhand::dashboard {

namespace {

constexpr std::chrono::milliseconds kDrain{20};
constexpr std::int64_t kFrame_ns = runtime::kNsPerSecond / 10;

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

/// Share of one core that this process used since the last call.
class CpuShare {
 public:
  double step(std::int64_t now_ns) {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    const std::int64_t used_ns = used.tv_sec * runtime::kNsPerSecond + used.tv_nsec;
    if (now_ns - since_ns_ >= runtime::kNsPerSecond) {
      share_ = static_cast<double>(used_ns - used_ns_) / static_cast<double>(now_ns - since_ns_);
      since_ns_ = now_ns;
      used_ns_ = used_ns;
    }
    return share_;
  }

 private:
  std::int64_t since_ns_ = runtime::monotonic_ns(), used_ns_ = 0;
  double share_ = 0.0;
};

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
  MessageFeed feed(feed_options);
  around.motor_limit_n = motor_limit_n(options.config);

  std::int64_t now_ns = runtime::system_ns();
  const Served served{[&] { return snapshot_json(feed, around, now_ns, -1); },
                      [&] { feed.acknowledge(); }};
  HttpServer server(options.server, pages, access, served);
  std::optional<LiveBus> bus;
  if (live) {
    // For Fast DDS's threads, which inherit it: on a busy machine a sample would else be stamped
    // when this process gets its turn.  Below the control path, and they only copy.
    if (options.real_time && runtime::become_real_time()) runtime::become_background();
    bus.emplace(options.bus, feed);
    bus->start();
  } else {
    now_ns = feed_recording(options.recording, feed, [&stop] { return stop.requested(); });
  }
  const runtime::OrdinaryWhile ordinary;
  const bool six = options.server.address.find(':') != std::string::npos;
  std::printf("http://%s%s%s:%u/\n", six ? "[" : "", options.server.address.c_str(), six ? "]" : "",
              server.port());
  std::fflush(stdout);

  CpuShare cpu;
  Tick told_tick = -1;
  std::int64_t framed_ns = 0;
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
    around.cpu_share = cpu.step(monotonic_ns);
    around.clients = server.listeners();
    if (bus) {
      around.dropped = bus->dropped();
      around.trouble = bus->trouble();
      feed.step(now_ns);
    }
    if (around.clients > 0) server.broadcast(snapshot_json(feed, around, now_ns, told_tick));
    const auto rows = feed.traces().rows(told_tick);
    if (!rows.empty()) told_tick = rows.back().tick;
  }
  return 0;
}

}  // namespace stillhand::dashboard
