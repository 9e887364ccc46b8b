#include "vibro_impact/core/pinned_beam.h"

#include <cmath>

namespace vibro_impact::core
{
namespace
{
constexpr double pi = 3.14159265358979323846;

/// sin(pi x), exactly zero at every integer, and where x misses an integer only by the rounding of a contact location:
/// a node at the contact is a node, not a mode that moves it by 1e-16.
double sinPi(double x)
{
  const double reduced = std::remainder(x, 2.0);  // exact, in [-1, 1]
  const double value = std::abs(reduced) > 0.5 ? std::copysign(std::sin(pi * (1.0 - std::abs(reduced))), reduced)
                                               : std::sin(pi * reduced);
  return std::abs(value) < 1.0e-12 ? 0.0 : value;
}
}  // namespace

PinnedBeam::PinnedBeam(const BeamParameters& parameters)
    : length_(parameters.length),
      bending_stiffness_(parameters.youngs_modulus * parameters.width * std::pow(parameters.height, 3) / 12.0),
      mass_per_length_(parameters.density * parameters.width * parameters.height),
      location_(parameters.contact_location / parameters.length)
{
}

Mode PinnedBeam::mode(int m) const
{
  const double wave_number = m * pi / length_;
  const double mass = mass_per_length_ * length_;
  Mode mode;
  mode.frequency = wave_number * wave_number * std::sqrt(bending_stiffness_ / mass_per_length_);
  mode.contact_deflection = std::sqrt(2.0 / mass) * sinPi(m * location_);
  mode.participation = m % 2 == 1 ? 2.0 * std::sqrt(2.0 * mass) / (m * pi) : 0.0;
  return mode;
}

double PinnedBeam::staticReceptance() const
{
  const double product = location_ * (1.0 - location_);
  return product * product * std::pow(length_, 3) / (3.0 * bending_stiffness_);
}

double PinnedBeam::staticBaseResponse() const
{
  const double a = location_;
  return mass_per_length_ * std::pow(length_, 4) * a * (1.0 - 2.0 * a * a + a * a * a) / (24.0 * bending_stiffness_);
}

double PinnedBeam::receptance(double omega) const
{
  const double a = location_;
  const double lambda = length_ * std::sqrt(std::abs(omega) * std::sqrt(mass_per_length_ / bending_stiffness_));

  // Far below the first mode the two terms of the closed form cancel: expand sum_m phi_m^2/(omega_m^2 - omega^2) in
  // omega^2. At lambda = 0.2 the terms fall by (0.2/pi)^4 = 2e-5 each.
  if (lambda < 0.2)
  {
    double sum = staticReceptance();
    for (int order = 1; order <= 3; ++order)
    {
      double coefficient = 0.0;
      for (int m = 1; m <= 200; ++m)  // the terms fall as m^-8 or faster
      {
        const Mode mode = this->mode(m);
        coefficient += mode.contact_deflection * mode.contact_deflection / std::pow(mode.frequency, 2 * order + 2);
      }
      sum += coefficient * std::pow(omega, 2 * order);
    }
    return sum;
  }

  // The hyperbolic term written with exponentials of negative numbers only: nothing overflows.
  const double hyperbolic =
      -0.5 * std::expm1(-2.0 * lambda * a) * std::expm1(-2.0 * lambda * (1.0 - a)) / std::expm1(-2.0 * lambda);
  // At a natural frequency with a node at the contact the trigonometric term is 0/0 with a double zero above: its limit
  // is 0.
  const double sine = sinPi(lambda / pi);
  const double numerator = sinPi(lambda * a / pi) * sinPi(lambda * (1.0 - a) / pi);
  const double trigonometric = numerator == 0.0 ? 0.0 : numerator / sine;
  return std::pow(length_ / lambda, 3) / (2.0 * bending_stiffness_) * (trigonometric - hyperbolic);
}

}  // namespace vibro_impact::core
