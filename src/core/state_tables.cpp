#include "state_tables.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "gap_stretch.h"

namespace vibro_impact::core
{
namespace
{
/// Whether a coordinate without stiffness moves the gap.
bool hasFreeBody(const LinearState& linear)
{
  return (linear.frequency == 0.0 && linear.contact_deflection != 0.0).any();
}
}  // namespace

StateTables::StateTables(const SwitchedModel& model, int state, bool phasor)
    : linear(state == 0 ? &model.free() : &model.contact()),
      half(padded(linear->size() + (phasor ? 1 : 0))),
      phasor_(phasor)
{
  const Eigen::Index modes = linear->size();
  const Eigen::ArrayXd squared = linear->frequency.square();
  const auto elastic = [this](const Eigen::ArrayXd& values) -> Eigen::ArrayXd
  { return (linear->frequency > 0.0).select(values, 0.0); };
  bodies = (linear->frequency == 0.0).count();
  decay = linear->damping_ratio * linear->frequency;
  damped = linear->frequency * (1.0 - linear->damping_ratio.square()).sqrt();
  compliance = elastic(linear->participation / squared);
  lag = elastic(2.0 * linear->damping_ratio * linear->participation / (squared * linear->frequency));
  standing = elastic(linear->preload / squared);
  transfer_re = transfer_im = Eigen::ArrayXd::Zero(modes);

  for (Eigen::Index n = 0; n < bodies; ++n)
  {
    if (linear->contact_deflection(n) != 0.0)
    {
      gap_body = n;
      body_deflection = linear->contact_deflection(n);
      body_pull = linear->contact_deflection(n) * linear->participation(n);
    }
  }

  line_constant = linear->gap + (linear->contact_deflection * standing).sum();
  if (state == 1 && hasFreeBody(model.free()))
  {
    line_constant = 0.0;  // nothing presses a free body against the spring
  }
  line_compliance = (linear->contact_deflection * compliance).sum();
  line_lag = (linear->contact_deflection * lag).sum();

  kick = Eigen::VectorXd::Zero(2 * half);
  kick.head(modes) = -lag;
  kick.segment(half, modes) = -elastic((compliance - decay * lag) / damped);

  derivative = Eigen::MatrixXd::Zero(2 * half, highest_derivative + 2);
  magnitude = Eigen::MatrixXd::Zero(half, highest_derivative + 2);
  for (Eigen::Index n = bodies; n < modes; ++n)
  {
    const std::complex<double> lambda(-decay(n), damped(n));
    const double weight = linear->contact_deflection(n);
    std::complex<double> factor = weight / lambda;
    for (Eigen::Index column = 0; column < derivative.cols(); ++column)
    {
      derivative(n, column) = factor.real();
      derivative(half + n, column) = -factor.imag();
      magnitude(n, column) = std::abs(weight) * std::pow(linear->frequency(n), static_cast<double>(column));
      factor = column == 0 ? std::complex<double>(weight) : factor * lambda;
    }
  }
  kick_gap_integral = derivative.col(0).dot(kick);
  energy.tabulate(*linear, kick);

  conversion = Eigen::MatrixXd::Zero(padded(modes), 8);
  conversion.topRows(modes).leftCols(5) << standing, compliance, lag, decay, damped;
  for (Eigen::Index n = 0; n < modes; ++n)
  {
    conversion(n, 5) = n < bodies ? -1.0 : 1.0 / damped(n);
  }

  mapping = Eigen::MatrixXd::Zero(padded(modes), (state == 0 ? model.contact() : model.free()).size());
  if (state == 0)
  {
    mapping.topRows(modes) = model.mapping();
  }
  else
  {
    mapping.topRows(modes) = model.mapping().transpose();
  }
}

void StateTables::setGrid(const TickGrid& grid, double drive_frequency, double drive_amplitude)
{
  shortest_stride_ = grid.shortest_stride;
  tabulateFactors(grid, drive_frequency);
  if (phasor_)
  {
    tabulatePhasor(drive_frequency, drive_amplitude);
  }
  tabulateSpread(grid, drive_frequency);
}

void StateTables::tabulateFactors(const TickGrid& grid, double drive_frequency)
{
  const Eigen::Index columns = grid.doublings - grid.shortest_stride + 1;
  factor_re.resize(half, columns);
  factor_im.resize(half, columns);
  for (Eigen::Index column = 0; column < columns; ++column)
  {
    const double time = std::ldexp(grid.tick, grid.shortest_stride + static_cast<int>(column));
    for (Eigen::Index n = 0; n < half; ++n)  // the modes, the phasor, the padding
    {
      const double shrinkage = n < modes() ? std::expm1(-decay(n) * time) : 0.0;
      const double angle = (n < modes() ? damped(n) : drive_frequency) * time;
      const double half_sine = std::sin(0.5 * angle);
      factor_re(n, column) = shrinkage * std::cos(angle) - 2.0 * half_sine * half_sine;
      factor_im(n, column) = (1.0 + shrinkage) * std::sin(angle);
    }
  }
  exponent_re = exponent_im = Eigen::ArrayXd::Zero(half);
  exponent_re.head(modes()) = -decay * grid.tick;
  exponent_im.head(modes()) = damped * grid.tick;
  if (phasor_)
  {
    exponent_im(modes()) = drive_frequency * grid.tick;
  }
}

void StateTables::tabulatePhasor(double drive_frequency, double drive_amplitude)
{
  const double omega = drive_frequency;
  const Eigen::Index phasor = modes();
  const std::complex<double> i_omega(0.0, omega);
  std::complex<double> weight = 0.0;
  for (Eigen::Index n = 0; n < modes(); ++n)
  {
    const double natural = linear->frequency(n);
    const std::complex<double> dynamic_stiffness((natural - omega) * (natural + omega),
                                                 2.0 * linear->damping_ratio(n) * natural * omega);
    std::complex<double> transfer = 0.0;
    if (linear->participation(n) != 0.0)
    {
      transfer = -linear->participation(n) / dynamic_stiffness;
    }
    transfer_re(n) = transfer.real();
    transfer_im(n) = transfer.imag();
    weight += linear->contact_deflection(n) * transfer;
  }
  std::complex<double> factor = weight / i_omega;
  for (Eigen::Index column = 0; column < derivative.cols(); ++column)
  {
    derivative(phasor, column) = factor.real();
    derivative(half + phasor, column) = -factor.imag();
    magnitude(phasor, column) = std::abs(weight) * std::pow(omega, static_cast<double>(column));
    factor = column == 0 ? weight : factor * i_omega;
  }
  conversion.col(6).head(phasor) = transfer_re;
  conversion.col(7).head(phasor) = transfer_im;
  energy.tabulateHarmonic(*linear, omega, drive_amplitude, transfer_re, transfer_im);
}

void StateTables::tabulateSpread(const TickGrid& grid, double drive_frequency)
{
  const Eigen::Index columns = grid.doublings - grid.shortest_stride + 1;
  bulge_.setZero(half, columns);
  flat_.setZero(3 * half, columns);
  slow_bulge_.setZero(half, columns);
  slow_flat_.setZero(3 * half, columns);
  slow_forms_.setZero(6 * half, columns);
  first_flat_ = first_slow_ = grid.doublings + 1;
  for (int k = grid.doublings; k >= grid.shortest_stride; --k)
  {
    const Eigen::Index column = k - grid.shortest_stride;
    const double time = std::ldexp(grid.tick, k);
    for (Eigen::Index n = 0; n < modes() + (phasor_ ? 1 : 0); ++n)
    {
      const double weight = magnitude(n, 0);
      if (weight == 0.0)
      {
        continue;
      }
      const double omega = n < modes() ? linear->frequency(n) : drive_frequency;
      const Spread unit = spreadOfCosine(omega, time);
      bulge_(n, column) = weight * unit.bulge;
      flat_(n, column) = weight * unit.flat;
      flat_(half + n, column) = weight * unit.flat_rate;
      // This column serves down to half its width, where the acceleration can be farther off.
      flat_(2 * half + n, column) =
          weight * std::max(unit.flat_acceleration, spreadOfCosine(omega, 0.5 * time).flat_acceleration);
      first_flat_ = unit.flat > 0.0 ? k : first_flat_;
      if (isTooFast(omega, time))
      {
        first_slow_ = k;
        slow_flat_(n, column) = weight;
        slow_flat_(half + n, column) = weight * omega;
        continue;
      }
      slow_bulge_(n, column) = weight * unit.bulge;
      for (Eigen::Index form = 0; form < 3; ++form)
      {
        slow_forms_(2 * half * form + n, column) = derivative(n, form + 1);
        slow_forms_(2 * half * form + half + n, column) = derivative(half + n, form + 1);
      }
    }
  }
  // A cosine is within x^2/8 of its chord, and within 2.
  sag = sag_rate = Eigen::VectorXd::Zero(half);
  for (Eigen::Index n = 0; n < modes(); ++n)
  {
    const double x = linear->frequency(n) * grid.length;
    sag(n) = magnitude(n, 0) * std::min(2.0, x * x / 8.0);
    sag_rate(n) = linear->frequency(n) * sag(n);
  }
  kick_sag = weightedSize(sag.data(), kick.data(), half);
  kick_sag_rate = weightedSize(sag_rate.data(), kick.data(), half);
}

}  // namespace vibro_impact::core
