#include "gap_stretch.h"

namespace vibro_impact::core
{
namespace
{
// The greatest errors of the first and second derivative, over that of the value divided by the width once and twice:
// by Birkhoff and Priver ("Hermite interpolation errors for derivatives", J. Math. and Phys. 46 (1967)) they are
// sqrt(5)/30000 and 1/1920 of the sixth derivative, where that of the value is 1/46080.
constexpr double rate_over_bulge = 46080.0 * 2.23606797749978969641 / 30000.0;
constexpr double acceleration_over_bulge = 46080.0 / 1920.0;
}  // namespace

Spread spreadOfCosine(double omega, double width)
{
  const double x = omega * width;
  const double x_2 = x * x;
  const double bulge = x_2 * x_2 * x_2 / 46080.0;
  // No coefficient of the polynomial exceeds 1 + 2 x/5 + x^2/20; first and second differences are those of its
  // derivatives.
  const double largest = 2.0 + 0.4 * x + 0.05 * x_2;
  if (bulge <= largest)
  {
    return Spread{bulge, 0.0, 0.0, 0.0};
  }
  return Spread{0.0, largest, omega * (1.0 + (10.0 + 4.0 * x + 0.5 * x_2) / x),
                omega * omega * (1.0 + (80.0 + 28.0 * x + 3.0 * x_2) / x_2)};
}

double GapStretch::shareAbove(double level) const
{
  const std::array<double, 6> p = powers();
  // Near to where the control polygon comes down to zero.
  std::size_t below = 1;
  while (below < 6 && coefficients_[below] > 0.0)
  {
    ++below;
  }
  const double above = std::max(0.0, coefficients_[below - 1]);
  double x = (static_cast<double>(below - 1) + above / (above - coefficients_[below])) * (1.0 / 6.0);
  double slope = 0.0;
  constexpr int iterations = 4;
  constexpr double near = 1.0e-3;  // the next change is of the order of its square
  for (int iteration = 0; iteration < iterations; ++iteration)
  {
    const double value = p[0] + x * (p[1] + x * (p[2] + x * (p[3] + x * (p[4] + x * p[5]))));
    slope = p[1] + x * (2.0 * p[2] + x * (3.0 * p[3] + x * (4.0 * p[4] + x * 5.0 * p[5])));
    const double next = x - value / slope;
    const double change = next - x;
    x = next > 0.0 && next < 1.0 ? next : 0.5 * (x + (value > 0.0 ? 1.0 : 0.0));
    if (std::abs(change) < near)
    {
      break;
    }
  }
  // As far before that root as the quantity can come down earlier, and a little more.
  const double bump = x * (1.0 - x);
  const double early = 64.0 * bump * bump * bump * spread_.bulge + spread_.flat + level;
  x -= 1.5 * early / std::abs(slope);
  if (!(x > 0.0))
  {
    return 0.0;
  }
  Coefficients c = coefficients_;
  c[3] -= bulge_;
  cut(c, x);
  return isAbove(c, level, x) ? x : 0.0;
}

bool GapStretch::staysBelowOutside(double from, double to, double level) const
{
  const auto greatest = [](const Coefficients& c) { return std::max({c[0], c[1], c[2], c[3], c[4], c[5], c[6]}); };
  Coefficients before = coefficients_;
  before[3] += bulge_;
  Coefficients after = before;
  std::reverse(after.begin(), after.end());
  cut(before, from);
  cut(after, 1.0 - to);
  return std::max(greatest(before), greatest(after)) + spread_.flat <= level;
}

bool GapStretch::isMonotonous() const
{
  const Coefficients& c = coefficients_;
  const double margin = (rate_over_bulge * spread_.bulge + width_ * spread_.flat_rate) / 6.0;
  double least = c[1] - c[0];
  double greatest = least;
  for (std::size_t i = 1; i < 6; ++i)
  {
    const double difference = c[i + 1] - c[i];
    least = std::min(least, difference);
    greatest = std::max(greatest, difference);
  }
  return least > margin || greatest < -margin;
}

bool GapStretch::isConcave() const
{
  const Coefficients& c = coefficients_;
  const double margin = (acceleration_over_bulge * spread_.bulge + width_ * width_ * spread_.flat_acceleration) / 30.0;
  double greatest = c[2] - 2.0 * c[1] + c[0];
  for (std::size_t i = 1; i < 5; ++i)
  {
    greatest = std::max(greatest, c[i + 2] - 2.0 * c[i + 1] + c[i]);
  }
  return greatest < -margin;
}

double GapStretch::shareOfMaximum() const
{
  const std::array<double, 6> p = powers();
  const double end_rate = coefficients_[6] - coefficients_[5];
  double x = p[1] / (p[1] - 6.0 * end_rate);
  x = x > 0.0 && x < 1.0 ? x : 0.5;
  constexpr int iterations = 3;
  for (int iteration = 0; iteration < iterations; ++iteration)
  {
    const double rate = p[1] + x * (2.0 * p[2] + x * (3.0 * p[3] + x * (4.0 * p[4] + x * 5.0 * p[5])));
    const double slope = 2.0 * p[2] + x * (6.0 * p[3] + x * (12.0 * p[4] + x * 20.0 * p[5]));
    const double next = x - rate / slope;
    x = next > 0.0 && next < 1.0 ? next : 0.5 * (x + (rate > 0.0 ? 1.0 : 0.0));
  }
  return x;
}

}  // namespace vibro_impact::core
