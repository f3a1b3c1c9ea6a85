// SPDX-License-Identifier: Apache-2.0
#include "services/bus/batched/batched_udp.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "services/system/process/clock.hpp"

namespace stillhand::runtime {

namespace {

constexpr std::int64_t kTurn_ns = 4'000'000;
constexpr std::size_t kSlots = 64;
// Of one socket in a turn, 256,000 datagrams a second: a flood that fills every batch delays
// neither the other sockets nor the end, and the kernel drops the excess.
constexpr int kMostBatches = 16;
constexpr std::size_t kLargest = 65536;  // a datagram's, by UDP itself

/// Closes its socket.
class Socket {
 public:
  /// @param address  of this host, or 0.0.0.0  @throws std::system_error
  Socket(const std::string& address, std::uint16_t port, std::uint32_t buffer_bytes)
      : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_port = htons(port);
    const int on = 1, room = static_cast<int>(buffer_bytes);
    const bool known = inet_pton(AF_INET, address.c_str(), &name.sin_addr) == 1;
    if (room > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &room, sizeof(room));
    if (!known || setsockopt(socket_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)) != 0 ||
        bind(socket_, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0) {
      const int error = errno;
      if (socket_ >= 0) close(socket_);
      throw std::system_error(error, std::generic_category());
    }
  }
  ~Socket() {
    if (socket_ >= 0) close(socket_);
  }
  Socket(Socket&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  Socket& operator=(Socket&&) = delete;

  [[nodiscard]] int get() const { return socket_; }

 private:
  int socket_;
};

}  // namespace

/// The sockets of one locator's port, and their receiver.
struct BatchedUdp::Channel {
  Locator local;
  std::vector<Socket> sockets;
  std::mutex mutex;              // held while the receiver is called
  Receiver* receiver = nullptr;  // nullptr: closed
};

/// Room for the datagrams of one call, used again and again.
class BatchedUdp::Slots {
 public:
  Slots() {
    for (std::size_t i = 0; i < kSlots; ++i) {
      parts_[i] = {bytes_.data() + i * kLargest, kLargest};
      auto& header = messages_[i].msg_hdr;
      header.msg_iov = &parts_[i];
      header.msg_iovlen = 1;
      header.msg_name = &senders_[i];
      header.msg_control = controls_[i].data();
    }
  }

  /// Takes the datagrams that have arrived, at most kSlots.  @returns their number
  std::size_t fill(int socket) {
    for (std::size_t i = 0; i < kSlots; ++i) {
      messages_[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
      messages_[i].msg_hdr.msg_controllen = controls_[i].size();
    }
    const int got = recvmmsg(socket, messages_.data(), kSlots, MSG_DONTWAIT, nullptr);
    return got < 0 ? 0 : static_cast<std::size_t>(got);
  }

  [[nodiscard]] std::span<const std::byte> datagram(std::size_t i) const {
    return std::span(bytes_).subspan(i * kLargest, messages_[i].msg_len);
  }

  [[nodiscard]] std::int64_t arrived_ns(std::size_t i) {
    msghdr& header = messages_[i].msg_hdr;
    for (cmsghdr* each = CMSG_FIRSTHDR(&header); each != nullptr;
         each = CMSG_NXTHDR(&header, each)) {
      if (each->cmsg_level != SOL_SOCKET || each->cmsg_type != SCM_TIMESTAMPNS) continue;
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(each), sizeof(stamp));
      return stamp.tv_sec * kNsPerSecond + stamp.tv_nsec;
    }
    return system_ns();
  }

  [[nodiscard]] Locator sender(std::size_t i) const {
    Locator locator;
    locator.kind = LOCATOR_KIND_UDPv4;
    ertps::IPLocator::setIPv4(locator,
                              reinterpret_cast<const ertps::octet*>(&senders_[i].sin_addr.s_addr));
    ertps::IPLocator::setPhysicalPort(locator, ntohs(senders_[i].sin_port));
    return locator;
  }

