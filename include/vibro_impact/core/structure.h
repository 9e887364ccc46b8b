#pragma once

#include <limits>
#include <memory>
#include <optional>

#include "vibro_impact/core/parameters.h"

namespace vibro_impact::core
{
/// One mass-normalised mode of a structure, seen from the contact point and from the base.
struct Mode
{
  double frequency = 0.0;           ///< natural frequency omega, rad/s; 0: a rigid-body mode
  double contact_deflection = 0.0;  ///< mode shape at the contact point phi(x_c), kg^-1/2
  double participation = 0.0;       ///< participation factor in base motion Gamma = integral of m phi dx, kg^1/2
  std::optional<double> damping_ratio = std::nullopt;  ///< while apart; none: that of the configuration
};

/// A linear elastic structure on supports that follow the base, seen only through its modal data at the contact point.
///
/// Its displacement relative to the base is v = sum_m phi_m eta_m; under a base acceleration a(t) and a force F(t) at
/// the contact point each mode obeys  eta_m'' + 2 zeta omega_m eta_m' + omega_m^2 eta_m = -Gamma_m a + phi_m(x_c) F.
class Structure
{
public:
  /// What modeCount() says of a structure that has a closed form for every mode.
  static constexpr int unlimited = std::numeric_limits<int>::max();

  virtual ~Structure() = default;

  /// How many modes are known: 0 for a rigid surface, `unlimited` where there is a closed form.
  virtual int modeCount() const = 0;

  /// How many of them, the first ones, have frequency zero.
  virtual int rigidBodyModeCount() const = 0;

  /// Mode m = 1, 2, ... modeCount(), by ascending frequency.
  virtual Mode mode(int m) const = 0;

  /// Static deflection of the contact point under a unit force there without the part of the lowest `kept` modes,
  /// sum_{m > kept} phi_m^2/omega_m^2, m/N; kept >= rigidBodyModeCount().
  virtual double staticReceptance(int kept) const = 0;

  /// The same under a unit base deceleration, sum_{m > kept} phi_m Gamma_m/omega_m^2, s^2.
  virtual double staticBaseResponse(int kept) const = 0;

  /// Undamped point receptance alpha(omega) = sum_m phi_m^2/(omega_m^2 - omega^2) at the contact point, m/N, all modes.
  /// Infinite at a natural frequency whose mode moves the contact point.
  virtual double receptance(double omega) const = 0;
};

/// The structure that the parameters, which must have passed validate(), describe; none for a rigid surface.
std::unique_ptr<const Structure> makeStructure(const StructureParameters& parameters);

}  // namespace vibro_impact::core
