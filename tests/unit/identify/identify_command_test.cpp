// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/identify_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "services/files/identification/model_file.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/support/feedthrough_records.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/verb.hpp"

namespace stillhand::identify::identify_command_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

// A folder of its own for each test, with a recording of a body-like model at 100 Hz in it.
class IdentifyCommandTest : public testing::Test {
 protected:
  void SetUp() override {
    auto slow = support::record_of(support::body_like_model(),
                                   support::band_noise(3000, 50.0, 0.7, 8.0, 1.6, 1));
    std::ofstream csv(folder_ / "ride.csv");
    csv << "t [s],a_y [m/s^2],f [N],temp [degC]\n";
    // Between the samples a straight line: at 4 Hz within 3 % of a sine, which is enough here.
    for (std::size_t n = 0; n + 1 < slow.size(); ++n) {
      csv << 0.02 * static_cast<double>(n) << ',' << slow.acceleration_m_s2[n] << ','
          << slow.force_n[n] << ",21\n";
      csv << 0.02 * static_cast<double>(n) + 0.01 << ','
          << 0.5 * (slow.acceleration_m_s2[n] + slow.acceleration_m_s2[n + 1]) << ','
          << 0.5 * (slow.force_n[n] + slow.force_n[n + 1]) << ",21\n";
    }
  }

  // What the verb prints.
  static std::string run(const std::vector<std::string>& words) {
    return support::output_of(add_identify_command, support::named("identify", words));
  }

  static std::string error_of(const std::vector<std::string>& words) {
    return support::refusal_of(add_identify_command, support::named("identify", words));
  }

  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::size_t file_count() const { return folder_.entries(); }

  const support::Folder folder_;
};

TEST_F(IdentifyCommandTest, BothFilesAreWrittenAndSayTheSame) {
  const std::string table =
      run({at("ride.csv"), "--save", at("model.json"), "--json", at("out.json")});
  const auto model =
      identification::parse_model(recording::read_file(at("model.json")), "model.json");
  const json out = json::parse(recording::read_file(at("out.json")));
  EXPECT_EQ(out["input"], "a_y");
  EXPECT_EQ(out["output"], "f");
  EXPECT_EQ(out["sample_rate_hz"], 100.0);
  EXPECT_EQ(out["order"], 4);
  EXPECT_EQ(out["model"]["numerator"].get<std::vector<double>>(), model.fit.numerator);
  EXPECT_EQ(out["model"]["denominator"].get<std::vector<double>>(), model.fit.denominator);
  EXPECT_EQ(out["model"]["rate_hz"], 50.0);
  EXPECT_EQ(out["heldout"]["free_run_vaf_percent"], model.heldout.free_run_vaf_percent);
  EXPECT_EQ(out["heldout"]["free_run_rmse"], model.heldout.free_run_rms_n);
  EXPECT_EQ(out["heldout"]["one_step_vaf_percent"], model.heldout.one_step_vaf_percent);
  EXPECT_EQ(out["stable"], true);
  EXPECT_EQ(out["condition_number"], model.condition_number);
  for (const auto& point : out["frequency_response"]) {
    ASSERT_TRUE(point["frequency_hz"].is_number() && point["magnitude_db"].is_number() &&
                point["phase_deg"].is_number());
  }
  ASSERT_GT(out["measured_response"].size(), 10u);
  for (const auto& point : out["measured_response"]) {
    ASSERT_GE(point["coherence"].get<double>(), 0.0);
    ASSERT_LE(point["coherence"].get<double>(), 1.0 + 1e-12);
  }
  EXPECT_THAT(table, HasSubstr("rate, samples      100 Hz, 5998"));
  EXPECT_THAT(table, HasSubstr("c_i [N/(m/s^2)]"));
  EXPECT_EQ(file_count(), 3u);
}

TEST_F(IdentifyCommandTest, WithoutFilesItOnlyPrints) {
  EXPECT_THAT(run({at("ride.csv")}), HasSubstr("free run, unseen"));
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(IdentifyCommandTest, TheOrderIsTheOneAskedFor) {
  run({at("ride.csv"), "--order", "2", "--json", at("out.json")});
  const json out = json::parse(recording::read_file(at("out.json")));
  EXPECT_EQ(out["order"], 2);
  EXPECT_EQ(out["model"]["denominator"].size(), 3u);
}

TEST_F(IdentifyCommandTest, AnOrderOutOfRangeIsAUsageError) {
  EXPECT_THROW(run({at("ride.csv"), "--order", "13"}), command_line::UsageError);
  EXPECT_THROW(run({at("ride.csv"), "--order", "0"}), command_line::UsageError);
  EXPECT_THROW(run({}), command_line::UsageError);
}

// An unset variable of a script, not a wish for no file.
TEST_F(IdentifyCommandTest, AnEmptyNameIsAUsageError) {
  EXPECT_THROW(run({at("ride.csv"), "--json", ""}), command_line::UsageError);
  EXPECT_THROW(run({at("ride.csv"), "--save", ""}), command_line::UsageError);
}

TEST_F(IdentifyCommandTest, EarlierResultsAreReplaced) {
  std::ofstream(at("out.json")) << "earlier";
  run({at("ride.csv"), "--json", at("out.json")});
  EXPECT_EQ(json::parse(recording::read_file(at("out.json")))["input"], "a_y");
}

TEST_F(IdentifyCommandTest, AfterARefusalEarlierResultsAreAsTheyWere) {
  std::ofstream(at("out.json")) << "earlier";
  EXPECT_THAT(error_of({at("ride.csv"), "--input", "temp", "--json", at("out.json"), "--save",
                        at("model.json")}),
              HasSubstr("channel temp: got 21 degC throughout"));
  EXPECT_EQ(recording::read_file(at("out.json")), "earlier");
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(IdentifyCommandTest, TheRecordingIsNotWrittenOver) {
  EXPECT_THAT(error_of({at("ride.csv"), "--json", at("ride.csv")}),
              HasSubstr("--json: got " + at("ride.csv") + ", want a file other than"));
}

TEST_F(IdentifyCommandTest, AModelThatCannotCancelIsNotSaved) {
  // A pole of 16 s: no filter that the canceller would take settles so slowly.
  const auto record = support::record_of({100.0, {0.0, 0.01}, {1.0, -0.9994}},
                                         support::white_noise(12'000, 1.0, 6));
  std::ofstream csv(at("slow.csv"));
  csv << "t [s],a_y [m/s^2],f [N]\n";
  for (std::size_t n = 0; n < record.size(); ++n) {
    csv << 0.01 * static_cast<double>(n) << ',' << record.acceleration_m_s2[n] << ','
        << record.force_n[n] << '\n';
  }
  csv.close();
  EXPECT_THAT(error_of({at("slow.csv"), "--order", "1", "--save", at("model.json"), "--json",
                        at("out.json")}),
              AllOf(HasSubstr("--save: got a model that can't cancel"),
                    HasSubstr("want no --save; the same command with a lower --order")));
  EXPECT_FALSE(fs::exists(at("out.json")));
  run({at("slow.csv"), "--order", "1", "--json", at("out.json")});
  const json out = json::parse(recording::read_file(at("out.json")));
  EXPECT_EQ(out["usable"], false);
  EXPECT_TRUE(out["control_model"].is_null());
}

}  // namespace
}  // namespace stillhand::identify::identify_command_test
