#include "lanes.h"

#include <cmath>
#include <complex>
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

struct Exponentials
{
  explicit Exponentials(Eigen::Index size)
      : half(static_cast<std::size_t>(size)),
        z(randomNumbers(2 * size)),
        factor_re(randomNumbers(3 * size)),
        factor_im(randomNumbers(3 * size)),
        exponent_re(randomNumbers(size)),
        exponent_im(randomNumbers(size))
  {
  }
  Growth growth() const
  {
    return Growth{factor_re.data(), factor_im.data(), exponent_re.data(), exponent_im.data(),
                  static_cast<Eigen::Index>(half)};
  }
  void multiply(std::vector<double>& z_to, std::size_t column) const
  {
    for (std::size_t n = 0; n < half; ++n)
    {
      const double x = z_to[n];
      const double y = z_to[half + n];
      const double f = factor_re[half * column + n];
      const double g = factor_im[half * column + n];
      z_to[n] = x + (x * f - y * g);
      z_to[half + n] = y + (x * g + y * f);
    }
  }

  std::size_t half;
  std::vector<double> z, factor_re, factor_im, exponent_re, exponent_im;
};

void expectForms(const Forms& forms, const std::vector<double>& weights, const std::vector<double>& z)
{
  const auto size = static_cast<Eigen::Index>(z.size());
  EXPECT_NEAR(forms.first, dotInLanes(weights.data(), z.data(), size), 1e-12);
  EXPECT_NEAR(forms.second, dotInLanes(weights.data() + size, z.data(), size), 1e-12);
  EXPECT_NEAR(forms.third, dotInLanes(weights.data() + 2 * size, z.data(), size), 1e-12);
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

TEST_P(Lanes, growsByTabulatedFactors)
{
  const Exponentials exponentials(GetParam());
  std::vector<double> expected = exponentials.z;
  for (const std::size_t column : {0u, 2u})
  {
    exponentials.multiply(expected, column);
  }
  std::vector<double> z = exponentials.z;
  grow(exponentials.growth(), 0b101, 0.0, z.data(), z.data());
  EXPECT_EQ(z, expected);
}

TEST_P(Lanes, growsByTheSeries)
{
  const Exponentials exponentials(GetParam());
  const double ticks = 1.0e-3;
  std::vector<double> z(exponentials.z.size());
  grow(exponentials.growth(), 0, ticks, exponentials.z.data(), z.data());
  const std::size_t half = exponentials.half;
  for (std::size_t n = 0; n < half; ++n)
  {
    const std::complex<double> expected =
        std::complex<double>(exponentials.z[n], exponentials.z[half + n]) *
        std::exp(ticks * std::complex<double>(exponentials.exponent_re[n], exponentials.exponent_im[n]));
    EXPECT_NEAR(z[n], expected.real(), 4e-16);
    EXPECT_NEAR(z[half + n], expected.imag(), 4e-16);
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

TEST_P(Lanes, growsAndEvaluatesInOnePass)
{
  const Exponentials exponentials(GetParam());
  const auto size = static_cast<Eigen::Index>(exponentials.z.size());
  const std::vector<double> weights = randomNumbers(3 * size);
  const std::vector<double> other_weights = randomNumbers(3 * size);
  for (const double series : {0.0, 7.0, -7.0})
  {
    std::vector<double> expected(exponentials.z.size());
    grow(exponentials.growth(), 5, series, exponentials.z.data(), expected.data());
    std::vector<double> z(expected.size());
    expectForms(growEvaluate(exponentials.growth(), 5, series, exponentials.z.data(), weights.data(), z.data()),
                weights, z);
    EXPECT_EQ(z, expected);
    const TwoForms two = growEvaluateTwo(exponentials.growth(), 5, series, exponentials.z.data(), weights.data(),
                                         other_weights.data(), z.data());
    EXPECT_EQ(z, expected);
    expectForms(two.first, weights, z);
    expectForms(two.second, other_weights, z);
  }
}

TEST_P(Lanes, doesAWholeIntervalInOnePass)
{
  const Exponentials exponentials(GetParam());
  const auto half = static_cast<Eigen::Index>(exponentials.half);
  const std::vector<double> kick = randomNumbers(2 * half);
  const std::vector<double> weights = randomNumbers(2 * half);
  std::vector<double> expected = exponentials.z;
  addScaled(expected.data(), 0.3, kick.data(), 2 * half);
  exponentials.multiply(expected, 1);
  std::vector<double> z(expected.size());
  const double form =
      kickGrowEvaluate(exponentials.growth(), 1, exponentials.z.data(), 0.3, kick.data(), weights.data(), z.data());
  EXPECT_EQ(z, expected);
  EXPECT_NEAR(form, dotInLanes(weights.data(), z.data(), 2 * half), 1e-12);
}

TEST_P(Lanes, evaluatesThreeForms)
{
  const Eigen::Index size = GetParam();
  const std::vector<double> weights = randomNumbers(3 * size);
  const std::vector<double> z = randomNumbers(size);
  const Forms forms = evaluateForms(weights.data(), z.data(), size);
  EXPECT_EQ(forms.first, dotInLanes(weights.data(), z.data(), size));
  EXPECT_EQ(forms.second, dotInLanes(weights.data() + size, z.data(), size));
  EXPECT_EQ(forms.third, dotInLanes(weights.data() + 2 * size, z.data(), size));
}

TEST_P(Lanes, sumsSizes)
{
  const Eigen::Index half = GetParam();
  const std::vector<double> weights = randomNumbers(half);
  const std::vector<double> z = randomNumbers(2 * half);
  std::vector<double> sizes(static_cast<std::size_t>(half));
  for (std::size_t n = 0; n < sizes.size(); ++n)
  {
    sizes[n] = std::abs(z[n]) + std::abs(z[sizes.size() + n]);
  }
  EXPECT_EQ(weightedSize(weights.data(), z.data(), half), dotInLanes(weights.data(), sizes.data(), half));
}

TEST_P(Lanes, multipliesTwoVectors)
{
  const Eigen::Index rows = GetParam();
  const Eigen::Index columns = rows + 1;
  const std::vector<double> matrix = randomNumbers(rows * columns);
  const std::vector<double> x = randomNumbers(columns);
  const std::vector<double> y = randomNumbers(columns);
  std::vector<double> x_to(static_cast<std::size_t>(rows));
  std::vector<double> y_to = x_to;
  multiplyTwo(matrix.data(), rows, columns, x.data(), y.data(), x_to.data(), y_to.data());
  for (std::size_t row = 0; row < x_to.size(); ++row)
  {
    double x_sum = 0.0;
    double y_sum = 0.0;
    for (std::size_t column = 0; column < x.size(); ++column)
    {
      x_sum += matrix[column * x_to.size() + row] * x[column];
      y_sum += matrix[column * x_to.size() + row] * y[column];
    }
    EXPECT_EQ(x_to[row], x_sum);
    EXPECT_EQ(y_to[row], y_sum);
  }
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
