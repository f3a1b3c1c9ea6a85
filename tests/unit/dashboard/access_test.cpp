// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/access.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "services/core/contract/config_error.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::dashboard::access_test {

const std::string kToken = "0123456789abcdef-ABC_x.y";

/// Name and value of the cookie for a token.
std::string pair(const Access& access, std::string_view host, const std::string& token = kToken) {
  const std::string query = "token=" + token;
  const std::string cookie = access.cookie({host, "", "", "", query});
  return cookie.substr(0, cookie.find(';'));
}

TEST(AccessTest, LoopbackIsForWhoNamesItSo) {
  const Access sut("");
  for (const char* host : {"127.0.0.1", "127.0.0.1:8340", "localhost:8340", "[::1]:8340"}) {
    EXPECT_TRUE(sut.allows({host, "", "", "", ""})) << host;
  }
  // A name of the world that was pointed at 127.0.0.1.
  for (const char* host :
       {"", "evil.example:8340", "127.0.0.1.evil.example", "localhost.evil", "["}) {
    EXPECT_FALSE(sut.allows({host, "", "", "", ""})) << host;
  }
}

TEST(AccessTest, APageOfAnotherSiteChangesNothing) {
  const Access sut("");
  EXPECT_TRUE(sut.allows_change({"127.0.0.1:8340", "", "", "", ""}));
  EXPECT_TRUE(sut.allows_change({"127.0.0.1:8340", "http://127.0.0.1:8340", "", "", ""}));
  EXPECT_FALSE(sut.allows_change({"127.0.0.1:8340", "http://evil.example", "", "", ""}));
  EXPECT_FALSE(sut.allows_change({"127.0.0.1:8340", "http://127.0.0.1:8341", "", "", ""}));
}

TEST(AccessTest, WithATokenItIsTheTokenThatCounts) {
  const Access sut(kToken);
  const std::string cookie = "a=b; " + pair(sut, "lab.example");
  EXPECT_TRUE(sut.allows({"lab.example", "", "Bearer " + kToken, "", ""}));
  EXPECT_TRUE(sut.allows({"lab.example", "", "", cookie, ""}));
  EXPECT_FALSE(sut.allows({"127.0.0.1", "", "", "", ""}));
  EXPECT_FALSE(sut.allows({"", "", "", "stillhand_token=" + kToken, ""}));  // no cookie is a token
  for (const std::string& wrong :
       {std::string(), kToken + "x", kToken.substr(1), kToken.substr(0, 5),
        std::string(kToken.size(), 'a'), " " + kToken}) {
    EXPECT_FALSE(sut.allows({"", "", "Bearer " + wrong, "", ""})) << wrong;
    EXPECT_FALSE(sut.allows({"", "", "", "stillhand_token=" + wrong, ""})) << wrong;
    EXPECT_FALSE(sut.signs_in({"", "", "", "", "token=" + wrong})) << wrong;
  }
  EXPECT_FALSE(sut.allows({"", "", "Bearer wrong", cookie, ""}));  // what it shows first counts
  EXPECT_TRUE(sut.signs_in({"", "", "", "", "x=1&token=" + kToken}));
}

TEST(AccessTest, TwoDashboardsOfAHostHaveACookieEach) {
  const Access sut(kToken), other(std::string(20, 'b'));
  const std::string of_other = pair(other, "lab:8341", std::string(20, 'b'));
  const std::string word = pair(sut, "lab").substr(std::string("stillhand_token=").size());
  EXPECT_EQ(word.size(), 64u);
  EXPECT_EQ(pair(sut, "lab:8340"), "stillhand_token_8340=" + word);
  EXPECT_EQ(pair(sut, "[::1]:8340"), "stillhand_token_8340=" + word);
  const std::string both = pair(sut, "lab:8340") + "; " + of_other;
  EXPECT_TRUE(sut.allows({"lab:8340", "", "", both, ""}));
  EXPECT_TRUE(other.allows({"lab:8341", "", "", both, ""}));
  EXPECT_FALSE(sut.allows({"lab:8341", "", "", both, ""}));
  // Nothing of a name but digits goes into a header.
  for (const char* host : {"lab:", "lab:80;x", "lab:a", "lab: 1", "[::1", "lab:1\r\n"}) {
    EXPECT_EQ(pair(sut, host), "stillhand_token=" + word) << host;
  }
}

