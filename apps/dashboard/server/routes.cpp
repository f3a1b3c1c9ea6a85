// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/routes.hpp"

#include <charconv>
#include <cmath>
#include <exception>

namespace stillhand::dashboard {

namespace {

constexpr const char* kSignIn =
    "signed out: open this page once as /?token=... with the token of --token-file; a dashboard "
    "without --token-file answers only to 127.0.0.1, localhost and [::1]";

Answer refusal(unsigned status, std::string why) {
  Answer answer;
  answer.status = status;
  answer.body = std::move(why) + "\n";
  return answer;
}

Answer answer_to(const Outcome& outcome) {
  switch (outcome.kind) {
    case Outcome::Kind::kUnknown:
      return refusal(404, "unknown action");
    case Outcome::Kind::kRefused:
      return refusal(409, outcome.why);
    case Outcome::Kind::kTooMany:
      return refusal(429, outcome.why);
    case Outcome::Kind::kDone:
      break;
  }
  Answer done;
  done.status = 204;
  return done;
}

std::optional<double> finite(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// The words of "text=...", percent-encoded (RFC 3986, 2.1); empty: none; nothing: malformed.
std::optional<std::string> text_of(std::string_view query) {
  constexpr std::string_view kKey = "text=";
  std::string text;
  if (!query.starts_with(kKey)) return text;
  for (std::size_t i = kKey.size(); i < query.size(); ++i) {
    if (query[i] != '%') {
      text += query[i];
      continue;
    }
    unsigned value = 0;
    if (i + 2 >= query.size()) return std::nullopt;
    const char* first = query.data() + i + 1;
    const auto [end, error] = std::from_chars(first, first + 2, value, 16);
    if (error != std::errc() || end != first + 2) return std::nullopt;
    text += static_cast<char>(value);
    i += 2;
  }
  return text;
}

}  // namespace

Answer answer(const Question& question, const Pages& pages, const Access& access,
              const Served& served) {
  const std::size_t mark = question.target.find('?');
  const std::string_view path = question.target.substr(0, mark);
  const std::string_view query =
      mark == std::string_view::npos ? std::string_view() : question.target.substr(mark + 1);
  const Access::Request request{question.host, question.origin, question.authorization,
                                question.cookie, query};
  if (question.method == "GET" && path == "/" && access.signs_in(request)) {
    Answer signed_in = refusal(303, "signed in");
    signed_in.location = "/";
    signed_in.cookie = access.cookie(request);
    return signed_in;
  }
  if (!access.allows(request)) return refusal(403, kSignIn);
  if (question.method == "POST") {
    const bool stops = path == "/emergency-stop";
    if (!stops && access.only_watches(request))
      return refusal(403, "signed in with the token for watching, which can stop and nothing else");
    if (!(stops ? access.allows_emergency_stop(request) : access.allows_change(request)))
      return refusal(403, "requests from pages of other sites are refused");
    // Nothing behind its path keeps an emergency stop from being obeyed.
    const std::optional<std::string> text = stops ? std::string() : text_of(query);
    if (!text) return refusal(400, "text=: want percent-encoded characters");
    return answer_to(served.act(path, *text));
  }
  if (question.method != "GET")
    return refusal(405, "the method must be GET, or POST for an action");
  Answer found;
  if (path == "/snapshot") {
    found.type = "application/json";
    if (!query.starts_with("at=")) {
      found.body = served.snapshot({});
      return found;
    }
    if (!served.timeline)
      return refusal(404, "at=: only a dashboard of a recording can show an instant");
    const std::optional<double> at_s = finite(query.substr(3));
    if (!at_s) return refusal(400, "at=: want seconds since the beginning, for example 12.5");
    try {
      found.body = served.snapshot(at_s);
    } catch (const std::exception& error) {  // the file has changed
      return refusal(500, error.what());
    }
    return found;
  }
  if (path == "/timeline" && served.timeline) {
    found.type = "application/json";
    found.body = served.timeline();
    return found;
  }
  if (path == "/events") {
    found.streams = true;
    return found;
  }
  const Page* page = pages.find(path);
  if (page == nullptr) return refusal(404, "unknown page");
  found.type = page->type;
  found.body = page->content;
  return found;
}

}  // namespace stillhand::dashboard
