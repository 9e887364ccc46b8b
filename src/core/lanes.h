#pragma once

#include <Eigen/Core>

namespace vibro_impact::core
{
// Vectors in the advance of the model have a length that is a multiple of `lanes` (padded with zeros). There is no
// remainder to take care of, and every sum has one order, (l_0 + l_2) + (l_1 + l_3) of the lanes' sums, whatever
// instructions the processor has.

constexpr Eigen::Index lanes = 4;

inline Eigen::Index padded(Eigen::Index size)
{
  return (size + lanes - 1) / lanes * lanes;
}

/// z += z f, elementwise and complex, in place; real and imaginary parts apart. For the small steps that make up most
/// of a motion f is small, and the rounding of the factor 1 + f, which would add up, does not arise.
void growBy(double* re, double* im, const double* factor_re, const double* factor_im, Eigen::Index size);

/// x += factor y
void addScaled(double* x, double factor, const double* y, Eigen::Index size);

double dot(const double* x, const double* y, Eigen::Index size);

/// sum squares x^2 + squares' y^2 + products x y  over z = [x; y] and the squares' coefficients alike, `half` of each.
double quadraticForm(const double* z, const double* squares, const double* products, Eigen::Index half);

/// Values of two linear forms.
struct Forms
{
  double first, second;
};

/// kicked += change z, then z = (z + change kick)(1 + f), and of the new z the two linear forms `first` and `second`,
/// all in one pass; every array but the factors is [real parts; imaginary parts] with `half` of each.
Forms kickGrowEvaluate(double* z, double* kicked, double change, const double* kick, const double* factor_re,
                       const double* factor_im, const double* first, const double* second, Eigen::Index half);

}  // namespace vibro_impact::core