// Who reads a cookie has no token, and each process gives cookies of its own.
TEST(AccessTest, ACookieIsNotTheTokenAndEndsWithTheProcess) {
  const Access sut(kToken), again(kToken);
  EXPECT_EQ(pair(sut, "lab").find(kToken), std::string::npos);
  EXPECT_TRUE(sut.allows({"lab", "", "", pair(sut, "lab"), ""}));
  EXPECT_FALSE(again.allows({"lab", "", "", pair(sut, "lab"), ""}));
  const std::string word = pair(sut, "lab").substr(std::string("stillhand_token=").size());
  EXPECT_FALSE(sut.allows({"lab", "", "Bearer " + word, "", ""}));
  EXPECT_FALSE(sut.signs_in({"lab", "", "", "", "token=" + word}));
}

TEST(AccessTest, TheWatchingTokenShowsAndCanOnlyStop) {
  const std::string watching = "watch-0123456789abcdef";
  const Access sut(kToken, watching);
  for (const std::string& cookie : {pair(sut, "lab", watching), std::string()}) {
    const std::string bearer = cookie.empty() ? "Bearer " + watching : "";
    const Access::Request request{"lab", "", bearer, cookie, ""};
    EXPECT_TRUE(sut.allows(request));
    EXPECT_TRUE(sut.only_watches(request));
    EXPECT_FALSE(sut.allows_change(request));
    EXPECT_TRUE(sut.allows_emergency_stop(request));
    Access::Request elsewhere = request;
    elsewhere.origin = "http://evil.example";
    EXPECT_FALSE(sut.allows_emergency_stop(elsewhere));
  }
  EXPECT_FALSE(sut.allows_emergency_stop({"lab", "", "", "", ""}));
  const std::string acting = pair(sut, "lab", kToken);
  const Access::Request acts{"lab", "", "", acting, ""};
  EXPECT_TRUE(sut.allows_change(acts));
  EXPECT_FALSE(sut.only_watches(acts));
  EXPECT_NE(pair(sut, "lab", watching), pair(sut, "lab", kToken));
  // Without a watching token, an empty word is none.
  EXPECT_FALSE(Access(kToken).allows({"lab", "", "Bearer ", "stillhand_token=", ""}));
}

TEST(AccessTest, WithoutATokenNoneIsRight) {
  const Access sut("");
  EXPECT_FALSE(sut.signs_in({"", "", "", "", "token="}));
  EXPECT_FALSE(sut.signs_in({"", "", "", "", ""}));
}

class TokenFileTest : public ::testing::Test {
 protected:
  void write(const std::string& text, mode_t mode = 0600) {
    std::filesystem::remove(file_);
    std::ofstream(file_) << text;
    chmod(file_.c_str(), mode);
  }

  const support::Folder folder_;
  const std::string file_ = folder_ / "token";
};

TEST_F(TokenFileTest, ATokenIsOneLine) {
  write(kToken + "\n");
  EXPECT_EQ(read_token("--token-file", file_), kToken);
}

TEST_F(TokenFileTest, WhatIsNoSecretIsRefused) {
  for (const std::string& text : {std::string(), std::string("short"), kToken + "\n" + kToken,
                                  kToken + " ", kToken + ";", std::string(257, 'a')}) {
    write(text);
    EXPECT_THROW(read_token("--token-file", file_), ConfigError) << text;
  }
  write(kToken, 0644);
  EXPECT_THROW(read_token("--token-file", file_), ConfigError);
  EXPECT_THROW(read_token("--token-file", "/dev/zero"), ConfigError);
  std::filesystem::remove(file_);
  EXPECT_THROW(read_token("--token-file", file_), ConfigError);
}

}  // namespace stillhand::dashboard::access_test
