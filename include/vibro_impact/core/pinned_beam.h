#pragma once

#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/structure.h"

namespace vibro_impact::core
{
/// A uniform Euler-Bernoulli beam of rectangular section, pinned at both ends, in closed form:
///   omega_m = (m pi/L)^2 sqrt(E I/m'),   phi_m(x) = sqrt(2/(m' L)) sin(m pi x/L),   Gamma_m = sqrt(2 m' L) (1 - cos m
///   pi)/(m pi)
/// with the mass per length m' = rho b h and I = b h^3/12.
class PinnedBeam : public Structure
{
public:
  /// `parameters` must have passed validate().
  explicit PinnedBeam(const BeamParameters& parameters);

  int modeCount() const override
  {
    return unlimited;
  }
  Mode mode(int m) const override;

  /// Of all modes a^2 (1 - a)^2 L^3/(3 E I) with a = x_c/L.
  double staticReceptance(int kept) const override;

  /// Of all modes the deflection under a uniform load, m' x (L^3 - 2 L x^2 + x^3)/(24 E I) at x = x_c.
  double staticBaseResponse(int kept) const override;

  /// With lambda = L (m' omega^2/(E I))^(1/4):
  ///   alpha = L^3/(2 E I lambda^3) [sin(lambda a) sin(lambda (1-a))/sin lambda - sinh(lambda a) sinh(lambda
  ///   (1-a))/sinh lambda]
  double receptance(double omega) const override;

  double bendingStiffness() const  ///< E I, N m^2
  {
    return bending_stiffness_;
  }
  double massPerLength() const  ///< kg/m
  {
    return mass_per_length_;
  }

private:
  double length_;
  double bending_stiffness_;
  double mass_per_length_;
  double location_;  // a = x_c/L, in (0, 1)
};

}  // namespace vibro_impact::core
