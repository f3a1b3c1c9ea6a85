// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>

#include "apps/dashboard/server/routes.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/folder.hpp"

// Requests that are right, spoilt by a seeded generator: each has an answer that this page may
// give, none without the token, and no file but the page's own is in any.

namespace stillhand::dashboard::request_fuzz_test {

using Random = std::mt19937;

const std::string kToken = "0123456789abcdef";
constexpr int kRequests = 60'000;

std::size_t below(Random& random, std::size_t limit) {
  return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
}

template <typename Container>
const auto& one_of(const Container& all, Random& random) {
  return all[below(random, all.size())];
}

/// The fields of a request, as text that can be spoilt.
struct Spoilt {
  std::string method, target, host, origin, authorization, cookie;
};

void spoil(std::string& text, Random& random) {
  static const std::array<std::string, 16> kPieces{
      "..",      "/../", "%2e%2e%2f", "\\",   std::string(1, '\0'),
      "?",       "&",    "token=",    kToken, ";",
      "Bearer ", "//",   "\r\n",      "%",    "\xff",
      "secret"};
  const std::size_t at = below(random, text.size() + 1);
  switch (below(random, 6)) {
    case 0:
      text.insert(at, one_of(kPieces, random));
      break;
    case 1:
      text.erase(at, 1 + below(random, 4));
      break;
    case 2:
      if (at < text.size()) text[at] = static_cast<char>(below(random, 256));
      break;
    case 3:
      text.resize(at);
      break;
    case 4:
      text += text;
      break;
    default:
      text = one_of(kPieces, random) + text.substr(at);
  }
}

Spoilt request(Random& random, const Access& cookies) {
  static const std::array<std::string, 4> kMethods{"GET", "POST", "HEAD", "OPTIONS"};
  static const std::array<std::string, 11> kTargets{"/",
                                                    "/snapshot",
                                                    "/snapshot?at=12.5",
                                                    "/events",
                                                    "/acknowledge",
                                                    "/timeline",
                                                    "/../../secret",
                                                    "/?token=" + kToken,
                                                    "/%2e%2e/etc/passwd",
                                                    "/session/pause",
                                                    "/main.js"};
  static const std::array<std::string, 5> kHosts{"127.0.0.1", "localhost:8340", "[::1]:1", "lab",
                                                 ""};
  Spoilt all{
      one_of(kMethods, random), one_of(kTargets, random), one_of(kHosts, random), "", "", ""};
  if (below(random, 3) == 0) all.origin = "http://" + one_of(kHosts, random);
  if (below(random, 3) == 0) all.authorization = "Bearer " + kToken;
  if (below(random, 3) == 0) {
    all.cookie = "a=b; " + cookies.cookie({all.host, "", "", "", "token=" + kToken});
  }
  for (std::string* text :
       {&all.method, &all.target, &all.host, &all.origin, &all.authorization, &all.cookie}) {
    for (std::size_t times = below(random, 3); times > 0; --times) spoil(*text, random);
  }
  return all;
}

class RequestFuzzTest : public ::testing::Test {
 protected:
  RequestFuzzTest() {
    const std::filesystem::path page = folder_ / "page";
    std::filesystem::create_directories(page);
    for (const char* file : {"index.html", "style.css", "main.js", "uPlot.esm.js"}) {
      std::ofstream(page / file) << "page's own " << file;
    }
    pages_.emplace(page);
    std::ofstream(folder_ / "secret") << "secret";
    std::ofstream(page / "secret") << "secret";
  }

