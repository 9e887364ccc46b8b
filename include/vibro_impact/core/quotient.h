#pragma once

#include <cstdint>

namespace vibro_impact::core
{
/// A quotient as whole part and fraction, whole + fraction: no digit of the fraction is lost however large the whole
/// is.
struct Quotient
{
  std::uint64_t whole = 0;
  double fraction = 0.0;  ///< in [0, 1), correctly rounded
};

/// numerator/denominator for a numerator >= 0 and a denominator > 0, both finite, whose quotient is below 2^53.
Quotient divide(double numerator, double denominator);

}  // namespace vibro_impact::core
