#pragma once

#include <memory>

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

private:
  // One beam of unit length, bending stiffness and mass per length, and the units that make it this one. Beams that
  // differ in scale only thus agree to the last bits in what is left of a static deflection by the kept modes, which is
  // the small difference of two sums: these are taken in higher precision and scaled at the end.
  std::unique_ptr<const UnitBeam> beam_;
  double frequency_unit_;   // sqrt(E I/m')/L^2, rad/s
  double mass_unit_;        // m' L, kg
  double compliance_unit_;  // L^3/(E I), m/N
};

}  // namespace vibro_impact::core
