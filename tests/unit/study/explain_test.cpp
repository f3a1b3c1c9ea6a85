// SPDX-License-Identifier: Apache-2.0
// Likelihood and evidence of the paper's tables, on made responses whose answer is known: Eq. SU-7
// to SU-10.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <random>

#include "apps/study/explain/inference.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/yaml_text.hpp"

namespace stillhand::study::explain_test {
namespace {

// The paper's own figures, by hand: t_11 of p/2 = 2.0235e-6 is 8.4556, 14.355 mm sqrt(12) / 8.4556.
TEST(PaperTablesTest, DeviationsComeFromThePValues) {
  EXPECT_NEAR(deviation_from_p(14.355, 4.05e-6, 12), 5.9, 0.05);
  EXPECT_NEAR(deviation_from_p(0.08, 4.07e-5, 12), 0.042, 0.0005);
  EXPECT_NEAR(deviation_from_p(0.04, 0.0047, 12), 0.039, 0.0005);
  // R: qt(0.975, 11) = 2.200985.
  EXPECT_NEAR(deviation_from_p(2.200985, 0.05, 12), std::sqrt(12.0), 1e-6);
}

TEST(PaperTablesTest, HoldTheTablesInTheirOrder) {
  const PaperTables paper = paper_tables(5.5);
  EXPECT_EQ(table_figure_names()[6], "B-C rms_error");
  EXPECT_EQ(table_figure_names()[14], "B-C sd crossover");
  EXPECT_NEAR(paper.values[0], 22.22, 1e-9);
  EXPECT_NEAR(paper.values[3], 30.69, 1e-9);
  EXPECT_NEAR(paper.values[6], -14.355, 1e-9);
  EXPECT_NEAR(paper.values[7], 0.08, 1e-12);
  EXPECT_NEAR(paper.standard_error[6], 1.7, 0.05);  // 5.9 mm / sqrt(12)
  // The uncertainty of B enters A-B with + and B-C with -: it cancels in C - A.
  const double of_c_minus_a =
      paper.uncertainty(3, 3) + paper.uncertainty(6, 6) + 2.0 * paper.uncertainty(3, 6);
  EXPECT_NEAR(of_c_minus_a, std::pow(0.05 * 22.22, 2) + std::pow(0.05 * 38.555, 2), 1e-3);
  // f_c of B and of C were revised together: the difference keeps the rounding alone.
  EXPECT_NEAR(paper.uncertainty(8, 8), 2.0 * 1e-4 / 12.0, 1e-9);
  // ln s goes with its difference.
  EXPECT_NEAR(paper.uncertainty(6, 12), paper.uncertainty(6, 6) / paper.values[6], 1e-9);
  // Another unit scales what is in millimetres.
  const PaperTables larger = paper_tables(5.5 * std::exp(1e-3));
  EXPECT_LT(((larger.values - paper.values) / 1e-3 - paper.per_log_unit).cwiseAbs().maxCoeff(),
            1e-3 * 30.0);
}

// Subjects whose tables are the paper's, with normal differences between them.
class MadeSubjects {
 public:
  static constexpr std::size_t kCount = 400;

