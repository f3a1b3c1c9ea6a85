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

/// The parts of a request that decide its answer; empty if missing.
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

/// The outcome of a requested action.
struct Outcome {
  enum class Kind : std::uint8_t { kDone, kUnknown, kRefused, kTooMany };
  Kind kind = Kind::kDone;
  std::string why;  ///< reason, one line for a person; empty if done
};

/// What the server serves.
struct Served {
  /// Everything, as JSON.  @param at_s  [s] since the beginning of a recording; none: the newest
  std::function<std::string(std::optional<double> at_s)> snapshot;
  std::function<std::string()> timeline;  ///< of a recording, as JSON; empty on a bus
  /// Carries out the action of a path such as "/session/pause".
  /// @param text  a person's words for it: a reason or a note; mostly empty
  std::function<Outcome(std::string_view path, const std::string& text)> act;
};

/// The answer to any request, also a malformed one; uses no socket.
Answer answer(const Question& question, const Pages& pages, const Access& access,
              const Served& served);

}  // namespace stillhand::dashboard
