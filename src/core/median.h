#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace vibro_impact::core
{
/// From the median of the absolute deviations to the standard deviation of a normal distribution.
constexpr double median_to_deviation = 1.4826;

/// Of one value or more; of an even number of them, the upper one of the two in the middle. Leaves them in another
/// order.
inline double median(std::vector<double>& values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace vibro_impact::core
