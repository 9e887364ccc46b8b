#pragma once

#include "vibro_impact/core/parameters.h"

namespace vibro_impact::core
{
/// Table 1 of the paper, beam 1, with the contact at midspan.
inline BeamParameters paperBeam()
{
  BeamParameters beam;
  beam.youngs_modulus = 1.66e9;
  beam.density = 954.0;
  beam.length = 0.0529;
  beam.cross_section = Rectangle{0.00127, 0.0127};
  beam.contact_location = 0.02645;
  return beam;
}

/// The beam that a structure is.
inline BeamParameters& beamOf(StructureParameters& structure)
{
  return std::get<BeamParameters>(structure);
}

/// E I/L^3 of that beam, N/m: k* = 1 is this contact stiffness.
inline double paperStiffnessUnit()
{
  const BeamParameters beam = paperBeam();
  return bendingStiffness(beam) / (beam.length * beam.length * beam.length);
}

/// The paper's limiting case with k* = k L^3/(E I) and the basis at choice.
inline SystemParameters limitingCase(double relative_stiffness, const BasisParameters& basis)
{
  SystemParameters parameters;
  parameters.beam1 = paperBeam();
  BeamParameters beam2 = paperBeam();
  beam2.youngs_modulus *= 1000.0;
  parameters.beam2 = beam2;
  parameters.contact = {relative_stiffness * paperStiffnessUnit(), 0.0};
  parameters.damping = {0.01, 0.05};
  parameters.basis = basis;
  return parameters;
}

/// The same with a rigid surface for beam 2.
inline SystemParameters rigidCase(double relative_stiffness, const BasisParameters& basis)
{
  SystemParameters parameters = limitingCase(relative_stiffness, basis);
  parameters.beam2 = RigidSurface{};
  return parameters;
}

}  // namespace vibro_impact::core
