// SPDX-License-Identifier: Apache-2.0
#include "services/bus/batched/batched_udp.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>

#include "tests/support/wait.hpp"

namespace stillhand::runtime {
namespace {

using Locator = BatchedUdp::Locator;

/// A port of the loopback that was free a moment ago.
class FreePort {
 public:
  FreePort() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int holder = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    socklen_t size = sizeof(address_);
    bind(holder, reinterpret_cast<const sockaddr*>(&address_), size);
    getsockname(holder, reinterpret_cast<sockaddr*>(&address_), &size);
    close(holder);
  }
  ~FreePort() { close(socket_); }
  FreePort(const FreePort&) = delete;
  FreePort& operator=(const FreePort&) = delete;

  [[nodiscard]] Locator locator() const {
    Locator locator;
    locator.kind = LOCATOR_KIND_UDPv4;
    ertps::IPLocator::setIPv4(locator, "127.0.0.1");
    ertps::IPLocator::setPhysicalPort(locator, ntohs(address_.sin_port));
    return locator;
  }
  void send(char byte) const {
    sendto(socket_, &byte, 1, 0, reinterpret_cast<const sockaddr*>(&address_), sizeof(address_));
  }

 private:
  int socket_;
  sockaddr_in address_{};
};

struct Ignoring final : ertps::TransportReceiverInterface {
  void OnDataReceived(const ertps::octet*, std::uint32_t, const Locator&, const Locator&) override {
  }
};

// Taking one takes longer than sending one: every batch of the flooded port is full.
TEST(BatchedUdpTest, AFloodedPortKeepsNeitherTheOthersNorItsOwnEndWaiting) {
  const FreePort flooded, other;
  std::atomic<std::uint64_t> flood{0}, heard{0};
  const auto udp = std::make_shared<ertps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {"127.0.0.1"};
  const BatchedUdpDescriptor descriptor(udp, [&](std::span<const std::byte> datagram, auto) {
    if (datagram.front() == std::byte{'f'}) {
      ++flood;
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    } else {
      ++heard;
    }
    return true;
  });
  Ignoring receiver;
  const std::unique_ptr<ertps::TransportInterface> sut(descriptor.create_transport());
  ASSERT_TRUE(sut->init());
  ASSERT_TRUE(sut->OpenInputChannel(flooded.locator(), &receiver, 65000));
  ASSERT_TRUE(sut->OpenInputChannel(other.locator(), &receiver, 65000));
  const std::jthread flooding([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) flooded.send('f');
  });
  ASSERT_TRUE(support::eventually([&] { return flood > 1000; }));
  other.send('o');
  EXPECT_TRUE(support::eventually([&] { return heard == 1; }));
  EXPECT_TRUE(sut->CloseInputChannel(flooded.locator()));
  const std::uint64_t closed_at = flood;
  other.send('o');
  EXPECT_TRUE(support::eventually([&] { return heard == 2; }));
  EXPECT_EQ(flood, closed_at);
}

}  // namespace
}  // namespace stillhand::runtime
