// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/routes.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "services/core/contract/config_error.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::dashboard::routes_test {

const std::string kToken = "0123456789abcdef";

class RoutesTest : public ::testing::Test {
 protected:
  RoutesTest() {
    for (const char* file : {"index.html", "style.css", "main.js", "status.js", "tables.js",
                             "charts.js", "uPlot.esm.js", "uPlot.min.css"}) {
      std::ofstream(folder_ / file) << file;
    }
    std::ofstream(folder_ / "secret") << "secret";
    pages_.emplace(folder_);
  }

  Answer ask(std::string_view method, std::string_view target, std::string_view origin = "") {
    return answer({method, target, "127.0.0.1", origin, "", ""}, *pages_, loopback_, served_);
  }

  const support::Folder folder_;
  std::optional<Pages> pages_;
  Outcome act(std::string_view path, const std::string& text) {
    text_ = text;
    if (path == "/session/stop") return {Outcome::Kind::kRefused, "nobody listens"};
    if (path == "/session/start") return {Outcome::Kind::kTooMany, "not so fast"};
    if (path != "/acknowledge") return {Outcome::Kind::kUnknown, ""};
    ++acknowledged_;
    return {};
  }
  int acknowledged_ = 0;
  std::string text_;
  std::optional<double> at_s_;
  Served served_{
      [this](std::optional<double> at_s) {
        at_s_ = at_s;
        return std::string("{}");
      },
      {},
      [this](std::string_view path, const std::string& text) { return act(path, text); }};
  Access loopback_{""}, token_{kToken};
};

TEST_F(RoutesTest, ThePageAndItsPartsAreThere) {
  EXPECT_EQ(ask("GET", "/").body, "index.html");
  EXPECT_EQ(ask("GET", "/?x=1").body, "index.html");
  EXPECT_EQ(ask("GET", "/main.js").type, "text/javascript; charset=utf-8");
  EXPECT_EQ(ask("GET", "/snapshot").body, "{}");
  EXPECT_EQ(ask("GET", "/snapshot").type, "application/json");
  EXPECT_TRUE(ask("GET", "/events").streams);
}

TEST_F(RoutesTest, ARecordingIsAskedForItsTimeLineAndForAnyInstant) {
  EXPECT_EQ(ask("GET", "/timeline").status, 404u);
  EXPECT_EQ(ask("GET", "/snapshot?at=1").status, 404u);  // a bus has no past
  served_.timeline = [] { return std::string("[]"); };
  EXPECT_EQ(ask("GET", "/timeline").body, "[]");
  EXPECT_EQ(ask("GET", "/snapshot?at=12.25").status, 200u);
  EXPECT_EQ(at_s_, 12.25);
  EXPECT_EQ(ask("GET", "/snapshot").status, 200u);
  EXPECT_EQ(at_s_, std::nullopt);
  for (const char* at : {"", "x", "1x", "nan", "inf", "1e999", "1&at=2"}) {
    EXPECT_EQ(ask("GET", std::string("/snapshot?at=") + at).status, 400u) << at;
  }
  EXPECT_EQ(at_s_, std::nullopt);
}

TEST_F(RoutesTest, ARecordingThatCannotBeReadAnyLongerIsAnAnswerOfItsOwn) {
  served_.timeline = [] { return std::string("[]"); };
  served_.snapshot = [](std::optional<double>) -> std::string {
    throw std::runtime_error("run.mcap: the file became shorter");
  };
  const Answer told = ask("GET", "/snapshot?at=12");
  EXPECT_EQ(told.status, 500u);
  EXPECT_EQ(told.body, "run.mcap: the file became shorter\n");
}

TEST_F(RoutesTest, NoPathLeadsAnywhereElse) {
  for (const char* target :
       {"/secret", "/../secret", "/..%2fsecret", "//etc/passwd", "/./main.js", "/main.js/",
        "main.js", "", "*", "http://127.0.0.1/", "/%00", "/\\..\\secret"}) {
    EXPECT_EQ(ask("GET", target).status, 404u) << target;
  }
}

TEST_F(RoutesTest, OnlyAPostOfOnesOwnAcknowledges) {
  EXPECT_EQ(ask("GET", "/acknowledge").status, 404u);
  EXPECT_EQ(ask("POST", "/acknowledge", "http://evil.example").status, 403u);
  EXPECT_EQ(ask("POST", "/").status, 404u);
  EXPECT_EQ(ask("DELETE", "/").status, 405u);
  EXPECT_EQ(acknowledged_, 0);
  EXPECT_EQ(ask("POST", "/acknowledge", "http://127.0.0.1").status, 204u);
  EXPECT_EQ(acknowledged_, 1);
}

