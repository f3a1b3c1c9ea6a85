// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/control_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "services/files/cancellation/control_model_file.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::lab::control_model_test {
namespace {

using cancellation::Channel;
using testing::AllOf;
using testing::HasSubstr;

// A gain of 3.2 N s^2/m at every frequency, the paper's at 0 Hz (IV-A).
cancellation::ControlModel papers_gain() {
  cancellation::ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0};
  model.inputs = {{Channel::kAccelY, {}, {3.2}}};
  return model;
}

class LabControlModelTest : public testing::Test {
 protected:
  LabControlModelTest() { write("cancellation.yaml", ""); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }
  [[nodiscard]] std::string refusal(std::uint32_t rig = 1) const {
    return support::refusal([&] { control_model(folder_.path() / "m.json", rig, folder_.path()); });
  }

  deploy::SampleFolder folder_;
};

TEST_F(LabControlModelTest, AModelIsTakenAsItsFileHasIt) {
  write("m.json", cancellation::control_model_json(papers_gain(), 1));
  const auto sut = control_model(folder_.path() / "m.json", 1, folder_.path());
  EXPECT_EQ(sut.inputs.at(0).numerator, papers_gain().inputs[0].numerator);
}

TEST_F(LabControlModelTest, AModelOfAnotherRigsHandIsRefusedWithItsFile) {
  write("m.json", cancellation::control_model_json(papers_gain(), 2));
  EXPECT_THAT(refusal(), AllOf(HasSubstr("m.json"), HasSubstr("rig")));
  EXPECT_EQ(refusal(2), "accepted");
}

// The bounds are those of the canceller's own settings: 60 unless the file says otherwise.
TEST_F(LabControlModelTest, AModelBeyondTheCancellersBoundsIsRefusedWithItsFile) {
  auto model = papers_gain();
  model.inputs[0].numerator = {59.0};
  write("m.json", cancellation::control_model_json(model, 1));
  EXPECT_EQ(refusal(), "accepted");
  model.inputs[0].numerator = {61.0};
  write("m.json", cancellation::control_model_json(model, 1));
  EXPECT_THAT(refusal(), AllOf(HasSubstr("m.json: got "), HasSubstr("gain")));
  write("cancellation.yaml", "max_model_gain_n_s2_m: 100\n");
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(LabControlModelTest, AFileThatIsMissingOrNoModelIsNamed) {
  EXPECT_THAT(refusal(), HasSubstr("m.json"));
  for (const char* text : {"", "{}", "{\"format\": 1", "[1, 2]", "\xff\xfe"}) {
    write("m.json", text);
    EXPECT_THAT(refusal(), HasSubstr("m.json")) << text;
  }
}

TEST_F(LabControlModelTest, SettingsThatAreWrongAreNamedWithTheirLine) {
  write("m.json", cancellation::control_model_json(papers_gain(), 1));
  write("cancellation.yaml", "max_model_gain_n_s2_m: 0\n");
  EXPECT_THAT(refusal(), HasSubstr("cancellation.yaml:1:"));
}

}  // namespace
}  // namespace stillhand::lab::control_model_test
