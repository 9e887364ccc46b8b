#pragma once

#include <string>
#include <variant>
#include <vector>

namespace vibro_impact::core
{
/// A uniform pinned-pinned Euler-Bernoulli beam of rectangular section.
struct BeamParameters
{
  double youngs_modulus = 0.0;    ///< Pa, > 0
  double density = 0.0;           ///< kg/m^3, > 0
  double length = 0.0;            ///< m, > 0
  double height = 0.0;            ///< depth of the section in the direction of motion, m, > 0
  double width = 0.0;             ///< m, > 0
  double contact_location = 0.0;  ///< distance of the contact point from the first support, m, inside (0, length)
};

/// A surface without modes that only follows the base.
struct RigidSurface
{
};

using StructureParameters = std::variant<BeamParameters, RigidSurface>;

struct ContactParameters
{
  double stiffness = 0.0;  ///< of the contact spring k, N/m, > 0
  double clearance = 0.0;  ///< distance between the surfaces at rest, m; negative: an interference fit
};

/// Damping ratios of every mode in the two states, in [0, 1).
struct DampingParameters
{
  double free = 0.0;
  double contact = 0.0;
};

/// The paper's basis: the lowest free modes in S0, the lowest conjoined modes in S1; the mapping between them loses
/// energy.
struct ConjoinedBasis
{
  int modes_free = 2;     ///< 1 ... 100
  int modes_contact = 2;  ///< 1 ... 100
};

/// Free modes of each structure and one static attachment shape each; S1 uses the Ritz modes of the same space.
struct AttachmentBasis
{
  int modes_per_beam = 5;  ///< 1 ... 100
};

using BasisParameters = std::variant<ConjoinedBasis, AttachmentBasis>;

/// Everything that defines a switched model.
struct SystemParameters
{
  BeamParameters beam1;
  StructureParameters beam2;
  ContactParameters contact;
  DampingParameters damping;
  BasisParameters basis = AttachmentBasis{};
};

/// The scales of beam 1 that make frequencies and impulses dimensionless.
struct ReferenceScales
{
  double frequency = 1.0;  ///< lowest natural frequency omega_11, rad/s
  double stiffness = 1.0;  ///< static midspan stiffness k_b = 48 E_1 I_1/L_1^3, N/m
  double length = 1.0;     ///< L_1, m

  /// I* = I omega_11/(k_b L_1)
  double impulseStar(double impulse) const
  {
    return impulse * frequency / (stiffness * length);
  }
};

/// One value out of range.
struct ParameterFault
{
  std::string key;      ///< as in a configuration file: "beam1.length"; "beam1: ..." for a product of several
  std::string value;    ///< as text
  std::string allowed;  ///< what it must be, with its unit
};

/// Every value of `parameters` that is out of range, in the order of the structure's members. Where all are in range by
/// themselves, their combinations are: stiffnesses, masses and frequencies that overflow, vanish or lie beyond what
/// double precision resolves. Empty if a model can be built.
std::vector<ParameterFault> findFaults(const SystemParameters& parameters);

/// Throws std::invalid_argument if findFaults() finds any; the message names each parameter, its value and what is
/// allowed.
void validate(const SystemParameters& parameters);

/// The scales of a beam that passes validate().
ReferenceScales referenceScales(const BeamParameters& beam1);

}  // namespace vibro_impact::core
