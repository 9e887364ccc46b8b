#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "lanes.h"
#include "span_energy.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
/// Time inside an interval is counted in ticks, 2^-doublings of the interval.
struct TickGrid
{
  double length = 0.0;  // of the interval, s
  double inverse_length = 0.0;
  double tick = 0.0;  // s
  int doublings = 0;
  /// Over 2^this ticks and less the series of the exponential function serves, over more the tabulated factors do.
  int shortest_stride = 0;

  std::int64_t ticks() const
  {
    return std::int64_t{1} << doublings;
  }
};

/// Everything about the motion in one state that the drive's form and the interval fix beforehand. Vectors of
/// exponentials are [Re z; Im z], each with `half` of the modes, the phasor of a harmonic drive and padding.
class StateTables
{
public:
  static constexpr int highest_derivative = 8;

  /// `state`: 0 or 1 of `model`. `phasor`: whether there is a harmonic drive besides the linear one.
  StateTables(const SwitchedModel& model, int state, bool phasor);

  /// Tabulates what depends on the interval. `drive_frequency` and `drive_amplitude` of the harmonic drive, if any. May
  /// allocate.
  void setGrid(const TickGrid& grid, double drive_frequency, double drive_amplitude);

  Eigen::Index modes() const
  {
    return linear->size();
  }
  /// The factors of growth, of ticks in units of 2^shortest_stride.
  Growth growth() const
  {
    return Growth{factor_re.data(), factor_im.data(), exponent_re.data(), exponent_im.data(), half};
  }
  /// Over 2^k ticks: weights of the spread of the gap about its stretch (GapStretch), the bulge and, one below the
  /// other, the flat part with its rate and acceleration.
  const double* bulgeWeights(int k) const
  {
    return bulge_.col(k - shortest_stride_).data();
  }
  const double* flatWeights(int k) const
  {
    return flat_.col(k - shortest_stride_).data();
  }
  bool hasFlat(int k) const
  {
    return k >= first_flat_;
  }
  /// Where modes are too fast for a step of 2^k ticks and are better left out: the same of a stretch without them, and
  /// the forms of value, rate and acceleration.
  bool leavesOut(int k) const
  {
    return k >= first_slow_;
  }
  const double* slowBulgeWeights(int k) const
  {
    return slow_bulge_.col(k - shortest_stride_).data();
  }
  const double* slowFlatWeights(int k) const
  {
    return slow_flat_.col(k - shortest_stride_).data();
  }
  const double* slowForms(int k) const
  {
    return slow_forms_.col(k - shortest_stride_).data();
  }

  const LinearState* linear;
  Eigen::Index half;
  Eigen::Index bodies = 0;                  // coordinates without stiffness, which come first
  Eigen::Index gap_body = -1;               // the one of them that moves the gap, or none
  double body_deflection = 0.0;             // its w
  double body_pull = 0.0;                   // w Gamma of that one
  Eigen::ArrayXd decay, damped;             // -Re lambda, Im lambda, per mode
  Eigen::ArrayXd compliance;                // Gamma/omega^2: quasi-static response to -a
  Eigen::ArrayXd lag;                       // 2 zeta Gamma/omega^3: response to the slope s
  Eigen::ArrayXd standing;                  // f/omega^2: response to the preload
  Eigen::ArrayXd transfer_re, transfer_im;  // H_n
  Eigen::VectorXd kick;                     // change of z per change of the slope s, [re; im]
  double kick_gap_integral = 0.0;           // its integral form
  // The line p(t) = line_constant - line_compliance a + line_lag s of the gap.
  double line_constant = 0.0, line_compliance = 0.0, line_lag = 0.0;
  Eigen::MatrixXd derivative;  // column j + 1: the form [re; im] of the j-th derivative of Re sum w z; 0: its integral
  Eigen::MatrixXd magnitude;   // column j: |w| |lambda|^j
  SpanEnergy energy;
  // How far the gap, and its rate, can be from the chord over an interval, and what a kick adds to that.
  Eigen::VectorXd sag, sag_rate;
  double kick_sag = 0.0, kick_sag_rate = 0.0;
  Eigen::MatrixXd conversion;               // of Conversion; a coordinate without stiffness is its own exponential
  Eigen::MatrixXd mapping;                  // to this state's coordinates, rows padded
  Eigen::ArrayXXd factor_re, factor_im;     // column j: exp(lambda tick 2^(shortest_stride + j)) - 1
  Eigen::ArrayXd exponent_re, exponent_im;  // lambda tick

private:
  void tabulateFactors(const TickGrid& grid, double drive_frequency);
  void tabulatePhasor(double drive_frequency, double drive_amplitude);
  void tabulateSpread(const TickGrid& grid, double drive_frequency);

  bool phasor_;
  int shortest_stride_ = 0;
  // Column k - shortest_stride.
  Eigen::MatrixXd bulge_, flat_, slow_bulge_, slow_flat_, slow_forms_;
  int first_flat_ = 0, first_slow_ = 0;  // k
};

}  // namespace vibro_impact::core
