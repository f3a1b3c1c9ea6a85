// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "services/bus/found_writer.hpp"

namespace stillhand::runtime {

/// Listens to a domain from outside of any session: no status, no life sign, nothing that a session
/// waits for.  Readers are made for each wanted topic as its writers are found, one for each
/// combination of reliability and durability, so that every writer matches and none is read twice.
///
/// The constructor checks everything that can be refused; no sample arrives before start().
/// on_sample() runs in a receiving thread, one call at a time for each reader; writers() is for
/// any thread.  Endpoint errors after the start are in trouble().
class Tap {
 public:
  struct Options {
    std::string name;                ///< of the participant
    std::uint32_t domain = 0;        ///< DDS domain, 0 to 232
    std::filesystem::path profiles;  ///< qos/profiles.xml
    std::filesystem::path security;  ///< see Bus::Options; it shows topics::kTap's certificate
    std::function<bool(const std::string& topic)> wanted;
    std::function<void(const FoundWriter&, const TappedSample&)> on_sample;
    /// Optional: an instance of a writer was disposed of or given up, which takes a number of its
    /// samples' sequence.
    std::function<void(std::size_t writer, std::int64_t sequence)> on_instance_end = {};
    bool any_type = false;  ///< also topics outside the catalogue whose type idl/ does not define
    /// Optional: definition of a type that discovery does not describe, or "".
    std::function<std::string(const std::string& type)> idl_of = {};
  };

  /// @throws ConfigError for a bad domain, profile file or security folder; BusError when DDS
  /// refuses.
  explicit Tap(Options options);
  ~Tap();
  Tap(const Tap&) = delete;
  Tap& operator=(const Tap&) = delete;

  /// Once.
  void start();
  /// No on_sample() runs after this returns.
  void stop();
  /// Every writer found so far, in the order of finding; those that left stay.
  [[nodiscard]] std::vector<FoundWriter> writers() const;
  /// Topics that could not be subscribed to, with the reason; one line each.
  [[nodiscard]] std::vector<std::string> trouble() const;
  /// Samples of writers that discovery did not announce; 0 unless DDS is at fault.
  [[nodiscard]] std::uint64_t unattributed() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stillhand::runtime