 private:
  std::vector<std::byte> bytes_ = std::vector<std::byte>(kSlots * kLargest);
  std::array<mmsghdr, kSlots> messages_{};
  std::array<iovec, kSlots> parts_{};
  std::array<sockaddr_in, kSlots> senders_{};
  alignas(cmsghdr) std::array<std::array<std::byte, 64>, kSlots> controls_{};
};

ertps::TransportInterface* BatchedUdpDescriptor::create_transport() const {
  return new BatchedUdp(*this);
}

BatchedUdp::BatchedUdp(const BatchedUdpDescriptor& descriptor)
    : SendingAsBelow(descriptor), descriptor_(descriptor) {}

BatchedUdp::~BatchedUdp() = default;  // the thread is the last member: it ends first

ertps::TransportDescriptorInterface* BatchedUdp::get_configuration() { return &descriptor_; }

bool BatchedUdp::IsInputChannelOpen(const Locator& locator) const {
  if (ertps::IPLocator::isMulticast(locator)) return ChainingTransport::IsInputChannelOpen(locator);
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(channels_, [&](const auto& channel) {
    return ertps::IPLocator::getPhysicalPort(channel->local) ==
           ertps::IPLocator::getPhysicalPort(locator);
  });
}

bool BatchedUdp::OpenInputChannel(const Locator& locator, Receiver* receiver, std::uint32_t most) {
  if (ertps::IPLocator::isMulticast(locator)) {
    return ChainingTransport::OpenInputChannel(locator, receiver, most);
  }
  if (!is_locator_allowed(locator) || IsInputChannelOpen(locator)) return false;
  auto channel = std::make_shared<Channel>();
  channel->local = locator;
  channel->receiver = receiver;
  std::vector<std::string> addresses = descriptor_.udp->interfaceWhiteList;
  if (addresses.empty()) addresses.emplace_back("0.0.0.0");
  try {
    for (const std::string& address : addresses) {
      channel->sockets.emplace_back(address, ertps::IPLocator::getPhysicalPort(locator),
                                    descriptor_.udp->receiveBufferSize);
    }
  } catch (const std::system_error&) {
    return false;  // usually taken: DDS tries the next port
  }
  const std::lock_guard lock(mutex_);
  channels_.push_back(std::move(channel));
  if (!reading_.joinable()) {
    reading_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  return true;
}

bool BatchedUdp::CloseInputChannel(const Locator& locator) {
  if (ertps::IPLocator::isMulticast(locator)) return ChainingTransport::CloseInputChannel(locator);
  std::shared_ptr<Channel> closed;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find_if(channels_, [&](const auto& channel) {
      return ertps::IPLocator::getPhysicalPort(channel->local) ==
             ertps::IPLocator::getPhysicalPort(locator);
    });
    if (found == channels_.end()) return false;
    closed = std::move(*found);
    channels_.erase(found);
  }
  const std::lock_guard lock(closed->mutex);  // until a running call of the receiver has returned
  closed->receiver = nullptr;
  return true;
}

void BatchedUdp::receive(Receiver* next, const ertps::octet* bytes, std::uint32_t size,
                         const Locator& local, const Locator& remote) {
  next->OnDataReceived(bytes, size, local, remote);
}

std::size_t BatchedUdp::take_batch(const Channel& channel, int socket, Slots& slots) {
  const std::size_t got = slots.fill(socket);
  for (std::size_t i = 0; i < got; ++i) {
    const auto datagram = slots.datagram(i);
    if (descriptor_.take(datagram, slots.arrived_ns(i))) continue;
    channel.receiver->OnDataReceived(reinterpret_cast<const ertps::octet*>(datagram.data()),
                                     static_cast<std::uint32_t>(datagram.size()), channel.local,
                                     slots.sender(i));
  }
  return got;
}

void BatchedUdp::run(const std::stop_token& stop) {
  Slots slots;
  std::vector<std::shared_ptr<Channel>> channels;
  for (std::int64_t due_ns = monotonic_ns(); !stop.stop_requested();) {
    {
      const std::lock_guard lock(mutex_);
      channels = channels_;
    }
    for (const auto& channel : channels) {
      const std::lock_guard lock(channel->mutex);
      if (channel->receiver == nullptr) continue;
      for (const Socket& socket : channel->sockets) {
        for (int batch = 0; batch < kMostBatches && !stop.stop_requested(); ++batch) {
          if (take_batch(*channel, socket.get(), slots) < kSlots) break;
        }
      }
    }
    due_ns = std::max(due_ns + kTurn_ns, monotonic_ns());
    sleep_until_ns(due_ns);
  }
}

}  // namespace stillhand::runtime
