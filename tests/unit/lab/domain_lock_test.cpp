// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/domain_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "services/system/process/domain.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::lab::domain_lock_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string refusal(std::uint32_t domain, std::uint32_t rig) {
  return support::refusal([&] { const DomainLock sut(domain, rig); });
}

TEST(DomainLockTest, OneLabIsAdmittedForADomainAndRigUntilItEnds) {
  const std::uint32_t domain = support::own_domain();
  {
    const DomainLock first(domain, 1);
    EXPECT_THAT(refusal(domain, 1),
                AllOf(StartsWith("--domain: got " + std::to_string(domain)), HasSubstr("--rig")));
    EXPECT_EQ(refusal(domain, 2), "accepted");
    EXPECT_EQ(refusal(domain, 11), "accepted");
  }
  EXPECT_EQ(refusal(domain, 1), "accepted");
}

/// A UDP socket on the port where the participants of a domain look for one another.
class Holder {
 public:
  Holder(std::uint32_t domain, bool shared) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    const int share = shared ? 1 : 0;
    setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &share, sizeof(share));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(runtime::first_port_of(domain)));
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ~Holder() { close(socket_); }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;

 private:
  int socket_;
};

TEST(DomainLockTest, APortThatAnotherProgramHoldsForItselfIsNamed) {
  const std::uint32_t domain = support::own_domain();
  {
    const Holder other(domain, false);
    EXPECT_THAT(refusal(domain, 1),
                AllOf(StartsWith("--domain: got " + std::to_string(domain)),
                      HasSubstr(std::to_string(runtime::first_port_of(domain)))));
  }
  EXPECT_EQ(refusal(domain, 1), "accepted");  // a refused lab keeps no lock either
}

TEST(DomainLockTest, AParticipantOnThePortIsNoHindrance) {
  const std::uint32_t domain = support::own_domain();
  const Holder participant(domain, true);
  EXPECT_EQ(refusal(domain, 1), "accepted");
}

}  // namespace
}  // namespace stillhand::lab::domain_lock_test
