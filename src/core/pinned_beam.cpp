#include "vibro_impact/core/pinned_beam.h"

#include <cmath>

namespace vibro_impact::core
{
namespace
{
constexpr long double precise_pi = 3.14159265358979323846L;
constexpr auto pi = static_cast<double>(precise_pi);

/// sin(pi x), exactly zero at every integer, and where x misses an integer only by the rounding of a contact location:
/// a node at the contact is a node, not a mode that moves it by 1e-16.
template <typename Real>
Real sinPi(Real x)
{
  constexpr auto real_pi = static_cast<Real>(precise_pi);
  const Real reduced = std::remainder(x, Real{2});  // exact, in [-1, 1]
  const Real value = std::abs(reduced) > Real{0.5} ? std::copysign(std::sin(real_pi * (1 - std::abs(reduced))), reduced)
                                                   : std::sin(real_pi * reduced);
  return std::abs(value) < Real{1.0e-12} ? 0 : value;
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

// What the kept modes leave of the static deflections is the small difference of two sums. Both depend on the contact
// location alone, are taken in higher precision, and are scaled at the end: beams that differ in scale only, such as in
// their width, agree to the last bits in what is left, too.

double PinnedBeam::staticReceptance(int kept) const
{
  // phi_m^2/omega_m^2 = 2 L^3/(pi^4 E I) sin^2(m pi a)/m^4
  const long double a = location_;
  long double sum = std::pow(precise_pi, 4.0L) * a * a * (1 - a) * (1 - a) / 6;
  for (int m = 1; m <= kept; ++m)
  {
    const long double share = sinPi(m * a) / (static_cast<long double>(m) * m);
    sum -= share * share;
  }
  return static_cast<double>(sum) * 2.0 * std::pow(length_, 3) / (std::pow(pi, 4) * bending_stiffness_);
}

double PinnedBeam::staticBaseResponse(int kept) const
{
  // phi_m Gamma_m/omega_m^2 = 4 m' L^4/(pi^5 E I) sin(m pi a)/m^5 for odd m, 0 for even ones
  const long double a = location_;
  long double sum = std::pow(precise_pi, 5.0L) * a * (1 - 2 * a * a + a * a * a) / 96;
  for (int m = 1; m <= kept; m += 2)
  {
    sum -= sinPi(m * a) / std::pow(static_cast<long double>(m), 5.0L);
  }
  return static_cast<double>(sum) * 4.0 * mass_per_length_ * std::pow(length_, 4) /
         (std::pow(pi, 5) * bending_stiffness_);
}

double PinnedBeam::receptance(double omega) const
{
  const double a = location_;
  const double lambda = length_ * std::sqrt(std::abs(omega) * std::sqrt(mass_per_length_ / bending_stiffness_));

  // Far below the first mode the two terms of the closed form cancel: expand sum_m phi_m^2/(omega_m^2 - omega^2) in
  // omega^2. At lambda = 0.2 the terms fall by (0.2/pi)^4 = 2e-5 each.
  if (lambda < 0.2)
  {
    double sum = staticReceptance(0);
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
