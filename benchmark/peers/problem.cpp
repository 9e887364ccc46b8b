#include "problem.h"

#include <stdexcept>

namespace vibro_impact::peers
{
namespace
{
constexpr double two_pi = 6.28318530717958647693;

State dimensionless(const core::LinearState& linear, double frequency, double deflection, double participation)
{
  State state;
  const Eigen::ArrayXd omega = linear.frequency / frequency;
  state.stiffness = omega.square();
  state.damping = 2.0 * linear.damping_ratio * omega;
  state.load = linear.participation / participation;  // -Gamma a(t) with a(t) = -cos(Omega t)
  state.deflection = linear.contact_deflection.matrix() / deflection;
  return state;
}
}  // namespace

Problem::Problem(const core::SwitchedModel& model, double omega_star)
    : mapping(model.mapping()), drive_frequency(omega_star), cycle(two_pi / omega_star)
{
  if (model.clearance() != 0.0)
  {
    throw std::invalid_argument("clearance: " + std::to_string(model.clearance()) + " m; allowed: 0");
  }
  const core::LinearState& free = model.free();
  const double frequency = free.frequency(0);
  const double deflection = free.contact_deflection(0);
  const double participation = free.participation(0);
  states = {dimensionless(free, frequency, deflection, participation),
            dimensionless(model.contact(), frequency, deflection, participation)};
  time_unit = 1.0 / frequency;
  gap_unit = deflection * participation / (frequency * frequency);
}
}  // namespace vibro_impact::peers
