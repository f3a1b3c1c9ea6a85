// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/http_server.hpp"

#include <gtest/gtest.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <deque>
#include <fstream>
#include <optional>
#include <vector>

#include "tests/support/folder.hpp"

namespace stillhand::dashboard::http_server_test {

using boost::asio::ip::tcp;
using boost::system::error_code;

const std::string kToken = "0123456789abcdef";
const std::string kRefused = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
const std::string kSignedIn = "Host: localhost\r\nAuthorization: Bearer " + kToken + "\r\n\r\n";
const std::string kStop = "POST /emergency-stop HTTP/1.1\r\n" + kSignedIn;

/// A server with a token, on loopback, and its clients in the same thread.
class HttpServerTest : public ::testing::Test {
 protected:
  HttpServerTest() {
    for (const char* file : {"index.html", "main.js", "uPlot.esm.js"}) {
      std::ofstream(folder_ / file) << std::string(100'000, 'x');
    }
    pages_.emplace(folder_);
    sut_.emplace(HttpServer::Options{}, *pages_, access_, Served{{}, {}, [this](auto, const auto&) {
                                                                   ++stops_;
                                                                   return Outcome{};
                                                                 }});
  }

  tcp::socket& client() {
    clients_.emplace_back(io_, tcp::v4());
    clients_.back().set_option(boost::asio::socket_base::receive_buffer_size(4096));
    clients_.back().connect({boost::asio::ip::address_v4::loopback(), sut_->port()});
    clients_.back().non_blocking(true);
    return clients_.back();
  }
  /// The server answers what it can until the condition holds; false after a limit.
  template <typename Condition>
  bool until(const Condition& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      sut_->run_for(std::chrono::milliseconds(1));
    }
    return true;
  }
  /// What the client got, until the server closes its side or `end` is there.
  std::string answer(tcp::socket& from, const std::string& end) {
    std::string all;
    until([&] {
      std::array<char, 4096> part{};
      error_code error;
      const std::size_t size = from.read_some(boost::asio::buffer(part), error);
      all.append(part.data(), size);
      return all.find(end) != std::string::npos ||
             (error && error != boost::asio::error::would_block);
    });
    return all;
  }
  /// As many clients as there are places ask again and again and take no answer, until the server
  /// takes no request any more.
  void pipeline(const std::string& each) {
    std::string request;
    for (int i = 0; i < 200; ++i) request += each;
    const std::size_t first = clients_.size();
    for (std::size_t i = 0; i < HttpServer::kMostConnections; ++i) client();
    std::vector<std::size_t> sent(HttpServer::kMostConnections);
    const auto all_block = [&] {
      std::size_t more = 0;
      for (std::size_t i = 0; i < sent.size(); ++i) {
        error_code error;
        const auto rest = boost::asio::buffer(request) + sent[i] % request.size();
        const std::size_t size = clients_[first + i].write_some(rest, error);
        sent[i] += size;
        more += size;
      }
      return more == 0;
    };
    ASSERT_TRUE(until(all_block));
  }

  const support::Folder folder_;
  std::optional<Pages> pages_;
  Access access_{kToken};
  int stops_ = 0;
  std::optional<HttpServer> sut_;
  boost::asio::io_context io_;
  std::deque<tcp::socket> clients_;
};

TEST_F(HttpServerTest, WhoIsRefusedIsClosed) {
  tcp::socket& stranger = client();
  boost::asio::write(stranger, boost::asio::buffer(kRefused + kRefused));
  const std::string all = answer(stranger, "never");  // to the end of the connection
  EXPECT_EQ(all.find("HTTP/1.1 403"), 0U);
  EXPECT_EQ(all.find("HTTP/1.1", 1), std::string::npos) << "one answer";
}

TEST_F(HttpServerTest, AHeaderThatComesTwiceIsRefused) {
  for (const std::string twice : {"Host: evil\r\n", "Authorization: Bearer x\r\n"}) {
    tcp::socket& stranger = client();
    boost::asio::write(stranger, boost::asio::buffer("GET / HTTP/1.1\r\n" + twice + kSignedIn));
    EXPECT_EQ(answer(stranger, "never").find("HTTP/1.1 400"), 0U) << twice;
  }
}

TEST_F(HttpServerTest, StrangersThatAskAndNeverReadKeepNoStopOut) {
  pipeline(kRefused);
  tcp::socket& person = client();
  boost::asio::write(person, boost::asio::buffer(kStop));
  EXPECT_EQ(answer(person, "\r\n\r\n").find("HTTP/1.1 204"), 0U);
  EXPECT_EQ(stops_, 1);
}

TEST_F(HttpServerTest, AClientThatTakesNoAnswerIsDisplaced) {
  pipeline("GET / HTTP/1.1\r\n" + kSignedIn);
  tcp::socket& person = client();
  boost::asio::write(person, boost::asio::buffer(kStop));
  EXPECT_EQ(answer(person, "\r\n\r\n").find("HTTP/1.1 204"), 0U);
  EXPECT_EQ(stops_, 1);
}

TEST_F(HttpServerTest, AConnectionThatWasSignedInOutlivesStrangers) {
  tcp::socket& person = client();
  boost::asio::write(person, boost::asio::buffer("GET /nothing HTTP/1.1\r\n" + kSignedIn));
  ASSERT_EQ(answer(person, "unknown page\n").find("HTTP/1.1 404"), 0U);
  for (std::size_t i = 0; i < 3 * HttpServer::kMostConnections; ++i) client();
  // The first stranger is displaced when the last ones have come in.
  answer(clients_[1], "never");
  boost::asio::write(person, boost::asio::buffer(kStop));
  EXPECT_EQ(answer(person, "\r\n\r\n").find("HTTP/1.1 204"), 0U);
  EXPECT_EQ(stops_, 1);
}

}  // namespace stillhand::dashboard::http_server_test
