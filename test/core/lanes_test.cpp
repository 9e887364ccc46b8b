#include "lanes.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

using namespace vibro_impact::core;

namespace
{
std::vector<double> randomNumbers(Eigen::Index count)
{
  static std::mt19937 generator(7);
  std::vector<double> numbers(static_cast<std::size_t>(count));
  for (double& number : numbers)
  {
    number = std::uniform_real_distribution<double>(-1.0, 1.0)(generator);
  }
  return numbers;
}

/// The scalar product in the one order there is.
double dotInLanes(const double* x, const double* y, Eigen::Index size)
{
  double sums[lanes] = {};
  for (Eigen::Index n = 0; n < size; ++n)
  {
    sums[n % lanes] += x[n] * y[n];
  }
  return (sums[0] + sums[2]) + (sums[1] + sums[3]);
}

class Lanes : public ::testing::TestWithParam<Eigen::Index>
{
};
}  // namespace

TEST(Padded, isTheNextMultiple)
{
  EXPECT_EQ(padded(0), 0);
  EXPECT_EQ(padded(1), lanes);
  EXPECT_EQ(padded(lanes), lanes);
  EXPECT_EQ(padded(lanes + 1), 2 * lanes);
}

// Every processor must give the bits of these plain loops.

TEST_P(Lanes, growsByAFactorLessOne)
{
  const Eigen::Index size = GetParam();
  std::vector<double> re = randomNumbers(size);
  std::vector<double> im = randomNumbers(size);
  const std::vector<double> f = randomNumbers(size);
  const std::vector<double> g = randomNumbers(size);
  const std::vector<double> x = re;
  const std::vector<double> y = im;
  growBy(re.data(), im.data(), f.data(), g.data(), size);
  for (std::size_t n = 0; n < re.size(); ++n)
  {
    EXPECT_EQ(re[n], x[n] + (x[n] * f[n] - y[n] * g[n]));
    EXPECT_EQ(im[n], y[n] + (x[n] * g[n] + y[n] * f[n]));
  }
}

TEST_P(Lanes, addsAMultiple)
{
  std::vector<double> x = randomNumbers(GetParam());
  const std::vector<double> before = x;
  const std::vector<double> y = randomNumbers(GetParam());
  addScaled(x.data(), 0.3, y.data(), GetParam());
  for (std::size_t n = 0; n < x.size(); ++n)
  {
    EXPECT_EQ(x[n], before[n] + 0.3 * y[n]);
  }
}

TEST_P(Lanes, multipliesAndSumsInOneOrder)
{
  const std::vector<double> x = randomNumbers(GetParam());
  const std::vector<double> y = randomNumbers(GetParam());
  EXPECT_EQ(dot(x.data(), y.data(), GetParam()), dotInLanes(x.data(), y.data(), GetParam()));
}

TEST_P(Lanes, doesAWholeIntervalInOnePass)
{
  const Eigen::Index half = GetParam();
  std::vector<double> z = randomNumbers(2 * half);
  const std::vector<double> kick = randomNumbers(2 * half);
  const std::vector<double> first = randomNumbers(2 * half);
  const std::vector<double> second = randomNumbers(2 * half);
  const std::vector<double> f = randomNumbers(half);
  const std::vector<double> g = randomNumbers(half);
  std::vector<double> expected = z;
  addScaled(expected.data(), 0.3, kick.data(), 2 * half);
  growBy(expected.data(), expected.data() + half, f.data(), g.data(), half);
  std::vector<double> kicked = randomNumbers(2 * half);
  std::vector<double> expected_kicked = kicked;
  addScaled(expected_kicked.data(), 0.3, z.data(), 2 * half);

  const Forms forms = kickGrowEvaluate(z.data(), kicked.data(), 0.3, kick.data(), f.data(), g.data(), first.data(),
                                       second.data(), half);
  EXPECT_EQ(z, expected);
  EXPECT_EQ(kicked, expected_kicked);
  const auto form = [&](const std::vector<double>& weights)
  {
    // The lanes of both halves are added before those are.
    double sums[lanes] = {};
    for (Eigen::Index lane = 0; lane < lanes; ++lane)
    {
      double re = 0.0;
      double im = 0.0;
      for (Eigen::Index n = lane; n < half; n += lanes)
      {
        re += weights[static_cast<std::size_t>(n)] * z[static_cast<std::size_t>(n)];
        im += weights[static_cast<std::size_t>(half + n)] * z[static_cast<std::size_t>(half + n)];
      }
      sums[lane] = re + im;
    }
    return (sums[0] + sums[2]) + (sums[1] + sums[3]);
  };
  EXPECT_EQ(forms.first, form(first));
  EXPECT_EQ(forms.second, form(second));
}

TEST_P(Lanes, quadraticFormIsTheSumOfItsTerms)
{
  const Eigen::Index half = GetParam();
  const std::vector<double> z = randomNumbers(2 * half);
  const std::vector<double> squares = randomNumbers(2 * half);
  const std::vector<double> products = randomNumbers(half);
  double expected = 0.0;
  for (std::size_t n = 0; n < static_cast<std::size_t>(half); ++n)
  {
    const double x = z[n];
    const double y = z[static_cast<std::size_t>(half) + n];
    expected += squares[n] * x * x + squares[static_cast<std::size_t>(half) + n] * y * y + products[n] * x * y;
  }
  EXPECT_NEAR(quadraticForm(z.data(), squares.data(), products.data(), half), expected,
              1e-14 * static_cast<double>(half));
}

INSTANTIATE_TEST_SUITE_P(Sizes, Lanes, ::testing::Values(4, 8, 12, 16, 36, 204));