  // Deviations of A, B - A, C - B; the first three are free in the tables.
  static std::vector<Response> like_the_paper(double moved_dwell = 0.0) {
    const PaperTables paper = paper_tables(5.5);
    std::mt19937 engine(5);
    std::normal_distribution<double> normal;
    std::vector<Eigen::Matrix<double, 9, 1>> z(kCount);
    Eigen::Matrix<double, 9, 1> mean = Eigen::Matrix<double, 9, 1>::Zero();
    for (auto& one : z) {
      for (double& value : one) value = normal(engine);
      mean += one / static_cast<double>(kCount);
    }
    std::vector<Response> out(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      const Eigen::Matrix<double, 9, 1> from_mean = z[i] - mean;
      for (Eigen::Index k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const double a = paper.values[k] + from_mean[k] * std::exp(paper.values[9 + k]);
        const double ab = paper.values[3 + k] + from_mean[3 + k] * std::exp(paper.values[9 + k]);
        const double bc = paper.values[6 + k] + from_mean[6 + k] * std::exp(paper.values[12 + k]);
        out[i].metrics[at] = a;
        out[i].metrics[3 + at] = a + ab;
        out[i].metrics[6 + at] = a + ab + bc + (k == 1 ? moved_dwell : 0.0);
      }
    }
    return out;
  }
};

Nuisance no_nuisance() {
  Nuisance out;
  out.slope = Eigen::MatrixXd::Zero(kTableFigures, 1);
  out.prior_sd = Eigen::VectorXd::Ones(1);
  return out;
}

TEST(PredictTablesTest, GivesMeansDeviationsAndTheCovarianceOfTwelve) {
  const auto subjects = metrics_of(MadeSubjects::like_the_paper());
  const Prediction sut = predict_tables(subjects, subjects.size());
  const PaperTables paper = paper_tables(5.5);
  // Made with the paper's means exactly; deviations of 400 normal values, 1/sqrt(800) = 3.5 %.
  EXPECT_LT((sut.mean - paper.values).head<9>().cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((sut.mean - paper.values).tail<6>().cwiseAbs().maxCoeff(), 4.0 * 0.0354);
  EXPECT_NEAR(std::sqrt(sut.sampling(6, 6)), paper.standard_error[6], 0.15 * 1.7);
  // R: trigamma(5.5) / 4 = 0.04984; trigamma(199.5) / 4 = 1.2563e-3.
  EXPECT_NEAR(sut.sampling(12, 12), 0.04984, 1e-5);
  EXPECT_NEAR(sut.simulation(12, 12), 1.2563e-3, 1e-6);
}

TEST(PredictTablesTest, LeavesOutASubjectWithoutACrossover) {
  auto subjects = metrics_of(MadeSubjects::like_the_paper());
  const Prediction whole = predict_tables({subjects.begin() + 1, subjects.end()}, 399);
  subjects[0][8] = std::nan("");
  const Prediction sut = predict_tables(subjects, 399);
  EXPECT_LT((sut.mean - whole.mean).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_THROW(predict_tables({subjects.begin(), subjects.begin() + 3}, 3), ConfigError);
}

// Against the density written out, without nuisance and with it.
TEST(FitTablesTest, IsTheNormalDensityWithTheNuisanceIntegratedOut) {
  const auto subjects = metrics_of(MadeSubjects::like_the_paper(-0.02));
  const Prediction prediction = predict_tables(subjects, subjects.size());
  const PaperTables paper = paper_tables(5.5);
  Nuisance nuisance = no_nuisance();
  nuisance.slope(7, 0) = 0.015;
  nuisance.prior_sd[0] = 1.5;
  const Fit sut = fit_tables(prediction, paper, nuisance);

  // The integral over the nuisance parameter by the rectangle rule, to six deviations.
  const TableVector unit = kLogUnitDeviation * paper.per_log_unit;
  const TableMatrix noise = prediction.sampling + prediction.simulation + paper.uncertainty +
                            TableMatrix(unit * unit.transpose());
  const double log_norm =
      -0.5 * (15.0 * std::log(2.0 * std::numbers::pi) + std::log(noise.determinant()));
  double sum = 0.0;
  double first_moment = 0.0;
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const double x = 9.0 * (2.0 * (i + 0.5) / kSteps - 1.0);
    const TableVector off = paper.values - prediction.mean - nuisance.slope.col(0) * x;
    const double density = std::exp(log_norm - 0.5 * off.dot(noise.ldlt().solve(off))) *
                           std::exp(-0.5 * x * x / 2.25) /
                           (1.5 * std::sqrt(2.0 * std::numbers::pi));
    sum += density * 18.0 / kSteps;
    first_moment += x * density * 18.0 / kSteps;
  }
  EXPECT_NEAR(sut.log_likelihood, std::log(sum), 1e-6);
  EXPECT_NEAR(sut.shift[0], first_moment / sum, 1e-6);
  EXPECT_LT(std::abs(sut.after[7] - paper.values[7]),
            std::abs(prediction.mean[7] - paper.values[7]));
}

// A made cause lowers C's dwell ratio per unit; the subjects without it miss the paper's by 0.07.
class MadeCause {
 public:
  explicit MadeCause(double per_unit, double missed = 0.07)
      : without_(MadeSubjects::like_the_paper(missed)) {
    cause_.name = "made";
    cause_.parameter = "size";
    cause_.grid = {0.0, 0.5, 1.0};
    cause_.most = 1.0;
    responses_.cause = &cause_;
    for (const double value : cause_.grid) {
      auto moved = without_;
      for (Response& one : moved) one.metrics[7] -= per_unit * value;
      responses_.at.push_back(std::move(moved));
    }
    inference_ = {&without_, paper_tables(5.5), no_nuisance()};
  }

  std::vector<Response> without_;
  Cause cause_;
  CauseResponses responses_;
  Inference inference_;
};

TEST(ExplainTest, ACauseThatIsThereIsFoundWithItsSize) {
  const MadeCause made(0.14);
  const Hypothesis nothing = explain_nothing(made.inference_);
  const Hypothesis sut = explain_with(made.inference_, 0, made.responses_);
  // Standard error 0.0121, uncertainty 0.005 in B and in C: 0.014 in all, 0.1 of the parameter.
  // chi^2/2 = (0.07/0.014)^2/2 = 12.5, less ln(1 / (0.1 sqrt(2 pi))) = 1.4 for the parameter; the
  // uncertainty of B shared with A-B changes it by a part.
  EXPECT_NEAR(sut.log_evidence - nothing.log_evidence, 12.5 - 1.4, 2.0);
  ASSERT_EQ(sut.parameters.size(), 1u);
  EXPECT_NEAR(sut.parameters[0].median, 0.5, 0.05);
  EXPECT_NEAR(sut.parameters[0].high - sut.parameters[0].low, 4.0 * 0.1, 0.1);
  EXPECT_NEAR(sut.z[7], 0.0, 0.3);
  EXPECT_GT(sut.fit_p, 0.05);
  EXPECT_LT(nothing.fit_p, sut.fit_p);
}

TEST(ExplainTest, AParameterThatDoesNothingCostsNothingAndGainsNothing) {
  const MadeCause made(0.0);
  EXPECT_NEAR(explain_with(made.inference_, 0, made.responses_).log_evidence,
              explain_nothing(made.inference_).log_evidence, 1e-9);
}

TEST(ExplainTest, AnUnneededParameterCostsEvidence) {
  const MadeCause made(0.14, 0.0);
  // Half a posterior of 0.1 in a range of 1: ln(1 / (0.05 sqrt(2 pi))) = 2.1.
  EXPECT_LT(explain_with(made.inference_, 0, made.responses_).log_evidence,
            explain_nothing(made.inference_).log_evidence - 1.0);
}

TEST(ExplainTest, TwoCausesThatAddUpHaveNoInteraction) {
  const MadeCause made(0.07);
  const PairResponses pair{{0, 0}, {1.0, 1.0}, [&] {
                             auto both = made.without_;
                             for (Response& one : both) one.metrics[7] -= 0.14;
                             return both;
                           }()};
  const Hypothesis sut = explain_with(made.inference_, {&made.responses_, &made.responses_}, pair);
  // Only their sum is known: half of 1 each, anything from 0 to 1.
  EXPECT_NEAR(sut.parameters[0].median + sut.parameters[1].median, 1.0, 0.15);
  EXPECT_GT(sut.parameters[0].high - sut.parameters[0].low, 0.6);
}

// Two causes that do nothing alone and lower the dwell ratio together; simulated for half of the
// subjects.
TEST(ExplainTest, AnInteractionIsBilinearAndCarriesOverToAllSubjects) {
  const MadeCause made(0.0);
  std::vector<Response> both(made.without_.begin(), made.without_.begin() + 200);
  for (Response& one : both) one.metrics[7] -= 0.14;
  const PairResponses pair{{0, 0}, {1.0, 1.0}, both};
  const Hypothesis sut = explain_with(made.inference_, {&made.responses_, &made.responses_}, pair);
  // The paper's ratio is met where the product of both is 0.07 / 0.14.
  EXPECT_NEAR(sut.parameters[0].median * sut.parameters[1].median, 0.5, 0.15);
  EXPECT_GT(sut.log_evidence, explain_nothing(made.inference_).log_evidence + 5.0);
}

// A personal cause spreads the subjects: C - B of the dwell ratio gets the variance (0.14 m cv)^2.
TEST(ExplainTest, APersonalCauseExplainsSpread) {
  MadeCause made(0.14);
  made.cause_.personal = true;
  // The subjects without it are alike in C - B: a hundredth of the paper's deviation.
  for (Response& one : made.without_) {
    const double mean = 0.08 + 0.07;
    const double own = one.metrics[7] - one.metrics[4] - mean;
    one.metrics[7] = one.metrics[4] + mean + 0.01 * own;
  }
  made.responses_.at.clear();
  for (const double value : made.cause_.grid) {
    auto moved = made.without_;
    for (Response& one : moved) one.metrics[7] -= 0.14 * value;
    made.responses_.at.push_back(std::move(moved));
  }
  const Hypothesis sut = explain_with(made.inference_, 0, made.responses_);
  ASSERT_EQ(sut.parameters.size(), 2u);
  // 0.14 * 0.5 * cv = 0.042: cv = 0.6.
  EXPECT_NEAR(sut.parameters[1].median, 0.6, 0.21);
  EXPECT_GT(sut.parameters[1].low, 0.1);
}

TEST(ExplainTest, NamesWhatTheTablesCannotTellApart) {
  std::vector<Hypothesis> among(3);
  among[0].name = "one";
  among[0].log_evidence = -10.0;
  among[1].name = "other";
  among[1].log_evidence = -12.9;
  among[2].name = "third";
  among[2].log_evidence = -13.1;
  EXPECT_THAT(indistinguishable(among), testing::ElementsAre("one", "other"));
  among[1].log_evidence = -13.1;
  EXPECT_TRUE(indistinguishable(among).empty());
}

TEST(CausesTest, EachCauseChangesTheOptionsAndHasASource) {
  const StudyOptions base;
  for (const Cause& cause : causes()) {
    EXPECT_FALSE(cause.source.empty()) << cause.name;
    EXPECT_TRUE(std::ranges::is_sorted(cause.grid)) << cause.name;
    StudyOptions changed = base;
    cause.apply(changed, cause.grid.empty() ? 1.0 : cause.grid.back());
    const bool differs =
        changed.canceller != base.canceller || changed.motor.delay_s != base.motor.delay_s ||
        changed.motor.gain != base.motor.gain ||
        settings::yaml_text(changed.population) != settings::yaml_text(base.population);
    EXPECT_TRUE(differs) << cause.name;
    EXPECT_NO_THROW(validate(changed.population, "population")) << cause.name;
    if (cause.grid.empty()) continue;
    EXPECT_EQ(std::ranges::count(cause.grid, cause.none), 1) << cause.name;
    cause.apply(changed, cause.none);
    EXPECT_EQ(settings::yaml_text(changed.population), settings::yaml_text(base.population))
        << cause.name;
  }
}

TEST(CausesTest, ShiftsMoveTheCalibratedMeansAndStayInRange) {
  std::vector<double> shift(calibrated().size(), 0.0);
  shift[0] = std::log(1.1);
  EXPECT_NEAR(shifted({}, shift).seat_frequency_hz,
              1.1 * population::Population{}.seat_frequency_hz, 1e-12);
  shift.assign(shift.size(), 5.0);
  EXPECT_NO_THROW(validate(shifted({}, shift), "population"));
}

}  // namespace
}  // namespace stillhand::study::explain_test
