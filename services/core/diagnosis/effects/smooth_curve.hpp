// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "services/core/diagnosis/model/effect_kind.hpp"

/// The smooth curves of free_form, METHOD Eq. DG-63: of the input, and inside the body.  An
/// effect's parameters are the knots, `knot_1` and on, then as many heights, `height_1` and on.
namespace stillhand::diagnosis {

inline constexpr std::size_t kFewestKnots = 3;
/// Knots are as far apart, of the distance between the outer ones.
inline constexpr double kKnotsApart = 0.02;
inline constexpr const char* kCurveInside = "curve inside the body";

/// Between knots a cubic whose slope at each is that of the parabola through it and its neighbours;
/// beyond the outer knots straight on.  Refers to the effect.
class SmoothCurve {
 public:
  /// Between two knots: sum_i c_i (x - from)^i.
  struct Piece {
    double from;
    std::array<double, 4> c;

    [[nodiscard]] double at(double value) const {
      const double x = value - from;
      return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
    }
  };

  /// @throws std::out_of_range for what no search made: a file's
  explicit SmoothCurve(const Effect& effect);

  [[nodiscard]] std::size_t knots() const noexcept { return knots_; }
  [[nodiscard]] double x(std::size_t k) const { return numbers_[k].value; }
  [[nodiscard]] double height(std::size_t k) const { return numbers_[knots_ + k].value; }
  [[nodiscard]] double slope(std::size_t k) const;
  /// Of the values up to knot k and above the one before it; knots(): beyond the last one.
  [[nodiscard]] Piece piece(std::size_t k) const;
  [[nodiscard]] double at(double value) const;
  /// Heights over the straight line between the outer ones.
  [[nodiscard]] std::vector<double> bends() const;

 private:
  // From the knot before it.
  [[nodiscard]] double rise(std::size_t k) const {
    return (height(k) - height(k - 1)) / (x(k) - x(k - 1));
  }

  const std::vector<Parameter>& numbers_;
  std::size_t knots_;
};

/// phi(z) = m(z) - m(0) of a curve inside the body: none at rest, as of any law.
/// @throws std::out_of_range as SmoothCurve
Nonlinearity law_of_curve(const Effect& effect);

/// An effect of this form with its knots, and no heights yet.
Effect with_knots(const char* form, std::vector<std::string> channels, const std::string& unit,
                  const std::vector<double>& knots);

/// EffectKind::drawn_after(), METHOD Eq. DG-90.
/// @return nullopt where phi is no function of the argument (it has a memory)
std::optional<Effect> curve_through(const std::vector<double>& argument,
                                    const std::vector<double>& phi,
                                    const std::vector<double>& weight);

/// A limit on one side, a saturation, a dead zone: its slopes say which law it is like.
std::string slopes_in_words(const Effect& effect);

}  // namespace stillhand::diagnosis
