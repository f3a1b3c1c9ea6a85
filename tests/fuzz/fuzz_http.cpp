// SPDX-License-Identifier: Apache-2.0
// Requests to the dashboard: Boost.Beast's parser with the limits of a connection, then the routes
// with their tokens.
#include <unistd.h>

#include <boost/asio/buffer.hpp>
#include <boost/beast/http.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "apps/dashboard/server/routes.hpp"

namespace {

// Pages need their files; what they hold does not matter here.
stillhand::dashboard::Pages empty_pages() {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("fuzz_http." + std::to_string(getpid()));
  fs::create_directories(folder);
  for (const char* name : {"index.html", "main.js", "uPlot.esm.js"}) std::ofstream(folder / name);
  stillhand::dashboard::Pages pages(folder);
  fs::remove_all(folder);
  return pages;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace stillhand::dashboard;
  namespace http = boost::beast::http;
  static const Pages pages = empty_pages();
  static const Access access("token-to-act", "token-to-watch");
  bool acted = false;
  bool stopped = false;
  const Served served{[](std::optional<double>) { return std::string("{}"); },
                      [] { return std::string("{}"); },
                      [&](std::string_view path, const std::string&) {
                        (path == "/emergency-stop" ? stopped : acted) = true;
                        return Outcome{};
                      }};
  http::request_parser<http::string_body> parser;
  parser.header_limit(8192);  // HttpConnection::kMostHeader, kMostBody
  parser.body_limit(4096);
  parser.eager(true);
  boost::system::error_code error;
  parser.put(boost::asio::buffer(bytes, size), error);
  if (error || !parser.is_done()) return 0;
  const auto& request = parser.get();
  const auto view = [](auto text) { return std::string_view(text.data(), text.size()); };
  answer({view(request.method_string()), view(request.target()), view(request[http::field::host]),
          view(request[http::field::origin]), view(request[http::field::authorization]),
          view(request[http::field::cookie])},
         pages, access, served);
  // No request acts that does not show the token for it.
  const std::string_view all(reinterpret_cast<const char*>(bytes), size);
  const bool may_act = all.find("token-to-act") != std::string_view::npos;
  const bool may_stop = may_act || all.find("token-to-watch") != std::string_view::npos;
  if ((acted && !may_act) || (stopped && !may_stop)) std::abort();
  return 0;
}
