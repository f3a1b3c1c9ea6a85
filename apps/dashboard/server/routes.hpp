// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "apps/dashboard/server/access.hpp"
#include "apps/dashboard/server/pages.hpp"

namespace stillhand::dashboard {

/// What of a request decides about its answer; empty where it has none.
struct Question {
  std::string_view method, target, host, origin, authorization, cookie;
};

struct Answer {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::string location, cookie;  ///< headers, where not empty
  bool streams = false;          ///< no body: server-sent events from now on
};

/// What became of an action that was asked for.
struct Outcome {
  enum class Kind : std::uint8_t { kDone, kUnknown, kRefused, kTooMany };
  Kind kind = Kind::kDone;
  std::string why;  ///< one line for a person, where it was not done
};

/// What the server can be asked for.
struct Served {
  /// Whole, as JSON.  @param at_s  [s] since the beginning of a recording; none: the newest
  std::function<std::string(std::optional<double> at_s)> snapshot;
  std::function<std::string()> timeline;  ///< of a recording, as JSON; empty on a bus
  /// Does what a path asks for, "/session/pause" and the like.
  std::function<Outcome(std::string_view path)> act;
};

/// The answer to any request, however odd; without a socket.
Answer answer(const Question& question, const Pages& pages, const Access& access,
              const Served& served);

}  // namespace stillhand::dashboard
