// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "apps/dashboard/server/routes.hpp"

namespace stillhand::dashboard {

/// HTTP/1.1 in the thread that calls run_for(), and in no other.  Everything a client can make it
/// hold has a bound: connections, header, body, time for a request, frames that wait for a client.
/// A client that exceeds one gets an answer or is dropped.  When all connections are taken, a new
/// one displaces another: HttpClients says which.
class HttpServer {
 public:
  struct Options {
    std::string address = "127.0.0.1";
    std::uint16_t port = 0;  ///< 0: any free port
  };
  static constexpr std::size_t kMostConnections = 64;
  static constexpr std::size_t kMostListeners = 48;  ///< the others are for requests
  static constexpr std::size_t kMostQueued = 20;     ///< frames: 2 s

  /// @param pages,access  outlive it  @throws ConfigError when the address cannot be listened on
  HttpServer(const Options& options, const Pages& pages, const Access& access, Served served);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// Answers requests until the time is over.
  void run_for(std::chrono::milliseconds time);
  /// Clients of the event stream.
  [[nodiscard]] std::size_t listeners() const;
  /// One event to each of them; a client with kMostQueued waiting frames is dropped.
  void broadcast(const std::string& json);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stillhand::dashboard
