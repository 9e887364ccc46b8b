#include "gap_stretch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

using namespace vibro_impact::core;

namespace
{
/// c_0 + c_1 t + ... + c_5 t^5
Moment polynomial(const double (&c)[6], double t)
{
  Moment moment;
  for (std::size_t k = 6; k-- > 0;)
  {
    moment.acceleration = moment.acceleration * t + 2.0 * moment.rate;
    moment.rate = moment.rate * t + moment.value;
    moment.value = moment.value * t + c[k];
  }
  return moment;
}

Moment cosine(double omega, double phase, double t)
{
  const double angle = omega * t + phase;
  return Moment{std::cos(angle), -omega * std::sin(angle), -omega * omega * std::cos(angle)};
}
}  // namespace

TEST(GapStretch, holdsAPolynomialOfFifthDegree)
{
  const double c[6] = {1.0, -1.8, 3.6, -2.8, 3.6, -1.0};
  const double width = 1.5;
  const GapStretch stretch(polynomial(c, 0.0), polynomial(c, width), width, Spread());
  double least = polynomial(c, 0.0).value;
  double greatest = least;
  for (double t = 0.0; t <= width; t += 0.001)
  {
    least = std::min(least, polynomial(c, t).value);
    greatest = std::max(greatest, polynomial(c, t).value);
  }
  EXPECT_FALSE(stretch.staysAbove(least + 1e-14));
  EXPECT_FALSE(stretch.staysBelow(greatest - 1e-14));
  EXPECT_TRUE(stretch.staysAbove(least - 1.0));
  EXPECT_TRUE(stretch.staysBelow(greatest + 1.0));
}

TEST(GapStretch, comesCloseToTheFirstRootAndNeverPastIt)
{
  // Roots at 0.4 and 1.1; at other levels elsewhere.
  const double c[6] = {0.44, -1.5, 1.0, 0.0, 0.0, 0.0};
  for (const double level : {0.0, 0.01, 0.03})
  {
    for (const double bulge : {0.0, 0.001, 0.01})
    {
      Spread spread;
      spread.bulge = bulge;
      const GapStretch stretch(polynomial(c, 0.0), polynomial(c, 1.0), 1.0, spread);
      const double root = 0.5 * (1.5 - std::sqrt(2.25 - 4.0 * (0.44 - level)));
      const double share = stretch.shareAbove(level);
      EXPECT_LE(share, root + 1e-14);
      EXPECT_GT(share, root - 0.15) << level << ' ' << bulge;
      const double bump = share * (1.0 - share);
      EXPECT_GE(polynomial(c, share).value - 64.0 * bump * bump * bump * bulge, level);
    }
  }
}

TEST(GapStretch, findsTheMaximum)
{
  const double c[6] = {0.0, 1.0, -0.3, -0.5, 0.1, -0.2};
  const double width = 1.4;
  const GapStretch stretch(polynomial(c, 0.0), polynomial(c, width), width, Spread());
  EXPECT_NEAR(polynomial(c, width * stretch.shareOfMaximum()).rate, 0.0, 1e-2);  // a good start, and no more
  EXPECT_FALSE(stretch.isMonotonous());
  EXPECT_TRUE(stretch.isConcave());

  Spread little;
  little.flat_rate = 0.1;
  little.flat_acceleration = 0.1;
  Spread much;
  much.flat_rate = 10.0;
  much.flat_acceleration = 10.0;
  const auto shortStretch = [&](const Spread& spread)
  { return GapStretch(polynomial(c, 0.0), polynomial(c, 0.4), 0.4, spread); };
  EXPECT_TRUE(shortStretch(little).isMonotonous());
  EXPECT_FALSE(shortStretch(much).isMonotonous());
  EXPECT_TRUE(shortStretch(little).isConcave());
  EXPECT_FALSE(shortStretch(much).isConcave());
}

TEST(GapStretch, findsSomeShareWhereNothingMoves)
{
  for (const double value : {0.0, 1.0, -1.0})
  {
    const GapStretch stretch(Moment{value, 0.0, 0.0}, Moment{value, 0.0, 0.0}, 1.0, Spread());
    EXPECT_GT(stretch.shareOfMaximum(), 0.0);
    EXPECT_LT(stretch.shareOfMaximum(), 1.0);
  }
}

TEST(GapStretch, theSpreadOfACosineIsABoundEverywhere)
{
  for (const double x : {0.01, 0.3, 1.0, 3.0, 6.0, 8.0, 9.0, 20.0, 300.0})
  {
    const double omega = 7.0;
    const double width = x / omega;
    const Spread spread = spreadOfCosine(omega, width);
    double greatest = 0.0;
    for (double phase = 0.0; phase < 6.3; phase += 0.1)
    {
      const Moment from = cosine(omega, phase, 0.0);
      const Moment to = cosine(omega, phase, width);
      // The same interpolation in the form of Hermite.
      for (double share = 0.05; share < 1.0; share += 0.05)
      {
        const double s = share;
        const double r = 1.0 - s;
        const double value =
            r * r * r * (1.0 + 3.0 * s + 6.0 * s * s) * from.value +
            s * s * s * (1.0 + 3.0 * r + 6.0 * r * r) * to.value +
            width * (s * r * r * r * (1.0 + 3.0 * s) * from.rate - r * s * s * s * (1.0 + 3.0 * r) * to.rate) +
            0.5 * width * width * s * s * r * r * (r * from.acceleration + s * to.acceleration);
        const double error = std::abs(value - cosine(omega, phase, share * width).value);
        const double bound =
            64.0 * std::pow(s * r, 3) * spread.bulge + std::min(spread.flat, spread.flat_rate * width * s);
        EXPECT_LE(error, bound * (1.0 + 1e-6) + 1e-14) << x << ' ' << share;
        greatest = std::max(greatest, error);
      }
    }
    if (x >= 0.3 && x <= 1.0)
    {
      EXPECT_GT(greatest, 0.9 * spread.bulge) << x;  // and not a loose one
    }
  }
}

TEST(GapStretch, staysAboveFromZeroOnWhereTheSpreadGrowsSlowerThanIt)
{
  const Moment from{0.0, 1.0, 0.0};
  const Moment to{1.0, 1.0, 0.0};
  const auto stays = [&](double bulge, double flat, double flat_rate)
  {
    Spread spread;
    spread.bulge = bulge;
    spread.flat = flat;
    spread.flat_rate = flat_rate;
    return GapStretch(from, to, 1.0, spread).staysAbove(0.0);
  };
  EXPECT_TRUE(stays(0.0, 0.1, 0.5));
  EXPECT_FALSE(stays(0.0, 0.1, 1.5));
  EXPECT_TRUE(stays(0.15, 0.0, 0.0));
  EXPECT_FALSE(stays(0.17, 0.0, 0.0));
  EXPECT_FALSE(stays(0.15, 0.1, 0.5));
}
