// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cstddef>
#include <deque>
#include <list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "apps/dashboard/server/routes.hpp"

namespace stillhand::dashboard {

class HttpConnection;

/// The clients of a server, and what they are served with.
struct HttpClients {
  const Pages& pages;
  const Access& access;
  Served served;
  std::size_t connections = 0;
  std::size_t streams = 0;  ///< connections of the event stream
  /// Every connection but those of the event stream is in one of these, from its first moment. When
  /// all are taken, they are closed in this order, the oldest first: those that have their last
  /// answer and stay open, those that do not take their answer, those without a complete request,
  /// and those that wait for the next request of a client that may see the page.
  std::list<HttpConnection*> leaving = {}, answering = {}, asking = {}, known = {};
  std::set<std::shared_ptr<HttpConnection>> listeners = {};
};

/// One client; lives as long as an operation of it does, or as it listens.  In the thread that runs
/// its socket's context.  Header, body, time for a request and waiting frames have bounds; a client
/// that exceeds one gets an answer or is dropped.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  /// @param clients  outlives it
  HttpConnection(boost::asio::ip::tcp::socket socket, HttpClients& clients);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  /// Waits for a request and answers it.
  void read();
  /// To a listener; one with HttpServer::kMostQueued waiting frames is dropped.
  void send(const std::shared_ptr<const std::string>& frame);
  void close();

 private:
  static constexpr std::size_t kMostHeader = 8192;
  static constexpr std::size_t kMostBody = 4096;

  void join_list(std::list<HttpConnection*>& list);
  void leave_list();
  void answer_read(boost::system::error_code error);
  void refuse(unsigned status, const char* want);
  void respond(const Answer& found, bool keep_alive);
  void discard(std::size_t most);
  void listen();
  void write_frame();
  void leave();

  boost::beast::tcp_stream stream_;
  HttpClients& clients_;
  std::optional<std::pair<std::list<HttpConnection*>*, std::list<HttpConnection*>::iterator>>
      place_;
  bool streams_ = false;
  bool known_ = false;  ///< its newest request may see the page
  boost::beast::flat_buffer buffer_{kMostHeader + kMostBody};
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
  boost::beast::http::response<boost::beast::http::string_body> response_;
  std::optional<boost::beast::http::response<boost::beast::http::empty_body>> header_;
  std::optional<boost::beast::http::response_serializer<boost::beast::http::empty_body>>
      serializer_;
  std::deque<std::shared_ptr<const std::string>> queue_;
};

}  // namespace stillhand::dashboard
