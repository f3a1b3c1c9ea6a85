// SPDX-License-Identifier: Apache-2.0
// The verb as a person types it: files in, one file out, or none.
#include "apps/predict/predict_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/libraries/report/provenance.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/csv.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/verb.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::predict::predict_command_test {
namespace {

namespace fs = std::filesystem;
namespace made = diagnosis::made;
using testing::HasSubstr;

class PredictCommandTest : public testing::Test {
 protected:
  void SetUp() override {
    diagnosis::Model model = made::model_of({{{2.0}}, {1.0}, 0.5});
    write("model.json", diagnosis::model_json(model));
    write("ride.csv", csv_at(100.0));
  }

  void write(const char* name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  [[nodiscard]] std::string text_of(const char* name) const {
    return support::text_of(folder_ / name);
  }
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }

  // 3 s of a seeded input.
  static std::string csv_at(double rate_hz) {
    recording::Recording table;
    const auto count = static_cast<std::size_t>(3.0 * rate_hz);
    for (std::size_t n = 0; n < count; ++n) {
      table.time_s.push_back(static_cast<double>(n) / rate_hz);
    }
    table.columns = {{"u", "V", made::white(count, 20)}};
    return recording::to_csv(table);
  }

  // What the verb prints.
  static std::string run(const std::vector<std::string>& words) {
    return support::output_of(add_predict_command, support::named("predict", words));
  }

