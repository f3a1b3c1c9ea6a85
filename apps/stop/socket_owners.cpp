// SPDX-License-Identifier: Apache-2.0
#include "apps/stop/socket_owners.hpp"

#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <linux/sock_diag.h>
#include <linux/unix_diag.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>

namespace stillhand::stop {
namespace {

void note_owner(const nlmsghdr& message, std::map<std::uint64_t, uid_t>& owners) {
  const auto* about = static_cast<const unix_diag_msg*>(NLMSG_DATA(&message));
  const auto* each = reinterpret_cast<const rtattr*>(about + 1);
  auto rest = static_cast<std::ptrdiff_t>(message.nlmsg_len - NLMSG_LENGTH(sizeof *about));
  for (; RTA_OK(each, rest); each = RTA_NEXT(each, rest)) {
    if (each->rta_type != UNIX_DIAG_UID) continue;
    std::memcpy(&owners[about->udiag_ino], RTA_DATA(each), sizeof(uid_t));
  }
}

}  // namespace

std::map<std::uint64_t, uid_t> socket_owners() {
  std::map<std::uint64_t, uid_t> owners;
  const int kernel = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_SOCK_DIAG);
  struct {
    nlmsghdr header;
    unix_diag_req request;
  } question{};
  question.header.nlmsg_len = sizeof question;
  question.header.nlmsg_type = SOCK_DIAG_BY_FAMILY;
  question.header.nlmsg_flags = NLM_F_REQUEST | NLM_F_DUMP;
  question.request.sdiag_family = AF_UNIX;
  question.request.udiag_states = ~0U;
  question.request.udiag_show = UDIAG_SHOW_UID;
  bool more = send(kernel, &question, sizeof question, 0) == sizeof question;
  alignas(nlmsghdr) std::array<char, 32768> part{};
  while (more) {
    ssize_t size = recv(kernel, part.data(), part.size(), 0);
    const auto* message = reinterpret_cast<const nlmsghdr*>(part.data());
    more = size > 0;
    for (; NLMSG_OK(message, size); message = NLMSG_NEXT(message, size)) {
      more = message->nlmsg_type == SOCK_DIAG_BY_FAMILY;
      if (more) note_owner(*message, owners);
    }
  }
  close(kernel);
  return owners;
}

}  // namespace stillhand::stop
