// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/effects/smooth_curve.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "services/core/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kMostKnotsInside = 15;

// A loop asks it once a sample.
class LaidOut {
 public:
  explicit LaidOut(const SmoothCurve& curve) {
    for (std::size_t k = 0; k < curve.knots(); ++k) knots_.push_back(curve.x(k));
    for (std::size_t k = 0; k <= curve.knots(); ++k) pieces_.push_back(curve.piece(k));
    const double at_rest = curve.at(0.0);
    for (SmoothCurve::Piece& piece : pieces_) piece.c[0] -= at_rest;
  }

  double operator()(double z, LoopMemory& /*memory*/) const {
    std::size_t k = 0;
    while (k < knots_.size() && z > knots_[k]) ++k;
    return pieces_[k].at(z);
  }

 private:
  std::vector<double> knots_;
  std::vector<SmoothCurve::Piece> pieces_;
};

using CurvePoint = std::pair<double, double>;  // argument, phi

// Halfway between even steps of the range and of the samples: a bend may lie where samples are few.
std::vector<CurvePoint> points_at_knots(const std::vector<double>& argument,
                                        const std::vector<double>& phi,
                                        const std::vector<double>& weight) {
  std::vector<CurvePoint> counted;
  for (std::size_t n = 0; n < argument.size(); ++n) {
    if (weight[n] > 0.0) counted.emplace_back(argument[n], phi[n]);
  }
  if (counted.size() < kMostKnotsInside) return {};
  std::ranges::sort(counted);
  const double low = counted.front().first;
  const double range = counted.back().first - low;
  std::vector<CurvePoint> points;
  for (std::size_t k = 0; k < kMostKnotsInside; ++k) {
    const double share = static_cast<double>(k) / (kMostKnotsInside - 1);
    const auto at = static_cast<std::size_t>(share * static_cast<double>(counted.size() - 1));
    // Rounding may put the last one beyond all of them.
    const double sought =
        std::min(0.5 * (counted[at].first + low + share * range), counted.back().first);
    const CurvePoint point = *std::ranges::lower_bound(counted, sought, {}, &CurvePoint::first);
    if (points.empty() || point.first - points.back().first > kKnotsApart * range) {
      points.push_back(point);
    }
  }
  return points;
}

}  // namespace

SmoothCurve::SmoothCurve(const Effect& effect)
    : numbers_(effect.parameters), knots_(effect.parameters.size() / 2) {
  if (knots_ < kFewestKnots || numbers_.size() != 2 * knots_ ||
      !numbers_[0].name.starts_with("knot_") || !numbers_[knots_].name.starts_with("height_")) {
    throw std::out_of_range("three knots or more, then as many heights");
  }
  for (std::size_t k = 1; k < knots_; ++k) {
    if (!(x(k - 1) < x(k))) throw std::out_of_range("knots, ascending");
  }
}

double SmoothCurve::slope(std::size_t k) const {
  const std::size_t inner = std::clamp<std::size_t>(k, 1, knots_ - 2);
  const double before = x(inner) - x(inner - 1);
  const double behind = x(inner + 1) - x(inner);
  const double curvature = (rise(inner + 1) - rise(inner)) / (before + behind);
  return rise(inner) + curvature * (2.0 * x(k) - x(inner) - x(inner - 1));
}

SmoothCurve::Piece SmoothCurve::piece(std::size_t k) const {
  if (k == 0 || k == knots_) {
    const std::size_t end = k == 0 ? 0 : knots_ - 1;
    return {x(end), {height(end), slope(end), 0.0, 0.0}};
  }
  const double width = x(k) - x(k - 1);
  const double from = slope(k - 1);
  const double to = slope(k);
  return {x(k - 1),
          {height(k - 1), from, (3.0 * rise(k) - 2.0 * from - to) / width,
           (from + to - 2.0 * rise(k)) / (width * width)}};
}

double SmoothCurve::at(double value) const {
  std::size_t k = 0;
  while (k < knots_ && value > x(k)) ++k;
  return piece(k).at(value);
}

std::vector<double> SmoothCurve::bends() const {
  const double slope = (height(knots_ - 1) - height(0)) / (x(knots_ - 1) - x(0));
  std::vector<double> bends(knots_);
  for (std::size_t k = 0; k < knots_; ++k) bends[k] = height(k) - height(0) - slope * (x(k) - x(0));
  return bends;
}

Nonlinearity law_of_curve(const Effect& effect) { return {LaidOut(SmoothCurve(effect)), 1.0}; }

Effect with_knots(const char* form, std::vector<std::string> channels, const std::string& unit,
                  const std::vector<double>& knots) {
  Effect effect{"free_form", form, std::move(channels), {}, {}};
  for (std::size_t k = 0; k < knots.size(); ++k) {
    effect.parameters.push_back(constant("knot_" + std::to_string(k + 1), unit, knots[k]));
  }
  return effect;
}

// Slope and size belong to the body and the paths, and the level to the offset: heights are held at
// both ends, and that which is furthest from the straight line between them.
std::optional<Effect> curve_through(const std::vector<double>& argument,
                                    const std::vector<double>& phi,
                                    const std::vector<double>& weight) {
  constexpr double kWidest = 5.0;     // of the heights' range
  constexpr double kNoCurve = 0.2;    // of phi's deviation
  constexpr double kStraight = 1e-6;  // of the heights' range: rounding
  const std::vector<CurvePoint> points = points_at_knots(argument, phi, weight);
  if (points.size() < kFewestKnots) return {};
  std::vector<double> knots;
  for (const CurvePoint& point : points) knots.push_back(point.first);
  Effect effect = with_knots(kCurveInside, {}, "-", knots);
  for (std::size_t k = 0; k < points.size(); ++k) {
    effect.parameters.push_back(constant("height_" + std::to_string(k + 1), "-", points[k].second));
  }
  const SmoothCurve curve(effect);
  std::vector<double> missed = phi;
  for (std::size_t n = 0; n < phi.size(); ++n) missed[n] -= curve.at(argument[n]);
  if (!(deviation_of(missed) < kNoCurve * deviation_of(phi))) return {};
  std::vector<double> bends = curve.bends();
  for (double& bend : bends) bend = std::abs(bend);
  const auto furthest = std::ranges::max_element(bends);
  const auto [low, high] = std::ranges::minmax(points, {}, &CurvePoint::second);
  const double range = high.second - low.second;
  const bool straight = *furthest < kStraight * range;
  for (std::size_t k = 1; k + 1 < knots.size(); ++k) {
    if (!straight && std::cmp_equal(k, furthest - bends.begin())) continue;
    Parameter& height = effect.parameters[knots.size() + k];
    height.lower = height.value - kWidest * range;
    height.upper = height.value + kWidest * range;
    height.fitted = true;
  }
  return effect;
}

std::string slopes_in_words(const Effect& effect) {
  const SmoothCurve curve(effect);
  double steepest = 0.0;
  for (std::size_t k = 0; k < curve.knots(); ++k) {
    if (std::abs(curve.slope(k)) > std::abs(steepest)) steepest = curve.slope(k);
  }
  const auto share = [&](std::size_t k) {
    const long percent = steepest == 0.0 ? 0 : std::lround(100.0 * curve.slope(k) / steepest);
    return with_unit(static_cast<double>(percent), "%");  // without the sign of a zero
  };
  return "its low end has " + share(0) + ", its high end " + share(curve.knots() - 1) +
         " of its steepest slope";
}

}  // namespace stillhand::diagnosis
