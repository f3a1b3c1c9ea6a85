// SPDX-License-Identifier: Apache-2.0
// The page of a diagnosis, from recordings whose effects are known.
#include "apps/diagnose/page/diagnosis_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>

#include "apps/diagnose/page/effect_numbers.hpp"
#include "apps/diagnose/page/evidence.hpp"
#include "apps/libraries/report/plot/figure_table.hpp"
#include "tests/unit/diagnose/sample_recordings.hpp"
#include "tests/unit/report/sample_figures.hpp"

namespace stillhand::diagnose::diagnosis_report_test {

using report::test::TemporaryFolder;
using support::text_of;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

constexpr double kFriction_n = -1.0;
constexpr double kNoise_n = 0.5;

// Words of a text in small letters.
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  return words;
}

diagnosis::DiagnoseOptions static_model() {
  diagnosis::DiagnoseOptions options;
  options.model = diagnosis::ModelClass::kLinear;
  return options;
}

diagnosis::Measurement recording(double friction_n) {
  diagnosis::Measurement measurement = test::moving_hand(60.0);
  auto& force_n = measurement.channels[2].values;
  signal::Gaussian noise(1, 9);
  for (std::size_t n = 0; n < force_n.size(); ++n) {
    const double rate_rad_s = measurement.channels[1].values[n];
    force_n[n] = -3.2 * measurement.channels[0].values[n] +
                 friction_n * (rate_rad_s > 0.0 ? 1.0 : -1.0) + kNoise_n * noise();
  }
  return measurement;
}

// A recording, its diagnosis and its report.
struct Reported {
  explicit Reported(double friction_n)
      : measurement(recording(friction_n)),
        found(diagnosis::diagnose(measurement, static_model())) {
    report::StagedFolder staged(folder.path());
    write_report(found, measurement, {"recordings/ride.csv"}, staged);
    html = text_of(folder.path() / "report.html");
  }

  TemporaryFolder folder;
  diagnosis::Measurement measurement;
  diagnosis::Diagnosis found;
  std::string html;
};

class DiagnosisReportTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    with_friction_ = std::make_unique<Reported>(kFriction_n);
    without_ = std::make_unique<Reported>(0.0);
  }
  static void TearDownTestSuite() {
    with_friction_.reset();
    without_.reset();
  }
  static std::unique_ptr<Reported> with_friction_;
  static std::unique_ptr<Reported> without_;
};

std::unique_ptr<Reported> DiagnosisReportTest::with_friction_;
std::unique_ptr<Reported> DiagnosisReportTest::without_;

TEST_F(DiagnosisReportTest, EverySectionAndFigureIsThere) {
  ASSERT_THAT(with_friction_->found.effects, testing::SizeIs(1));
  for (const char* part :
       {"Error before and after", "What the baseline lacks", "What is left", "What was tried",
        "95 % interval", "noise floor", "Numbers of the final model", "candidates", "surrogates"}) {
    EXPECT_THAT(with_friction_->html, HasSubstr(part));
  }
  for (const char* name : {"prediction", "residual_spectra", "effect_1", "residual_over_time",
                           "autocorrelation", "partial_coherence"}) {
    for (const std::string& file : report::figure_files(name)) {
      EXPECT_TRUE(std::filesystem::exists(with_friction_->folder.path() / file)) << file;
    }
    EXPECT_FALSE(
        text_of(with_friction_->folder.path() / (std::string(name) + ".svg")).find("no data") !=
        std::string::npos)
        << name;
  }
  EXPECT_THAT(with_friction_->html, HasSubstr("Figure 6."));
  EXPECT_TRUE(
      report::test::well_formed(with_friction_->html.substr(with_friction_->html.find("<html"))));
}

TEST_F(DiagnosisReportTest, TheVerdictIsSaidInWordsAtTheTop) {
  const std::string top = with_friction_->html.substr(0, with_friction_->html.find("<dl>"));
  EXPECT_THAT(top, HasSubstr("Effects found:"));
  EXPECT_THAT(top, HasSubstr("coulomb friction (omega)"));
  EXPECT_THAT(top, HasSubstr("noise floor"));
}

TEST_F(DiagnosisReportTest, NothingMissingIsAPageToo) {
  ASSERT_EQ(without_->found.verdict(), "nothing missing");
  EXPECT_THAT(without_->html, HasSubstr("Nothing missing:"));
  EXPECT_THAT(without_->html, HasSubstr("No effect was found."));
  EXPECT_THAT(without_->html, HasSubstr("What would not have been seen"));
  EXPECT_THAT(without_->html, HasSubstr("No effect was worth adding"));
  EXPECT_FALSE(std::filesystem::exists(without_->folder.path() / "effect_1.svg"));
  EXPECT_TRUE(std::filesystem::exists(without_->folder.path() / "prediction.svg"));
}

