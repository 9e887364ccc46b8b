#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace vibro_impact::core
{
/// A full rectangle.
struct Rectangle
{
  double height = 0.0;  ///< depth of the section in the direction of motion, m, > 0
  double width = 0.0;   ///< m, > 0
};

/// A round tube, or a full bar where the wall reaches the middle. What fills or surrounds it moves along as added mass.
struct Tube
{
  double outer_diameter = 0.0;         ///< m, > 0
  double wall_thickness = 0.0;         ///< m, > 0, at most half the outer diameter
  double added_mass_per_length = 0.0;  ///< kg/m, >= 0
};

/// Any section, by what the equation of motion needs of it; Young's modulus and density do not enter.
struct Section
{
  double bending_stiffness = 0.0;  ///< E I, N m^2, > 0
  double mass_per_length = 0.0;    ///< kg/m, > 0
};

using CrossSection = std::variant<Rectangle, Tube, Section>;

/// How an end of a beam is held; what holds it follows the base.
enum class End
{
  pinned,   ///< no deflection, no bending moment
  clamped,  ///< no deflection, no slope
  free      ///< no shear force, no bending moment
};

/// A rigid body that takes the place of the middle of a beam and carries the contact.
struct RigidBody
{
  double length = 0.0;          ///< along the beam, m, >= 0, at most 0.999 of the beam's length
  double mass = 0.0;            ///< kg, >= 0
  double rotary_inertia = 0.0;  ///< about the axis of bending through its middle, kg m^2, >= 0
};

/// A uniform Euler-Bernoulli beam, possibly with a rigid body at its middle.
struct BeamParameters
{
  double youngs_modulus = 0.0;  ///< Pa, > 0
  double density = 0.0;         ///< kg/m^3, > 0
  double length = 0.0;          ///< from end to end, m, > 0
  CrossSection cross_section;
  double contact_location = 0.0;  ///< distance of the contact point from the first end, m
  std::array<End, 2> ends = {End::pinned, End::pinned};
  std::optional<RigidBody> rigid_body = std::nullopt;
};

double bendingStiffness(const BeamParameters& beam);  ///< E I, N m^2
double massPerLength(const BeamParameters& beam);     ///< kg/m

/// A surface without modes that only follows the base.
struct RigidSurface
{
};

/// Mass-normalised modes of any linear structure, by number in all lists, in any order.
struct ModalTableParameters
{
  std::vector<double> frequency_hz;         ///< Hz, >= 0; 0: a rigid-body mode
  std::vector<double> contact_deflection;   ///< shape at the contact point, kg^-1/2
  std::vector<double> participation;        ///< in base motion, kg^1/2
  std::vector<double> damping_ratio;        ///< while apart, in [0, 1); empty: that of the configuration for all modes
  std::optional<double> static_receptance;  ///< of the contact point, all elastic modes, m/N; none: that of the table
};

/// What is on one side of the contact.
using StructureParameters = std::variant<BeamParameters, RigidSurface, ModalTableParameters>;

struct ContactParameters
{
  double stiffness = 0.0;  ///< of the contact spring k, N/m, > 0
  double clearance = 0.0;  ///< distance between the surfaces at rest, m; negative: an interference fit
};

inline bool operator==(const ContactParameters& one, const ContactParameters& other)
{
  return one.stiffness == other.stiffness && one.clearance == other.clearance;
}

/// Damping ratios of the modes in the two states, in [0, 1). `free` is that of every mode without one of its own.
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
  int modes_per_beam = 5;  ///< 1 ... 100; at least the rigid-body modes are taken, and no more than there are
};

using BasisParameters = std::variant<ConjoinedBasis, AttachmentBasis>;

/// Everything that defines a switched model.
struct SystemParameters
{
  StructureParameters beam1;
  StructureParameters beam2;
  ContactParameters contact;
  DampingParameters damping;
  BasisParameters basis = AttachmentBasis{};
};

/// The scales that make frequencies and impulses dimensionless: those of structure 1, or of structure 2 where the first
/// one is rigid or has no elastic mode that moves its contact point; 1 where neither has.
struct ReferenceScales
{
  double frequency = 1.0;  ///< lowest natural frequency above zero, omega_11, rad/s
  double stiffness = 1.0;  ///< of a beam: static stiffness at midspan k_b, without what the beam moves as a rigid body,
                           ///< N/m; 48 E I/L^3 for pinned ends. Of a modal table: at the contact point
  double length = 1.0;     ///< of a beam: L, m. Of a modal table: 1 m

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

/// The scales of structures that pass validate().
ReferenceScales referenceScales(const SystemParameters& parameters);

}  // namespace vibro_impact::core
