#pragma once

#include <Eigen/Core>

#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
/// Work of the base and dissipation in one state from one switch to the next, each in closed form: what the integrals
///
///   W = -integral a sum Gamma_n eta_n' dt        D = integral sum 2 zeta_n omega_n eta_n'^2 dt
///
/// are at the end of the span less what they are at its start. Vectors of exponentials z are [Re z; Im z] as
/// SwitchedMotion keeps them, with `half` of each.
///
/// Linear drive, with delta = zeta omega, c = Gamma/omega^2, l = 2 zeta Gamma/omega^3, sums over n understood:
///
///   q  = sum Gamma eta = const - C a + L s + sum Gamma Re z,      C = sum Gamma c,   L = sum Gamma l
///   W' = -(a q)' + s q,                                           integral Re z dt = Re z/lambda
///   D' = 2 delta (Re(lambda z) - c s)^2,                          integral Re(lambda z)^2 dt = (Re(lambda z^2) -
///                                                                 |lambda z|^2/delta)/4
///
/// From sample to sample z is multiplied and then kicked by k (s_new - s_old), k a constant vector. All antiderivatives
/// are linear or quadratic in z, so that they cancel from sample to sample but for a form that is linear in z times the
/// change of the slope: what must be kept on the way is sum (s_new - s_old) z alone.
///
/// Harmonic drive D = Re d, d' = i Omega d: products of exponentials throughout, nothing to keep on the way.
///
/// A coordinate without stiffness has no damping, and the work on it is the change of its kinetic energy.
class SpanEnergy
{
public:
  struct Amounts
  {
    double work = 0.0;        // J
    double dissipated = 0.0;  // J
  };

  /// Where the drive stands.
  struct Moment
  {
    double acceleration = 0.0, slope = 0.0;  // of the linear drive
    double drive_re = 0.0, drive_im = 0.0;   // d
    double time = 0.0;                       // linear drive: since the last sample; harmonic: on any axis
    double body_energy = 0.0;                // kinetic, of the coordinates without stiffness
  };

  /// `kick` has the size of the vectors of exponentials.
  void tabulate(const LinearState& linear, const Eigen::VectorXd& kick);
  /// The same for a harmonic drive -amplitude cos(Omega t); H_n is given by its two parts.
  void tabulateHarmonic(const LinearState& linear, double frequency, double amplitude,
                        const Eigen::ArrayXd& transfer_re, const Eigen::ArrayXd& transfer_im);

  /// Begins a span.
  void open(const Eigen::VectorXd& z, const Moment& now);
  /// At a sample: the slope, until now `slope` for `length`, changes by `change`. Whoever kicks z adds  change z  as it
  /// is before to kicks().
  void pass(double change, double slope, double length)
  {
    passed_.squared_changes += change * change;
    passed_.squared_slope += slope * slope * length;
  }
  struct Passed
  {
    double squared_changes = 0.0;  // of the slope
    double squared_slope = 0.0;    // integral over the intervals that have ended
  };
  /// The same for whoever passes many samples at once.
  Passed& passed()
  {
    return passed_;
  }
  double* kicks()
  {
    return kicks_.data();
  }
  /// From the start of the span to now.
  Amounts upTo(const Eigen::VectorXd& z, const Moment& now) const;

private:
  /// What the two integrals are, but for what is kept on the way.
  Amounts antiderivatives(const Eigen::VectorXd& z, const Moment& now) const;
  double quadratic(const Eigen::VectorXd& z) const;

  bool harmonic_ = false;
  // Quadratic part of the dissipation: [coefficients of Re^2; of Im^2] and of Re Im.
  Eigen::VectorXd squares_, products_;
  // Forms, linear in z, and forms of the kick.
  Eigen::VectorXd participation_;  // sum Gamma Re z
  Eigen::VectorXd integral_;       // sum Gamma Re z/lambda
  Eigen::VectorXd damping_;        // sum 4 delta c Re z
  Eigen::VectorXd kicked_;         // dissipation per kick
  double compliance_ = 0.0;        // C
  double lag_ = 0.0;               // L
  double drag_ = 0.0;              // sum 2 delta c^2
  double integral_of_kick_ = 0.0, damping_of_kick_ = 0.0, squares_of_kick_ = 0.0;
  // Forms that multiply the two parts of d, and the terms without z.
  Eigen::MatrixXd drive_forms_;  // columns: work with Re d and with Im d, dissipation with Re d and with Im d
  double work_drive_re_ = 0.0, work_drive_im_ = 0.0, work_rate_ = 0.0;  // coefficients of Re d^2, Im d^2, time
  double dissipation_drive_re_ = 0.0, dissipation_drive_im_ = 0.0, dissipation_rate_ = 0.0;

  Amounts start_;
  Eigen::VectorXd kicks_;  // sum of slope changes times z
  Passed passed_;
};

}  // namespace vibro_impact::core
