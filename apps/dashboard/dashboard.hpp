// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "apps/dashboard/feed/live_bus.hpp"
#include "apps/dashboard/server/http_server.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::dashboard {

struct DashboardOptions {
  HttpServer::Options server;
  LiveOptions bus;
  std::filesystem::path config;  ///< folder of the settings
  std::filesystem::path pages;   ///< folder of the page's files
  std::string token_file;        ///< empty: none
  std::string watch_token_file;  ///< empty: none
  std::string recording;         ///< empty: the bus
  std::uint32_t rig = 1;
  bool blinded = true;
  bool read_only = false;  ///< sends nothing to the session
  bool real_time = true;   ///< request SCHED_FIFO for the receiving threads
};

/// Serves the page until a signal comes.  @returns 0
/// @throws ConfigError, runtime::BusError
int run_dashboard(const DashboardOptions& options, runtime::Stop& stop);

}  // namespace stillhand::dashboard
