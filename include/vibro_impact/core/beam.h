#pragma once

#include <memory>
#include <vector>

#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/structure.h"

namespace vibro_impact::core
{
class UnitBeam;

/// A uniform Euler-Bernoulli beam with any ends, possibly with a rigid body at its middle. Modes of the beam alone and
/// all static deflections are closed forms; those of a beam with a body are roots of its exact dynamic stiffness, none
/// of which is missed (doc/structures/beam.md, doc/structures/beam_with_rigid_body.md).
class Beam : public Structure
{
public:
  /// `parameters` must have passed validate().
  explicit Beam(const BeamParameters& parameters);
  ~Beam() override;
  Beam(const Beam&) = delete;
  Beam& operator=(const Beam&) = delete;

  int modeCount() const override
  {
    return unlimited;
  }

  /// 2 for two free ends: the translation, then the rotation about the centre of mass. 1 for a pinned and a free one:
  /// the rotation about the pin. Else 0.
  int rigidBodyModeCount() const override;

  Mode mode(int m) const override;
  double staticReceptance(int kept) const override;
  double staticBaseResponse(int kept) const override;
  double receptance(double omega) const override;

  /// Mode m = 1, 2, ... along the beam: phi_m at the distances `x` (m, 0 to the beam's length) from the first end,
  /// kg^-1/2; at the contact location what mode() says. Throws std::invalid_argument for a point off the beam.
  std::vector<double> modeShape(int m, const std::vector<double>& x) const;

  /// Static deflection of the points `x` under a unit force at the contact point without the part of the lowest `kept`
  /// modes, m/N; at the contact location it is staticReceptance(). The attachment shape is this, mass-normalised.
  /// Throws as modeShape() does.
  std::vector<double> staticShape(int kept, const std::vector<double>& x) const;

private:
  std::vector<long double> dimensionless(const std::vector<double>& x) const;

  // One beam of unit length, bending stiffness and mass per length, and the units that make it this one. Beams that
  // differ in scale only thus agree to the last bits in what is left of a static deflection by the kept modes, which is
  // the small difference of two sums: these are taken in higher precision and scaled at the end.
  std::unique_ptr<const UnitBeam> beam_;
  double length_;           // m
  double frequency_unit_;   // sqrt(E I/m')/L^2, rad/s
  double mass_unit_;        // m' L, kg
  double compliance_unit_;  // L^3/(E I), m/N
};

}  // namespace vibro_impact::core