TEST_F(RoutesTest, AnActionThatCouldNotBeAskedSaysWhy) {
  const Answer refused = ask("POST", "/session/stop");
  EXPECT_EQ(refused.status, 409u);
  EXPECT_EQ(refused.body, "nobody listens\n");
  const Answer later = ask("POST", "/session/start");
  EXPECT_EQ(later.status, 429u);
  EXPECT_EQ(later.body, "not so fast\n");
}

TEST_F(RoutesTest, AReasonArrivesAsItWasTyped) {
  ask("POST", "/session/repeat?text=he%20coughed%2C%20100%25");
  EXPECT_EQ(text_, "he coughed, 100%");
  ask("POST", "/session/start");
  EXPECT_EQ(text_, "");
  for (const char* target : {"/session/note?text=%", "/session/note?text=%4",
                             "/session/note?text=%zz", "/session/note?text=a%+1"}) {
    EXPECT_EQ(ask("POST", target).status, 400u) << target;
  }
}

TEST_F(RoutesTest, NothingBehindItsPathKeepsAnEmergencyStopFromBeingAsked) {
  EXPECT_EQ(ask("POST", "/emergency-stop?text=%zz").status, ask("POST", "/emergency-stop").status);
}

TEST_F(RoutesTest, TheTokenGoesFromTheAddressIntoACookie) {
  const auto of = [&](std::string_view target, std::string_view cookie) {
    return answer({"GET", target, "lab", "", "", cookie}, *pages_, token_, served_);
  };
  EXPECT_EQ(of("/", "").status, 403u);
  EXPECT_EQ(of("/?token=wrong", "").status, 403u);
  EXPECT_EQ(of("/snapshot?token=" + kToken, "").status, 403u);  // there it would stay in logs
  const Answer signed_in = of("/?token=" + kToken, "");
  EXPECT_EQ(signed_in.status, 303u);
  EXPECT_EQ(signed_in.location, "/");
  EXPECT_EQ(signed_in.cookie.find(kToken), std::string::npos);
  EXPECT_EQ(of("/events", signed_in.cookie).status, 200u);
}

TEST_F(RoutesTest, WhoWatchesIsShownThePageAndCanOnlyStop) {
  const Access both(kToken, "watching-0123456789");
  const auto of = [&](std::string_view method, std::string_view target, std::string_view cookie) {
    return answer({method, target, "lab", "", "", cookie}, *pages_, both, served_);
  };
  const std::string watching = of("GET", "/?token=watching-0123456789", "").cookie;
  const std::string acting = of("GET", "/?token=" + kToken, "").cookie;
  EXPECT_EQ(of("GET", "/snapshot", watching).status, 200u);
  const Answer refused = of("POST", "/acknowledge", watching);
  EXPECT_EQ(refused.status, 403u);
  EXPECT_EQ(refused.body,
            "signed in with the token for watching, which can stop and nothing else\n");
  EXPECT_EQ(acknowledged_, 0);
  EXPECT_EQ(of("POST", "/emergency-stop", watching).status,
            of("POST", "/emergency-stop", acting).status);
  EXPECT_NE(of("POST", "/emergency-stop", watching).status, 403u);
  EXPECT_EQ(of("POST", "/emergency-stop", "").status, 403u);
  EXPECT_EQ(of("POST", "/acknowledge", acting).status, 204u);
  EXPECT_EQ(acknowledged_, 1);
}

TEST_F(RoutesTest, EveryRequestOfRandomBytesHasAnAnswerAndDoesNothing) {
  std::mt19937 random(3);
  for (int i = 0; i < 20'000; ++i) {
    const auto text = [&] {
      std::string any(random() % 40, '\0');
      for (char& c : any) c = static_cast<char>(random() % 256);
      if (random() % 4 == 0) any.insert(0, "/?token=");
      if (random() % 4 == 0) any.insert(0, "stillhand_token=;");
      return any;
    };
    const std::string target = text(), host = text(), cookie = text(), authorization = text();
    const Answer got =
        answer({random() % 2 == 0 ? "GET" : "POST", target, host, text(), authorization, cookie},
               *pages_, random() % 2 == 0 ? loopback_ : token_, served_);
    EXPECT_TRUE(got.status == 403 || got.status == 404) << got.status;
  }
  EXPECT_EQ(acknowledged_, 0);
}

TEST_F(RoutesTest, AFolderWithoutAFileOfThePageIsRefused) {
  std::filesystem::remove(folder_ / "uPlot.esm.js");
  EXPECT_THROW(Pages{folder_}, ConfigError);
}

}  // namespace stillhand::dashboard::routes_test