  /// @returns its status
  unsigned ask(const Spoilt& all, const Access& access) {
    const int acted_before = acted_;
    const Answer got =
        answer({all.method, all.target, all.host, all.origin, all.authorization, all.cookie},
               *pages_, access, served_);
    const bool known = got.streams || got.body.empty() || got.body == "{}" ||
                       got.body.starts_with("page's own ") || got.body.ends_with("\n");
    EXPECT_TRUE(known) << got.body;
    EXPECT_LT(got.body.size(), 200u);
    EXPECT_EQ(got.body.find("secret"), std::string::npos) << all.target;
    const std::set<unsigned> may{200, 204, 303, 400, 403, 404, 405, 409};
    EXPECT_TRUE(may.contains(got.status)) << got.status;
    EXPECT_TRUE(got.location.empty() || got.location == "/") << got.location;
    EXPECT_TRUE(got.cookie.empty() || got.status == 303);
    EXPECT_TRUE(acted_ == acted_before || all.method == "POST") << all.method;
    EXPECT_TRUE(acted_ == acted_before || all.origin.empty() ||
                all.origin == "http://" + all.host || all.origin == "https://" + all.host)
        << all.origin << " of " << all.host;
    return got.status;
  }

  const support::Folder folder_;
  std::optional<Pages> pages_;
  int acted_ = 0;
  Served served_{[](std::optional<double> /*at_s*/) { return std::string("{}"); },
                 [] { return std::string("{}"); },
                 [this](std::string_view path, const std::string&) -> Outcome {
                   ++acted_;
                   if (path != "/acknowledge") return {Outcome::Kind::kUnknown, ""};
                   return {};
                 }};
};

TEST_F(RequestFuzzTest, NobodyGetsInWithoutTheToken) {
  Random random(8);
  const Access sut(kToken);
  const std::string cookie = sut.cookie({"lab", "", "", "", "token=" + kToken});
  const std::string word = cookie.substr(cookie.find('=') + 1, 64);
  int refused = 0, let_in = 0;
  for (int i = 0; i < kRequests; ++i) {
    const Spoilt all = request(random, sut);
    const std::string sent = all.authorization + '\n' + all.cookie + '\n' + all.target;
    const bool shown =
        sent.find(kToken) != std::string::npos || all.cookie.find(word) != std::string::npos;
    const unsigned status = ask(all, sut);
    ASSERT_TRUE(shown || status == 403) << status << " for " << all.target;
    (status == 403 ? refused : let_in) += 1;
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(let_in, 1000);
  EXPECT_GT(acted_, 100);
}

TEST_F(RequestFuzzTest, OnLoopbackNobodyGetsInByAnotherName) {
  Random random(9);
  const Access sut(""), with_cookies(kToken);
  int refused = 0, let_in = 0;
  for (int i = 0; i < kRequests; ++i) {
    const Spoilt all = request(random, with_cookies);
    const bool loopback = all.host.starts_with("127.0.0.1") || all.host.starts_with("localhost") ||
                          all.host.starts_with("[::1]");
    const unsigned status = ask(all, sut);
    ASSERT_TRUE(loopback || status == 403) << status << " for " << all.host;
    ASSERT_NE(status, 303u) << "signed in with a token where there is none";
    (status == 403 ? refused : let_in) += 1;
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(let_in, 1000);
}

TEST_F(RequestFuzzTest, ATokenFileIsATokenOrRefusedInOneLine) {
  Random random(10);
  const std::string file = folder_ / "token";
  int taken = 0, refused = 0;
  for (int i = 0; i < 2'000; ++i) {
    std::string text = kToken + (i % 2 == 0 ? "\n" : "");
    for (std::size_t times = below(random, 3); times > 0; --times) spoil(text, random);
    std::ofstream(file, std::ios::trunc | std::ios::binary) << text;
    chmod(file.c_str(), 0600);
    try {
      const std::string token = read_token("--token-file", file);
      ASSERT_GE(token.size(), 16u);
      ASSERT_LE(token.size(), 256u);
      ASSERT_TRUE(std::ranges::all_of(token, [](unsigned char c) {
        return c < 128 && (std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.');
      })) << token;
      ASSERT_TRUE(text.starts_with(token));
      ++taken;
    } catch (const ConfigError& error) {
      ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GT(taken, 200);
  EXPECT_GT(refused, 200);
}

}  // namespace stillhand::dashboard::request_fuzz_test
