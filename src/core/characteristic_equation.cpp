#include "vibro_impact/core/characteristic_equation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace vibro_impact::core
{
double evaluatePolynomial(const std::vector<double>& coefficients, double x)
{
  double sum = 0.0;
  for (auto coefficient = coefficients.rbegin(); coefficient != coefficients.rend(); ++coefficient)
  {
    sum = sum * x + *coefficient;
  }
  return sum;
}

CharacteristicEquation::CharacteristicEquation(double stiffness, Eigen::ArrayXd poles,
                                               const Eigen::ArrayXd& deflections, std::vector<double> series)
    : compliance_(1.0 / stiffness), poles_(std::move(poles)), weights_(deflections.square()), series_(std::move(series))
{
}

Eigen::Index CharacteristicEquation::rootCount() const
{
  return series_.empty() ? poles_.size() : poles_.size() - 1;
}

double CharacteristicEquation::value(const Root& root) const
{
  return poles_(root.nearest_pole) + root.distance;
}

Eigen::ArrayXd CharacteristicEquation::distances(const Root& root) const
{
  return (poles_ - poles_(root.nearest_pole)) - root.distance;
}

double CharacteristicEquation::remainder(const Root& root) const
{
  const double origin = poles_(root.nearest_pole);
  double sum = compliance_ + evaluatePolynomial(series_, value(root));
  for (Eigen::Index m = 0; m < poles_.size(); ++m)
  {
    if (m != root.nearest_pole)
    {
      sum += weights_(m) / ((poles_(m) - origin) - root.distance);
    }
  }
  return sum;
}

double CharacteristicEquation::slope(const Root& root) const
{
  std::vector<double> derivative;
  for (std::size_t j = 1; j < series_.size(); ++j)
  {
    derivative.push_back(static_cast<double>(j) * series_[j]);
  }
  return (weights_ / distances(root).square()).sum() + evaluatePolynomial(derivative, value(root));
}

CharacteristicEquation::Root CharacteristicEquation::root(Eigen::Index index) const
{
  // With the nearest pole as origin, f = 0 reads  distance = weight/remainder(distance),  and the remainder rises with
  // x. So its value at the far end of the search bounds the distance from below, away from zero.
  Root root;
  double far_end = 0.0;  // of |distance|
  double sign = 1.0;
  if (index + 1 < poles_.size())
  {
    const double width = poles_(index + 1) - poles_(index);
    far_end = 0.5 * width;
    root = Root{index, far_end};
    const double middle = remainder(root) - weights_(index) / far_end;
    if (middle < 0.0)  // the root lies in the upper half
    {
      sign = -1.0;
      root.nearest_pole = index + 1;
    }
  }
  else
  {
    far_end = weights_.sum() / compliance_;
    root.nearest_pole = index;
  }

  const double weight = weights_(root.nearest_pole);
  root.distance = sign * far_end;
  const double greatest = sign * remainder(root);
  double low = greatest > 0.0 ? std::min(weight / greatest, far_end) : far_end;
  double high = far_end;
  // Bisection of the logarithm of the distance: some sixty steps for any root, to the last bit, with nothing to go
  // wrong.
  while (high > low * (1.0 + 2.0 * std::numeric_limits<double>::epsilon()))
  {
    const double middle = std::sqrt(low) * std::sqrt(high);
    if (middle <= low || middle >= high)
    {
      break;
    }
    root.distance = sign * middle;
    if (sign * remainder(root) * middle < weight)
    {
      low = middle;
    }
    else
    {
      high = middle;
    }
  }
  root.distance = sign * high;
  return root;
}

}  // namespace vibro_impact::core
