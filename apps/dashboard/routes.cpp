// SPDX-License-Identifier: Apache-2.0
#include "dashboard/routes.hpp"

namespace stillhand::dashboard {

namespace {

Answer refusal(unsigned status, std::string why) {
  Answer answer;
  answer.status = status;
  answer.body = std::move(why) + "\n";
  return answer;
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
    signed_in.cookie = access.cookie();
    return signed_in;
  }
  if (!access.allows(request)) return refusal(403, "not without the token, or by another name");
  if (question.method == "POST") {
    if (path != "/acknowledge") return refusal(404, "no such action");
    if (!access.allows_change(request)) return refusal(403, "not for a page of another site");
    served.acknowledge();
    Answer done;
    done.status = 204;
    return done;
  }
  if (question.method != "GET") return refusal(405, "GET, or POST of an action");
  Answer found;
  if (path == "/snapshot") {
    found.type = "application/json";
    found.body = served.snapshot();
    return found;
  }
  if (path == "/events") {
    found.streams = true;
    return found;
  }
  const Page* page = pages.find(path);
  if (page == nullptr) return refusal(404, "no such page");
  found.type = page->type;
  found.body = page->content;
  return found;
}

}  // namespace stillhand::dashboard
