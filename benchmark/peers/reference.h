#pragma once

#include <complex>
#include <vector>

#include "problem.h"

namespace vibro_impact::peers
{
/// The trajectory all others are compared with: the closed form of each state in long double, every exponential
/// evaluated by the C library from the last switch, switches searched by steps that cannot pass one and finished by
/// Newton's method. It shares the modal data with the rest of the package, and no code of the advance.
class Reference
{
public:
  /// From rest to the time `end`; at every switch the displacement is scaled by 1 + `disturbance`. Throws
  /// std::runtime_error where the state in which the motion starts is not defined.
  Reference(const Problem& problem, double end, double disturbance = 0.0);

  double gap(double time) const;

  /// Times of all switches, dimensionless.
  const std::vector<double>& switches() const
  {
    return switches_;
  }
  int initialState() const
  {
    return segments_.front().state;
  }
  /// Greatest magnitude of the gap.
  double greatestGap() const
  {
    return greatest_gap_;
  }

private:
  using Real = long double;
  using Complex = std::complex<Real>;

  struct Segment
  {
    Real start;
    int state;
    std::vector<Complex> amplitude;  // z at the start
  };
  struct Terms
  {
    std::vector<Complex> lambda;
    std::vector<Complex> transfer;  // response per unit of exp(i Omega t)
    std::vector<Real> deflection;
    Complex gap_transfer;
  };

  Complex driveTerm(Real time) const;
  /// The derivative of the gap of this order.
  Real derivative(const Segment& segment, Real time, int order) const;
  /// Bounds that derivative from `time` on.
  Real bound(const Segment& segment, Real time, int order) const;
  Segment switched(const Segment& segment, Real time) const;

  Eigen::MatrixXd mapping_;
  Real drive_frequency_;
  Real disturbance_;
  Terms terms_[2];
  std::vector<Segment> segments_;
  std::vector<double> switches_;
  double greatest_gap_ = 0.0;
};
}  // namespace vibro_impact::peers
