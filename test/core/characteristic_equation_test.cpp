#include "vibro_impact/core/characteristic_equation.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "eigenmodes.h"

using namespace vibro_impact::core;

namespace
{
/// Roots in (p_j, p_j+1), at any distance from the poles, satisfy the equation as well as their rounding allows.
void expectRoots(double stiffness, const Eigen::ArrayXd& poles, const Eigen::ArrayXd& deflections)
{
  const CharacteristicEquation equation(stiffness, poles, deflections);
  ASSERT_EQ(equation.rootCount(), poles.size());
  for (Eigen::Index n = 0; n < poles.size(); ++n)
  {
    const CharacteristicEquation::Root root = equation.root(n);
    const Eigen::ArrayXd distances = equation.distances(root);
    EXPECT_LT(distances(n), 0.0) << "root " << n << " must lie above its pole";
    if (n + 1 < poles.size())
    {
      EXPECT_GT(distances(n + 1), 0.0) << "root " << n << " must lie below the next pole";
    }
    const Eigen::ArrayXd terms = deflections.square() / distances;
    EXPECT_NEAR(1.0 / stiffness + terms.sum(), 0.0, 1e-13 * (1.0 / stiffness + terms.abs().sum())) << "root " << n;
  }
}
}  // namespace

TEST(CharacteristicEquation, ofOneModeIsThatOfASpringAdded)
{
  Eigen::ArrayXd pole(1);
  Eigen::ArrayXd deflection(1);
  pole << 100.0;
  deflection << 0.1;
  const CharacteristicEquation equation(1e6, pole, deflection);
  EXPECT_NEAR(equation.value(equation.root(0)), 100.0 + 1e6 * 0.01, 1e-9);
}

TEST(CharacteristicEquation, hasOneRootBetweenPolesAtAnyStiffness)
{
  Eigen::ArrayXd poles(5);
  Eigen::ArrayXd deflections(5);
  poles << 1.0, 16.0, 81.0, 256.0, 625.0;
  deflections << 1.0, 0.3, 1e-5, 0.7, 2.0;
  for (const double stiffness : {1e-9, 1e-3, 1.0, 1e3, 1e9, 1e15})
  {
    SCOPED_TRACE(stiffness);
    expectRoots(stiffness, poles, deflections);
  }
}

TEST(CharacteristicEquation, separatesNearlyEqualPoles)
{
  Eigen::ArrayXd poles(4);
  Eigen::ArrayXd deflections(4);
  poles << 1.0, 1.0 + 1e-9, 1.0 + 3e-15, 7.0;
  std::sort(poles.data(), poles.data() + poles.size());
  deflections << 1.0, 1.0, 0.5, 1.0;
  for (const double stiffness : {1e-3, 1.0, 1e9})
  {
    SCOPED_TRACE(stiffness);
    expectRoots(stiffness, poles, deflections);
  }
}

TEST(CharacteristicEquation, agreesWithADenseEigenvalueSolver)
{
  Eigen::ArrayXd poles(6);
  Eigen::ArrayXd deflections(6);
  poles << 1.0, 2.5, 3.0, 10.0, 11.0, 40.0;
  deflections << 0.4, -1.0, 0.2, 0.9, -0.1, 1.5;
  const double stiffness = 3.7;
  Eigen::MatrixXd matrix = poles.matrix().asDiagonal();
  matrix += stiffness * deflections.matrix() * deflections.matrix().transpose();
  const Eigen::VectorXd expected = eigenmodes(matrix).values;
  const CharacteristicEquation equation(stiffness, poles, deflections);
  for (Eigen::Index n = 0; n < 6; ++n)
  {
    EXPECT_NEAR(equation.value(equation.root(n)), expected(n), 1e-12 * expected(5));
  }
}

TEST(CharacteristicEquation, slopeIsTheDerivativeOfBothSums)
{
  Eigen::ArrayXd poles(2);
  Eigen::ArrayXd deflections(2);
  poles << 1.0, 9.0;
  deflections << 1.0, 2.0;
  const CharacteristicEquation equation(5.0, poles, deflections, {0.01, 1e-4, 1e-6});
  ASSERT_EQ(equation.rootCount(), 1);
  const CharacteristicEquation::Root root = equation.root(0);
  const double x = equation.value(root);
  EXPECT_NEAR(1.0 / 5.0 + 1.0 / (1.0 - x) + 4.0 / (9.0 - x) + 0.01 + 1e-4 * x + 1e-6 * x * x, 0.0, 1e-14);
  const double expected = 1.0 / std::pow(1.0 - x, 2) + 4.0 / std::pow(9.0 - x, 2) + 1e-4 + 2e-6 * x;
  EXPECT_NEAR(equation.slope(root), expected, 1e-13 * expected);
}
