#include "vibro_impact/core/quotient.h"

#include <cmath>

namespace vibro_impact::core
{
Quotient divide(double numerator, double denominator)
{
  // fmod() is exact; what it leaves for the whole part is so close to a whole number that rounding finds it.
  const double remainder = std::fmod(numerator, denominator);
  return {static_cast<std::uint64_t>(std::llround((numerator - remainder) / denominator)), remainder / denominator};
}

}  // namespace vibro_impact::core
