// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/http_connection.hpp"

#include <fmt/format.h>

#include <boost/asio/write.hpp>
#include <chrono>
#include <string_view>

#include "apps/dashboard/server/http_server.hpp"

namespace stillhand::dashboard {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::size_t kMostDiscarded = std::size_t{64} * 1024;
constexpr int kSendBuffer = 64 * 1024;
constexpr std::chrono::seconds kRequestTime{10};
constexpr std::chrono::seconds kLeaveTime{2};

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

HttpConnection::HttpConnection(tcp::socket socket, HttpClients& clients)
    : stream_(std::move(socket)), clients_(clients) {
  ++clients_.connections;
  error_code ignored;
  stream_.socket().set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
}

HttpConnection::~HttpConnection() {
  leave_list();
  if (streams_) --clients_.streams;
  --clients_.connections;
}

void HttpConnection::read() {
  join_list(known_ ? clients_.known : clients_.asking);
  parser_.emplace();
  parser_->header_limit(kMostHeader);
  parser_->body_limit(kMostBody);
  stream_.expires_after(kRequestTime);
  http::async_read(stream_, buffer_, *parser_,
                   [self = shared_from_this()](error_code error, std::size_t /*bytes*/) {
                     self->answer_read(error);
                   });
}

void HttpConnection::send(const std::shared_ptr<const std::string>& frame) {
  if (queue_.size() >= HttpServer::kMostQueued) return leave();
  queue_.push_back(frame);
  if (queue_.size() == 1) write_frame();
}

void HttpConnection::close() {
  leave_list();
  error_code ignored;
  stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
  stream_.close();
}

void HttpConnection::join_list(std::list<HttpConnection*>& list) {
  leave_list();
  place_.emplace(&list, list.insert(list.end(), this));
}

void HttpConnection::leave_list() {
  if (place_) place_->first->erase(place_->second);
  place_.reset();
}

void HttpConnection::answer_read(error_code error) {
  if (error == http::error::header_limit) return refuse(431, "a header of at most 8 KiB");
  if (error == http::error::body_limit) return refuse(413, "a body of at most 4 KiB");
  if (error && error.category() == http::make_error_code(http::error::bad_method).category() &&
      error != http::error::end_of_stream && error != http::error::partial_message) {
    return refuse(400, "HTTP/1.1");
  }
  if (error) return close();
  const auto& request = parser_->get();
  // Which of two would count is a matter of taste, and two programs on the way may differ.
  for (const http::field once :
       {http::field::host, http::field::origin, http::field::authorization, http::field::cookie}) {
    if (request.count(once) > 1) return refuse(400, "each header once");
  }
  const Question question{view(request.method_string()),
                          view(request.target()),
                          view(request[http::field::host]),
                          view(request[http::field::origin]),
                          view(request[http::field::authorization]),
                          view(request[http::field::cookie])};
  known_ = clients_.access.allows(
      {question.host, question.origin, question.authorization, question.cookie, {}});
  const Answer found = answer(question, clients_.pages, clients_.access, clients_.served);
  // Who is refused asks nothing more.
  if (!found.streams) return respond(found, request.keep_alive() && known_);
  if (clients_.streams < HttpServer::kMostListeners) return listen();
  Answer full;
  full.status = 503;
  full.body =
      fmt::format("too many open pages: at most {} can listen\n", HttpServer::kMostListeners);
  respond(full, false);
}

void HttpConnection::refuse(unsigned status, const char* want) {
  Answer refusal;
  refusal.status = status;
  refusal.body = fmt::format("want {}\n", want);
  respond(refusal, false);
}

void HttpConnection::respond(const Answer& found, bool keep_alive) {
  join_list(clients_.answering);
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
                      self->join_list(self->clients_.leaving);
                      self->stream_.expires_after(kLeaveTime);
                      self->discard(kMostDiscarded);
                    });
}

// Closed with something unread, TCP would take back the answer that says why.
void HttpConnection::discard(std::size_t most) {
  buffer_.clear();
  stream_.async_read_some(buffer_.prepare(kMostBody),
                          [self = shared_from_this(), most](error_code error, std::size_t bytes) {
                            if (error || bytes >= most) return self->close();
                            self->discard(most - bytes);
                          });
}

void HttpConnection::listen() {
  leave_list();
  streams_ = true;  // from now on, also while its header is under way
  ++clients_.streams;
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
                             self->clients_.listeners.insert(self);
                           });
}

void HttpConnection::write_frame() {
  stream_.expires_after(kRequestTime);
  asio::async_write(stream_, asio::buffer(*queue_.front()),
                    [self = shared_from_this()](error_code error, std::size_t) {
                      if (error) return self->leave();
                      self->queue_.pop_front();
                      if (!self->queue_.empty()) self->write_frame();
                    });
}

void HttpConnection::leave() {
  close();
  clients_.listeners.erase(shared_from_this());
}

}  // namespace stillhand::dashboard
