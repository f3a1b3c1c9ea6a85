// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/identify/admittance.hpp"
#include "apps/libraries/report/or_null.hpp"

namespace stillhand::identify {
namespace {

using admittance::ArmParameter;
using admittance::LineResponse;
using nlohmann::ordered_json;
using report::or_null;

double degrees(std::complex<double> value) { return std::arg(value) * 180.0 / std::numbers::pi; }

ordered_json lines_json(const std::vector<LineResponse>& lines) {
  ordered_json out = ordered_json::array();
  for (const LineResponse& line : lines) {
    out.push_back({{"frequency_hz", line.frequency_hz},
                   {"real", line.response.real()},
                   {"imaginary", line.response.imag()},
                   {"magnitude", std::abs(line.response)},
                   {"phase_deg", degrees(line.response)},
                   {"radius95", or_null(line.radius95)},
                   {"coherence", or_null(line.coherence)}});
  }
  return out;
}

bool undetermined(const admittance::ArmFit& arm, ArmParameter p) {
  return std::ranges::find(arm.undetermined, p) != arm.undetermined.end();
}

ordered_json arm_json(const admittance::ArmFit& arm) {
  ordered_json parameters = ordered_json::object();
  for (const ArmParameter p : arm.fitted) {
    const auto& name = admittance::arm_parameter_names()[p];
    parameters[std::string(name.name)] = {{"value", arm.values[p]},
                                          {"standard_error", or_null(arm.standard_error[p])},
                                          {"unit", name.unit},
                                          {"determined", !undetermined(arm, p)}};
  }
  ordered_json correlation = ordered_json::array();
  const std::size_t count = arm.fitted.size();
  for (std::size_t i = 0; i < count; ++i) {
    ordered_json row = ordered_json::array();
    for (std::size_t j = 0; j < count; ++j) row.push_back(or_null(arm.correlation[i * count + j]));
    correlation.push_back(row);
  }
  return {{"parameters", parameters},
          {"reflex", arm.reflex},
          {"reflex_evidence", or_null(arm.reflex_evidence)},
          {"misfit", or_null(arm.misfit)},
          {"degrees_of_freedom", arm.degrees},
          {"condition", or_null(arm.condition)},
          {"correlation", correlation}};
}

ordered_json relation_json(const std::optional<admittance::RelationTest>& relation) {
  if (!relation) return nullptr;
  ordered_json lines = ordered_json::array();
  for (const admittance::Mismatch& at : relation->lines) {
    lines.push_back({{"frequency_hz", at.line.frequency_hz},
                     {"real", at.line.response.real()},
                     {"imaginary", at.line.response.imag()},
                     {"radius95", or_null(at.line.radius95)},
                     {"within", at.within}});
  }
  return {{"share_within", or_null(relation->share_within)},
          {"median_mismatch", or_null(relation->median_mismatch)},
          {"median_radius", or_null(relation->median_radius)},
          {"lines", lines}};
}

using Response = std::function<std::complex<double>(double)>;

report::Panel magnitude(const std::string& title, const std::string& unit,
                        const std::vector<LineResponse>& lines, const Response& arm) {
  report::Panel out;
  out.title = title;
  out.x = {.label = "frequency [Hz]", .scale = report::Scale::kLogarithmic};
  out.y = {.label = unit, .scale = report::Scale::kLogarithmic};
  report::Series band{
      .label = "95 %", .kind = report::Kind::kBand, .colour = report::Colour::kMeasured};
  report::Series points{
      .label = "measured", .kind = report::Kind::kPoints, .colour = report::Colour::kMeasured};
  report::Series model{
      .label = "fitted arm", .kind = report::Kind::kLine, .colour = report::Colour::kModel};
  for (const LineResponse& line : lines) {
    const double size = std::abs(line.response);
    band.x.push_back(line.frequency_hz);
    // A circle that holds zero: the band ends where the axis can still show it.
    band.y_low.push_back(std::max(size - line.radius95, 0.02 * size));
    band.y_high.push_back(size + line.radius95);
    points.x.push_back(line.frequency_hz);
    points.y.push_back(size);
    if (!arm) continue;
    model.x.push_back(line.frequency_hz);
    model.y.push_back(std::abs(arm(line.frequency_hz)));
  }
  out.series = {band, points};
  if (arm) out.series.push_back(model);
  return out;
}

report::Panel phase(const std::vector<LineResponse>& lines) {
  report::Panel out;
  out.x = {.label = "frequency [Hz]", .scale = report::Scale::kLogarithmic};
  out.y = {.label = "phase [°]", .scale = report::Scale::kDegrees, .low = -180.0, .high = 180.0};
  report::Series bars{
      .label = "95 %", .kind = report::Kind::kErrorBars, .colour = report::Colour::kMeasured};
  for (const LineResponse& line : lines) {
    const double middle = degrees(line.response);
    const double share = std::min(1.0, line.radius95 / std::abs(line.response));
    const double half = std::asin(share) * 180.0 / std::numbers::pi;
    bars.x.push_back(line.frequency_hz);
    bars.y.push_back(middle);
    bars.y_low.push_back(middle - half);
    bars.y_high.push_back(middle + half);
  }
  out.series = {bars};
  return out;
}

}  // namespace

std::string result_json(const AdmittanceResult& result) {
  const ordered_json json{
      {"recording", result.recording},
      {"period_s", result.perturbation.period_s},
      {"periods", result.periods},
      {"neighbours", result.lines.neighbours},
      {"lost_ticks", result.lost_ticks},
      {"largest_motor_force_n", result.largest_force_n},
      {"admittance_m_n", lines_json(result.lines.admittance)},
      {"stick_per_commanded_force_m_n", lines_json(result.lines.stick_per_force)},
      {"feedthrough_to_force_n_s2_m", lines_json(result.lines.feedthrough_to_force)},
      {"feedthrough_to_position_s2", lines_json(result.lines.feedthrough_to_position)},
      {"arm", arm_json(result.arm)},
      {"held_feedthrough_to_force_n_s2_m",
       result.relation ? lines_json(result.held_feedthrough) : ordered_json(nullptr)},
      {"relation", relation_json(result.relation)}};
  return json.dump(2) + "\n";
}

std::string result_table(const AdmittanceResult& result) {
  std::string out = fmt::format(
      "{} periods of {:g} s, {} lines of each kind, {} lost ticks, motor at most {:.2f} N\n"
      "misfit {:.2f} (1: the arm's structure holds), condition {:.0f}, reflex {}\n",
      result.periods, result.perturbation.period_s, result.lines.admittance.size(),
      result.lost_ticks, result.largest_force_n, result.arm.misfit, result.arm.condition,
      result.arm.reflex ? "seen" : "not seen");
  for (const ArmParameter p : result.arm.fitted) {
    const auto& name = admittance::arm_parameter_names()[p];
    out += fmt::format("{:<24} {:>11.5g} +- {:<9.3g} {}{}\n", name.name, result.arm.values[p],
                       result.arm.standard_error[p], name.unit,
                       undetermined(result.arm, p) ? "  (not determined)" : "");
  }
  if (result.relation) {
    out += fmt::format(
        "position feedthrough = force feedthrough x deflection per force (AD-16): off by {:.0f} % "
        "in the median, the 95 % circles are {:.0f} % wide; {:.0f} % of {} lines agree\n",
        100.0 * result.relation->median_mismatch, 100.0 * result.relation->median_radius,
        100.0 * result.relation->share_within, result.relation->lines.size());
  }
  return out;
}

report::Figure figure(const AdmittanceResult& result) {
  const auto& arm = result.arm.values;
  report::Figure out;
  out.name = "admittance";
  out.columns = 3;
  out.width_px = 1200;
  out.height_px = 620;
  out.panels = {
      magnitude("admittance", "[m/N]", result.lines.admittance,
                [&](double f) { return 1.0 / admittance::arm_response(arm, f).impedance; }),
      magnitude("feedthrough to force, stick free", "[N s²/m]", result.lines.feedthrough_to_force,
                {}),
      magnitude("feedthrough to position", "[s²]", result.lines.feedthrough_to_position,
                [&](double f) {
                  return admittance::free_stick(admittance::arm_response(arm, f), {}, f)
                      .feedthrough_to_position;
                }),
      phase(result.lines.admittance),
      phase(result.lines.feedthrough_to_force),
      phase(result.lines.feedthrough_to_position)};
  return out;
}

}  // namespace stillhand::identify