TEST_F(DiagnosisReportTest, LinesAreDrawnWhereTheExcitationRepeats) {
  EXPECT_FALSE(std::filesystem::exists(without_->folder.path() / "detection_lines.svg"));
  diagnosis::Measurement measurement = recording(0.0);
  auto& a_y = measurement.channels[0].values;
  auto& force_n = measurement.channels[2].values;
  // Lines at 0.3 and 0.7 Hz every 10 s, RMS 1, and a square, so that even lines stand out.
  for (std::size_t n = 0; n < a_y.size(); ++n) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(n % 1000) / 1000.0;
    force_n[n] += 3.2 * a_y[n];
    a_y[n] = std::sin(3.0 * turn) + std::sin(7.0 * turn + 1.0);
    force_n[n] += -3.2 * a_y[n] + 0.5 * a_y[n] * a_y[n];
  }
  diagnosis::DiagnoseOptions options = static_model();
  options.search.most_effects = 0;
  const diagnosis::Diagnosis found = diagnosis::diagnose(measurement, options);
  const TemporaryFolder folder;
  report::StagedFolder staged(folder.path());
  write_report(found, measurement, {"ride.csv"}, staged);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "detection_lines.svg"));
  const std::string html = text_of(folder.path() / "report.html");
  for (const char* part : {"excitation repeats", "periods of 10 s", "harmonics of 0.1 Hz",
                           "even lines", "distortion at"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST_F(DiagnosisReportTest, NoNumberIsPrintedThatIsNone) {
  for (const auto* each : {with_friction_.get(), without_.get()}) {
    EXPECT_THAT(words_of(each->html), Each(testing::AllOf(Not("nan"), Not("inf"))));
  }
}

TEST_F(DiagnosisReportTest, AnEarlierRunsFiguresGo) {
  const TemporaryFolder folder;
  for (const Reported* each : {with_friction_.get(), without_.get()}) {
    report::StagedFolder staged(folder.path());
    write_report(each->found, each->measurement, {"ride.csv"}, staged);
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "effect_1.png"));
}

TEST_F(DiagnosisReportTest, WhatIsLeftIsDescribed) {
  diagnosis::Diagnosis found = without_->found;
  found.unexplained =
      diagnosis::Unexplained{"it depends on the moon", {0.5, 2.0}, {12.0}, {"roll"}};
  const Evidence evidence(found, without_->measurement);
  const std::string html = diagnosis_page(evidence, {"ride.csv"}, {}).html();
  for (const char* part : {"Unexplained residual:", "Not explained: it depends on the moon",
                           "0.5 to 2 Hz", "strongest around 12 s", "depends on roll"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST_F(DiagnosisReportTest, EveryRecordingIsNamed) {
  const Evidence evidence(without_->found, without_->measurement);
  const std::string html = diagnosis_page(evidence, {"a/one.csv", "b/two.csv"}, {}).html();
  EXPECT_THAT(html, HasSubstr("from one.csv and 1 more"));
  EXPECT_THAT(html, HasSubstr("a/one.csv, b/two.csv"));
}

TEST_F(DiagnosisReportTest, NamesAreTextNotMarkup) {
  diagnosis::Diagnosis found = without_->found;
  found.notes = {"<b>note</b>"};
  const Evidence evidence(found, without_->measurement);
  const std::string html = diagnosis_page(evidence, {"<i>ride</i>.csv"}, {}).html();
  EXPECT_THAT(html, HasSubstr("&lt;b&gt;note"));
  EXPECT_THAT(html, Not(HasSubstr("<i>")));
}

TEST_F(DiagnosisReportTest, AStandardErrorIsTheNoiseOverTheRootOfTheSamples) {
  const Evidence sut(with_friction_->found, with_friction_->measurement);
  const ModelNumber friction = effect_numbers(sut, 0).back();  // the coefficient
  EXPECT_EQ(friction.unit, "N");
  // White noise on a column of +-1 whose mean and correlation with a_y are near zero; the estimate
  // of the noise and of its correlation length (their white values 0.5 and 1) is within a tenth.
  const double expected = kNoise_n / std::sqrt(60.0 * test::kRate_hz);
  EXPECT_NEAR(friction.standard_error, expected, 0.15 * expected);
  // Five of them: by chance in one of two million.  And what the smoothing of the sign about a zero
  // of the rate takes: less than one sample in thirty is about one.
  EXPECT_NEAR(friction.value, kFriction_n, 5.0 * expected + 0.03);
}

TEST_F(DiagnosisReportTest, ResidualWithoutAnEffectIsWhatItTakesAndWhatIsLeft) {
  const Evidence evidence(with_friction_->found, with_friction_->measurement);
  const EffectTrace sut = trace_of(evidence, 0);
  const double force_n = evidence.found.model.effects[0].coefficients[0];
  const auto& rate_rad_s = evidence.signals.at("omega").values;
  for (std::size_t n = 0; n < sut.without.size(); ++n) {
    if (!(evidence.after.run.weight[n] > 0.0)) continue;
    ASSERT_NEAR(sut.without[n], sut.contribution[n] + evidence.after.residual[n], 1e-9);
    if (std::abs(rate_rad_s[n]) < 0.3) continue;  // the sign is of the whole sample
    ASSERT_NEAR(sut.contribution[n], rate_rad_s[n] > 0.0 ? force_n : -force_n, 1e-9);
  }
}

}  // namespace stillhand::diagnose::diagnosis_report_test
