#pragma once

#include <vector>

#include <Eigen/Core>

namespace vibro_impact::core
{
/// The characteristic equation of structures joined by a spring, 1/k + alpha_1(omega) + alpha_2(omega) = 0, with the
/// receptances as partial fractions in x = omega^2:
///
///   f(x) = 1/k + sum_m b_m^2/(p_m - x) + sum_j c_j x^j,        p_m = omega_m^2
///
/// The first sum runs over the modes that move the contact point, the power series stands for the modes above them
/// (c_j = sum of b^2/p^(j+1) over those; empty where there are none). f rises from -infinity to +infinity between two
/// consecutive poles, so that there is exactly one root in each such interval.
///
/// A root is kept as its nearest pole and its distance from that pole, to full relative accuracy: the differences p_m -
/// x, of which mode shapes are made, then stay accurate however close root and pole are (k -> 0, or nearly equal
/// frequencies).
class CharacteristicEquation
{
public:
  struct Root
  {
    Eigen::Index nearest_pole = 0;
    double distance = 0.0;  ///< x - p_nearest, (rad/s)^2
  };

  /// stiffness k > 0, N/m; poles p_m strictly ascending, >= 0, (rad/s)^2; deflections b_m != 0, one per pole, kg^-1/2.
  CharacteristicEquation(double stiffness, Eigen::ArrayXd poles, const Eigen::ArrayXd& deflections,
                         std::vector<double> series = {});

  /// How many roots can be asked for: one above each pole; where the series is not empty, one between each pair of
  /// poles.
  Eigen::Index rootCount() const;

  /// The root above pole `index`: below the next pole, or, above the last one, below p + k sum b^2.
  Root root(Eigen::Index index) const;

  /// x = omega^2 of a root.
  double value(const Root& root) const;

  /// p_m - x for every pole.
  Eigen::ArrayXd distances(const Root& root) const;

  /// df/dx = d(alpha_1 + alpha_2)/d(omega^2) = sum_m b_m^2/(p_m - x)^2 + ..., the squared norm of b_m/(p_m - x) over
  /// all modes.
  double slope(const Root& root) const;

private:
  /// f without the term of the nearest pole.
  double remainder(const Root& root) const;

  double compliance_;
  Eigen::ArrayXd poles_;
  Eigen::ArrayXd weights_;  // b_m^2
  std::vector<double> series_;
};

/// sum_j coefficients[j] x^j
double evaluatePolynomial(const std::vector<double>& coefficients, double x);

}  // namespace vibro_impact::core
