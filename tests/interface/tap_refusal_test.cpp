// SPDX-License-Identifier: Apache-2.0
// A process of its own: Fast DDS keeps the profiles of every file that one has read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <filesystem>
#include <fstream>
#include <string>

#include "fast_dds/names.hpp"
#include "places.hpp"
#include "services/bus/tap.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::runtime {
namespace {

std::string without_profile(const std::string& name) {
  std::string text = support::text_of(STILLHAND_SOURCE "/qos/profiles.xml");
  const std::string named = "profile_name=\"" + name + "\"";
  for (std::size_t at = 0; (at = text.find(named)) != std::string::npos;) {
    text.replace(at, named.size(), "profile_name=\"another\"");
  }
  return text;
}

// The listener for others on the bus is destroyed with the tap; DDS must not call it any more.
TEST(TapTest, RefusedForAProfileItLeavesNoParticipant) {
  const support::Folder folder;
  const std::filesystem::path file = folder / "without_record_reliable.xml";
  std::ofstream(file) << without_profile("record_reliable");
  Tap::Options options;
  options.name = "test-tap";
  options.domain = support::own_domain();
  options.profiles = file;
  options.wanted = [](const std::string&) { return true; };
  options.on_sample = [](const FoundWriter&, const TappedSample&) {};
  EXPECT_THAT(support::refusal([&] { const Tap sut(options); }),
              testing::HasSubstr("record_reliable"));
  EXPECT_EQ(edds::DomainParticipantFactory::get_instance()->lookup_participant(options.domain),
            nullptr);
}

}  // namespace
}  // namespace stillhand::runtime
