#include "march.h"

#include <algorithm>

namespace vibro_impact::peers
{
double crossing(double value0, double slope0, double value1, double slope1)
{
  constexpr double none = 2.0;
  if (value1 > 0.0 && !(slope0 < 0.0 && slope1 > 0.0))
  {
    return none;
  }
  const double c3 = 2.0 * (value0 - value1) + slope0 + slope1;
  const double c2 = 3.0 * (value1 - value0) - 2.0 * slope0 - slope1;
  const auto cubic = [&](double s) { return value0 + s * (slope0 + s * (c2 + s * c3)); };
  const auto slope = [&](double s) { return slope0 + s * (2.0 * c2 + 3.0 * s * c3); };

  double beyond = 1.0;
  if (value1 > 0.0)
  {
    double from = 0.0;
    double to = 1.0;
    for (int i = 0; i < 30; ++i)
    {
      const double middle = 0.5 * (from + to);
      (slope(middle) < 0.0 ? from : to) = middle;
    }
    beyond = to;
    if (cubic(beyond) >= 0.0)
    {
      return none;
    }
  }
  double before = 0.0;
  if (value0 <= 0.0)
  {
    // On the root of the last switch but for rounding. Where the step leaves it on the right side at first, the
    // crossing is the next root; where it does not, there is nothing to tell it from.
    before = 0.5 * beyond;
    while (cubic(before) <= 0.0)
    {
      before *= 0.5;
      if (before < 1.0e-6)
      {
        return beyond;
      }
    }
  }
  while (beyond - before > 1.0e-3)
  {
    const double middle = 0.5 * (before + beyond);
    (cubic(middle) > 0.0 ? before : beyond) = middle;
  }
  double root = 0.5 * (before + beyond);
  for (int i = 0; i < 2; ++i)
  {
    root = std::clamp(root - cubic(root) / slope(root), before, beyond);
  }
  return root;
}
}  // namespace vibro_impact::peers
