// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/http_server.hpp"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <deque>
#include <list>
#include <optional>
#include <set>
#include <utility>

#include "services/contract/config_error.hpp"

namespace stillhand::dashboard {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::size_t kMostHeader = 8192;
constexpr std::size_t kMostBody = 4096;
constexpr std::size_t kMostDiscarded = std::size_t{64} * 1024;
constexpr int kSendBuffer = 64 * 1024;
constexpr int kBacklog = 1024;  // a flood fills it; later connections wait a second in the kernel
constexpr std::chrono::seconds kRequestTime{10};
constexpr std::chrono::seconds kLeaveTime{2};
constexpr std::chrono::milliseconds kAcceptPause{100};

// The page runs only its own files and appears in no frame.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

void set_headers(http::fields& fields) {
  fields.set("Content-Security-Policy", kPolicy);
  fields.set("X-Content-Type-Options", "nosniff");
  fields.set("Referrer-Policy", "no-referrer");
  fields.set("Cross-Origin-Resource-Policy", "same-origin");
  fields.set(http::field::cache_control, "no-store");
}

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

}  // namespace

struct HttpServer::Impl {
  Impl(const Pages& pages_, const Access& access_, Served served_)
      : pages(pages_), access(access_), served(std::move(served_)) {}

  void open(const Options& options);
  void accept();
  [[nodiscard]] bool make_room();

  const Pages& pages;
  const Access& access;
  Served served;
  std::size_t connections = 0, streams = 0;
  // Connections that can be closed when all are taken, in this order, the oldest first: those that
  // have their last answer and stay open, and those without a complete request.
  std::list<Connection*> leaving, asking;
  asio::io_context io{1};  // its end is that of every Connection in it
  tcp::acceptor acceptor{io};
  asio::steady_timer pause{io};
  std::set<std::shared_ptr<Connection>> listeners;
};

