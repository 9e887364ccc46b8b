#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace vibro_impact::core
{
/// A quantity at one time, with its first two derivatives.
struct Moment
{
  double value = 0.0;         // m
  double rate = 0.0;          // m/s
  double acceleration = 0.0;  // m/s^2
};

/// How far a quantity can be from the polynomial of a stretch, at the share x of its width: no more than
///
///   bulge 64 x^3 (1 - x)^3 + min(flat, flat_rate width x)
struct Spread
{
  double bulge = 0.0;              // m
  double flat = 0.0;               // m
  double flat_rate = 0.0;          // m/s: also by how much the rate differs, where it is not by the bulge
  double flat_acceleration = 0.0;  // m/s^2, likewise
};

/// The spread about its stretch of cos(omega t + phi), whatever phi, where x = omega width: the error of Hermite
/// interpolation, x^6/46080, which grows from both ends with the third power; for large x what the numbers at both ends
/// can make of the polynomial.
Spread spreadOfCosine(double omega, double width);

/// Whether a stretch is better off without what a cosine adds to the numbers at its ends: the spread is then that of
/// the cosine itself, 1.
constexpr bool isTooFast(double omega, double width)
{
  constexpr double limit = 6.0;  // x^6/46080 = 1
  return omega * width > limit;
}

/// What value, rate and acceleration at both ends of a time tell of a quantity between them: it is near to the
/// polynomial of fifth degree through them, by the spread. Raised to the sixth degree that polynomial lies between the
/// least and the greatest of its Bernstein coefficients, and as 64 x^3 (1 - x)^3 is 3.2 times the Bernstein polynomial
/// in the middle, the bulge moves that coefficient alone.
///
/// Time in a stretch is its share x of the width, 0 to 1.
class GapStretch
{
public:
  GapStretch(const Moment& from, const Moment& to, double width, const Spread& spread)
      : GapStretch(from, to, width, spread, from.value)
  {
  }
  /// Where the moments leave something out, the quantity itself starts at `start`.
  GapStretch(const Moment& from, const Moment& to, double width, const Spread& spread, double start)
      : width_(width), start_(start), bulge_(middle_share * spread.bulge), spread_(spread)
  {
    // Sixths of the rates, thirtieths of the accelerations, per width.
    const double from_rate = width * from.rate * (1.0 / 6.0);
    const double to_rate = width * to.rate * (1.0 / 6.0);
    const double square = width * width * (1.0 / 30.0);
    const double from_acceleration = square * from.acceleration;
    const double to_acceleration = square * to.acceleration;
    coefficients_ = {
        from.value,
        from.value + from_rate,
        from.value + 2.0 * from_rate + from_acceleration,
        0.5 * (from.value + to.value) + 1.2 * (from_rate - to_rate) + 0.75 * (from_acceleration + to_acceleration),
        to.value - 2.0 * to_rate + to_acceleration,
        to.value - to_rate,
        to.value};
  }

  /// Whether the quantity is above `level` throughout; it may start below where it starts at no less than zero.
  bool staysAbove(double level) const
  {
    Coefficients c = coefficients_;
    c[3] -= bulge_;
    return isAbove(c, level, 1.0);
  }

  /// Whether it is nowhere above `level`.
  bool staysBelow(double level) const
  {
    const Coefficients& c = coefficients_;
    return std::max({c[0], c[1], c[2], c[3] + bulge_, c[4], c[5], c[6]}) + spread_.flat <= level;
  }

  /// The same before the share `from` and after the share `to`.
  bool staysBelowOutside(double from, double to, double level) const;

  /// How far the quantity may be from the polynomial.
  double greatestSpread() const
  {
    return spread_.bulge + spread_.flat;
  }

  /// Of a quantity that is below zero in the end: a share up to which it stays above `level`, in the sense of
  /// staysAbove(). Near to the greatest such, or 0 where none is found.
  double shareAbove(double level) const;

  /// Whether the quantity rises throughout or falls throughout.
  bool isMonotonous() const;
  bool isConcave() const;

  /// Where the polynomial's rate is zero, if it goes from > 0 to < 0.
  double shareOfMaximum() const;

private:
  using Coefficients = std::array<double, 7>;
  /// De Casteljau: the coefficients of the part up to the share x.
  static void cut(Coefficients& c, double x)
  {
    for (std::size_t first = 1; first < 7; ++first)
    {
      for (std::size_t i = 6; i >= first; --i)
      {
        c[i] = c[i - 1] + x * (c[i] - c[i - 1]);
      }
    }
  }
  static constexpr double middle_share = 3.2;

  /// The same of the part of the stretch up to `share` that has these coefficients.
  bool isAbove(const Coefficients& c, double level, double share) const
  {
    if (std::min({c[0], c[1], c[2], c[3], c[4], c[5], c[6]}) > level + spread_.flat)
    {
      return true;
    }
    const double slope = spread_.flat_rate * width_ * share * (1.0 / 6.0);
    const double least = level - start_ + c[0];
    return start_ >= 0.0 && c[1] > least + slope && c[2] > least + 2.0 * slope && c[3] > least + 3.0 * slope &&
           c[4] > least + 4.0 * slope && c[5] > least + 5.0 * slope && c[6] > least + 6.0 * slope;
  }

  /// The polynomial in powers of x.
  std::array<double, 6> powers() const
  {
    const Coefficients& c = coefficients_;
    const double rate = 6.0 * (c[1] - c[0]);
    const double half_curvature = 15.0 * (c[2] - 2.0 * c[1] + c[0]);
    const double value_left = c[6] - c[0] - rate - half_curvature;
    const double rate_left = 6.0 * (c[6] - c[5]) - rate - 2.0 * half_curvature;
    const double curvature_left = 15.0 * (c[4] - 2.0 * c[5] + c[6]) - half_curvature;
    return {c[0],
            rate,
            half_curvature,
            10.0 * value_left - 4.0 * rate_left + curvature_left,
            -15.0 * value_left + 7.0 * rate_left - 2.0 * curvature_left,
            6.0 * value_left - 3.0 * rate_left + curvature_left};
  }

  Coefficients coefficients_;
  double width_;
  double start_;
  double bulge_;  // in the coefficient of the middle
  Spread spread_;
};

}  // namespace vibro_impact::core