  const support::Folder folder_;
};

TEST_F(PredictCommandTest, WritesAsManyRowsAsItSays) {
  const std::string printed = run({path("model.json"), path("ride.csv"), "--out", path("out.csv")});
  EXPECT_THAT(printed, HasSubstr("300 samples"));
  const auto in = recording::parse_csv(text_of("ride.csv"), "in");
  const auto out = recording::parse_csv(text_of("out.csv"), "out");
  EXPECT_THAT(text_of("out.csv"), testing::StartsWith("t [s],y_model [N]\n"));
  ASSERT_EQ(out.row_count(), 300u);
  for (std::size_t n = 0; n < 300; ++n) {
    // The reader may put times onto its grid: equal to the rounding of 3 s.
    ASSERT_NEAR(out.time_s[n], in.time_s[n], 1e-12);
    ASSERT_NEAR(out.columns[0].values[n], 2.0 * in.columns[0].values[n] + 0.5, 1e-12) << n;
  }
}

TEST_F(PredictCommandTest, TheNoteOnAnEffectThatWasLeftOutIsPrinted) {
  write("model.json", diagnosis::model_json(made::model_of({{{2.0}}, {1.0}, 0.5},
                                                           {{"drift", "linear", {}, {}, {5.0}}})));
  EXPECT_THAT(run({path("model.json"), path("ride.csv"), "--out", path("out.csv")}),
              HasSubstr("note: drift"));
}

TEST_F(PredictCommandTest, ARefusedRecordingLeavesTheEarlierFileAsItWas) {
  write("out.csv", "earlier");
  write("ride.csv", csv_at(150.0));
  EXPECT_THROW(run({path("model.json"), path("ride.csv"), "--out", path("out.csv")}), ConfigError);
  EXPECT_EQ(text_of("out.csv"), "earlier");
  EXPECT_EQ(folder_.entries(), 3u);
}

TEST_F(PredictCommandTest, TheOutputMayNotBeOneOfTheInputs) {
  const std::string model = text_of("model.json");
  EXPECT_THROW(run({path("model.json"), path("ride.csv"), "--out", path("model.json")}),
               ConfigError);
  EXPECT_THROW(run({path("model.json"), path("ride.csv"), "--out", path("ride.csv")}), ConfigError);
  EXPECT_EQ(text_of("model.json"), model);
}

TEST_F(PredictCommandTest, AFileThatIsMissingOrNoModelIsNamed) {
  const auto message_of = [&](const char* model, const char* ride) {
    return support::refusal<std::exception>(
        [&] { run({path(model), path(ride), "--out", path("out.csv")}); });
  };
  EXPECT_THAT(message_of("absent.json", "ride.csv"), HasSubstr("absent.json"));
  EXPECT_THAT(message_of("model.json", "absent.csv"), HasSubstr("absent.csv"));
  EXPECT_THAT(message_of("ride.csv", "ride.csv"), HasSubstr("ride.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "out.csv"));
}

TEST_F(PredictCommandTest, AnOutputIsAskedForByName) {
  const auto refusal_of = [](const std::vector<std::string>& words) {
    return support::refusal_of(add_predict_command, support::named("predict", words));
  };
  EXPECT_EQ(refusal_of({path("model.json"), path("ride.csv")}), "command line: --out is required");
  EXPECT_EQ(refusal_of({path("model.json"), path("ride.csv"), "--out", ""}),
            "command line: --out: got an empty name, want a name");
  EXPECT_EQ(refusal_of({path("model.json"), "--out", path("out.csv")}),
            "command line: REC is required");
}

// Where the recording holds the output, it is judged: y = 2 u + 0.5, the linear model says u.
class PredictedOutputTest : public PredictCommandTest {
 protected:
  void SetUp() override {
    PredictCommandTest::SetUp();
    const diagnosis::Model found = made::model_of({{{2.0}}, {1.0}, 0.5});
    const std::string model = diagnosis::model_json(found, diagnosis::carried_as_it_is(found),
                                                    made::model_of({{{1.0}}, {1.0}, 0.5}));
    write("model.json",
          report::with_provenance(
              model,
              {"0.1.0", "2026-11-26T13:50:00Z", "stillhand diagnose a.csv", {{"a.csv", "00"}}}));
    recording::Recording table = recording::parse_csv(csv_at(100.0), "made");
    recording::Column y{"y", "N", table.columns[0].values};
    for (double& value : y.values) value = 2.0 * value + 0.5;
    table.columns.push_back(std::move(y));
    write("ride.csv", recording::to_csv(table));
  }
};

TEST_F(PredictedOutputTest, ItStandsNextToThePredictionAndItsErrorsArePrinted) {
  const std::string printed = run({path("model.json"), path("ride.csv"), "--out", path("out.csv")});
  EXPECT_THAT(text_of("out.csv"), testing::StartsWith("t [s],y_model [N],y [N]\n"));
  EXPECT_THAT(printed, HasSubstr("linear   RMSE"));
  EXPECT_THAT(printed, HasSubstr("VAF 75.00 %"));
  EXPECT_THAT(printed, HasSubstr("fit 100.00 %"));
  EXPECT_THAT(printed, HasSubstr("model    stillhand 0.1.0, 2026-11-26T13:50:00Z, from a.csv"));
}

TEST_F(PredictedOutputTest, ScriptsGetTheSameFigures) {
  run({path("model.json"), path("ride.csv"), "--out", path("out.csv"), "--json", path("out.json")});
  const auto sut = nlohmann::json::parse(text_of("out.json"));
  EXPECT_NEAR(sut["linear"]["vaf_percent"], 75.0, 1e-9);
  EXPECT_NEAR(sut["carried"]["fit_percent"], 100.0, 1e-9);
  EXPECT_EQ(sut["provenance"]["date"], "2026-11-26T13:50:00Z");
}

TEST_F(PredictedOutputTest, ThePictureIsOfTheKindThatItsNameSays) {
  run({path("model.json"), path("ride.csv"), "--out", path("out.csv"), "--picture", path("p.png")});
  EXPECT_THAT(text_of("p.png"), testing::StartsWith("\x89PNG"));
  run({path("model.json"), path("ride.csv"), "--out", path("out.csv"), "--picture", path("p.svg")});
  EXPECT_THAT(text_of("p.svg"), HasSubstr("<svg"));
  EXPECT_THROW(run({path("model.json"), path("ride.csv"), "--out", path("out.csv"), "--picture",
                    path("p.gif")}),
               ConfigError);
}

TEST_F(PredictCommandTest, WithoutTheOutputThereIsNoPicture) {
  EXPECT_THROW(run({path("model.json"), path("ride.csv"), "--out", path("out.csv"), "--picture",
                    path("p.png")}),
               ConfigError);
  EXPECT_FALSE(fs::exists(folder_ / "out.csv"));
}

}  // namespace
}  // namespace stillhand::predict::predict_command_test