/// One client; lives as long as an operation of it does, or as it listens.
class HttpServer::Connection : public std::enable_shared_from_this<HttpServer::Connection> {
 public:
  Connection(tcp::socket socket, Impl& server) : stream_(std::move(socket)), server_(server) {
    ++server_.connections;
  }
  ~Connection() {
    stand_nowhere();
    if (streams_) --server_.streams;
    --server_.connections;
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    stand_in(server_.asking);
    parser_.emplace();
    parser_->header_limit(kMostHeader);
    parser_->body_limit(kMostBody);
    stream_.expires_after(kRequestTime);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](error_code error, std::size_t /*bytes*/) {
                       self->answer_read(error);
                     });
  }

  void send(const std::shared_ptr<const std::string>& frame) {
    if (queue_.size() >= HttpServer::kMostQueued) return leave();
    queue_.push_back(frame);
    if (queue_.size() == 1) write_frame();
  }

  void close() {
    stand_nowhere();
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
    stream_.close();
  }

 private:
  void stand_in(std::list<Connection*>& list) {
    stand_nowhere();
    place_.emplace(&list, list.insert(list.end(), this));
  }
  void stand_nowhere() {
    if (place_) place_->first->erase(place_->second);
    place_.reset();
  }

  void answer_read(error_code error) {
    stand_nowhere();
    if (error == http::error::header_limit) return refuse(431, "a header of at most 8 KiB");
    if (error == http::error::body_limit) return refuse(413, "a body of at most 4 KiB");
    if (error && error.category() == http::make_error_code(http::error::bad_method).category() &&
        error != http::error::end_of_stream && error != http::error::partial_message) {
      return refuse(400, "HTTP/1.1");
    }
    if (error) return close();
    const auto& request = parser_->get();
    const Question question{view(request.method_string()),
                            view(request.target()),
                            view(request[http::field::host]),
                            view(request[http::field::origin]),
                            view(request[http::field::authorization]),
                            view(request[http::field::cookie])};
    const Answer found = answer(question, server_.pages, server_.access, server_.served);
    if (!found.streams) return respond(found, request.keep_alive());
    if (server_.streams < kMostListeners) return listen();
    Answer full;
    full.status = 503;
    full.body = fmt::format("too many open pages: at most {} can listen\n", kMostListeners);
    respond(full, false);
  }

  void refuse(unsigned status, const char* want) {
    Answer refusal;
    refusal.status = status;
    refusal.body = fmt::format("want {}\n", want);
    respond(refusal, false);
  }

  void respond(const Answer& found, bool keep_alive) {
    response_ = {};
    response_.version(11);
    response_.result(found.status);
    set_headers(response_);
    if (!found.location.empty()) response_.set(http::field::location, found.location);
    if (!found.cookie.empty()) response_.set(http::field::set_cookie, found.cookie);
    response_.keep_alive(keep_alive);
    if (found.status != 204) {
      response_.set(http::field::content_type, found.type);
      response_.body() = found.body;
      response_.prepare_payload();
    }
    stream_.expires_after(kRequestTime);
    http::async_write(stream_, response_,
                      [self = shared_from_this(), keep_alive](error_code error, std::size_t) {
                        if (error) return self->close();
                        if (keep_alive) return self->read();
                        error_code ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                        self->stand_in(self->server_.leaving);
                        self->stream_.expires_after(kLeaveTime);
                        self->discard(kMostDiscarded);
                      });
  }

  // Closed with something unread, TCP would take back the answer that says why.
  void discard(std::size_t most) {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kMostBody),
                            [self = shared_from_this(), most](error_code error, std::size_t bytes) {
                              if (error || bytes >= most) return self->close();
                              self->discard(most - bytes);
                            });
  }

  void listen() {
    streams_ = true;  // from now on, also while its header is under way
    ++server_.streams;
    error_code ignored;
    stream_.socket().set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
    header_.emplace();
    header_->version(11);
    set_headers(*header_);
    header_->set(http::field::content_type, "text/event-stream");
    header_->keep_alive(false);
    serializer_.emplace(*header_);
    stream_.expires_after(kRequestTime);
    http::async_write_header(stream_, *serializer_,
                             [self = shared_from_this()](error_code error, std::size_t) {
                               if (error) return self->close();
                               self->server_.listeners.insert(self);
                             });
  }

  void write_frame() {
    stream_.expires_after(kRequestTime);
    asio::async_write(stream_, asio::buffer(*queue_.front()),
                      [self = shared_from_this()](error_code error, std::size_t) {
                        if (error) return self->leave();
                        self->queue_.pop_front();
                        if (!self->queue_.empty()) self->write_frame();
                      });
  }

  void leave() {
    close();
    server_.listeners.erase(shared_from_this());
  }

  beast::tcp_stream stream_;
  Impl& server_;
  std::optional<std::pair<std::list<Connection*>*, std::list<Connection*>::iterator>> place_;
  bool streams_ = false;
  beast::flat_buffer buffer_{kMostHeader + kMostBody};
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> response_;
  std::optional<http::response<http::empty_body>> header_;
  std::optional<http::response_serializer<http::empty_body>> serializer_;
  std::deque<std::shared_ptr<const std::string>> queue_;
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
    if (make_room()) std::make_shared<Connection>(std::move(socket), *this)->read();
    accept();
  });
}

// First connections that have their last answer, then those without a request: a flood of such
// connections displaces itself, and a client that sends its request at once is answered in time.
bool HttpServer::Impl::make_room() {
  if (connections < kMostConnections) return true;
  for (const std::list<Connection*>* idle : {&leaving, &asking}) {
    if (idle->empty()) continue;
    idle->front()->close();
    return true;
  }
  return false;
}

HttpServer::HttpServer(const Options& options, const Pages& pages, const Access& access,
                       Served served)
    : impl_(std::make_unique<Impl>(pages, access, std::move(served))) {
  impl_->open(options);
}

HttpServer::~HttpServer() {
  for (const auto& listener : impl_->listeners) listener->close();
  impl_->listeners.clear();
}

std::uint16_t HttpServer::port() const { return impl_->acceptor.local_endpoint().port(); }

void HttpServer::run_for(std::chrono::milliseconds time) { impl_->io.run_for(time); }

std::size_t HttpServer::listeners() const { return impl_->listeners.size(); }

void HttpServer::broadcast(const std::string& json) {
  const auto frame = std::make_shared<const std::string>("data: " + json + "\n\n");
  const auto listeners = impl_->listeners;  // a copy: a dropped client leaves the set
  for (const auto& listener : listeners) listener->send(frame);
}

}  // namespace stillhand::dashboard
