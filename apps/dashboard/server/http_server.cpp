// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/http_server.hpp"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

#include "apps/dashboard/server/http_connection.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::dashboard {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr int kBacklog = 1024;  // a flood fills it; later connections wait a second in the kernel
constexpr std::chrono::milliseconds kAcceptPause{100};

}  // namespace

struct HttpServer::Impl {
  Impl(const Pages& pages, const Access& access, Served served)
      : clients{pages, access, std::move(served)} {}

  void open(const Options& options);
  void accept();
  void make_room();

  HttpClients clients;
  asio::io_context io{1};  // its end is that of every connection in it
  tcp::acceptor acceptor{io};
  asio::steady_timer pause{io};
};

void HttpServer::Impl::open(const Options& options) {
  error_code error;
  const auto address = asio::ip::make_address(options.address, error);
  if (error) throw ConfigError("--bind", options.address, "an address of this host");
  const tcp::endpoint endpoint(address, options.port);
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(kBacklog, error);
  if (error) {
    throw ConfigError("--port", fmt::format("{}:{}", options.address, options.port),
                      fmt::format("an address and a port that are free ({})", error.message()));
  }
  accept();
}

void HttpServer::Impl::accept() {
  acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (error) {
      // Out of descriptors, as a rule: trying again at once would only burn time.
      pause.expires_after(kAcceptPause);
      pause.async_wait([this](error_code) { accept(); });
      return;
    }
    make_room();
    std::make_shared<HttpConnection>(std::move(socket), clients)->read();
    accept();
  });
}

// A flood displaces itself, and a client that sends its request at once is answered in time.
void HttpServer::Impl::make_room() {
  if (clients.connections < kMostConnections) return;
  for (const std::list<HttpConnection*>* each :
       {&clients.leaving, &clients.answering, &clients.asking, &clients.known}) {
    if (!each->empty()) return each->front()->close();
  }
}

HttpServer::HttpServer(const Options& options, const Pages& pages, const Access& access,
                       Served served)
    : impl_(std::make_unique<Impl>(pages, access, std::move(served))) {
  impl_->open(options);
}

HttpServer::~HttpServer() {
  for (const auto& listener : impl_->clients.listeners) listener->close();
  impl_->clients.listeners.clear();
}

std::uint16_t HttpServer::port() const { return impl_->acceptor.local_endpoint().port(); }

void HttpServer::run_for(std::chrono::milliseconds time) { impl_->io.run_for(time); }

std::size_t HttpServer::listeners() const { return impl_->clients.listeners.size(); }

void HttpServer::broadcast(const std::string& json) {
  const auto frame = std::make_shared<const std::string>("data: " + json + "\n\n");
  const auto listeners = impl_->clients.listeners;  // a copy: a dropped client leaves the set
  for (const auto& listener : listeners) listener->send(frame);
}

}  // namespace stillhand::dashboard
