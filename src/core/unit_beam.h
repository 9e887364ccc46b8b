#pragma once

#include <array>
#include <vector>

#include "vibro_impact/core/parameters.h"

namespace vibro_impact::core
{
/// In the numbers of a mode that are left of a static deflection by the modes below it, four digits and more cancel.
using Precise = long double;

using Ends = std::array<End, 2>;

/// The m-th root beta_m (m = 1, 2, ...) above zero of the characteristic equation of a uniform beam of unit length; its
/// frequency is beta^2 in units of sqrt(E I/m')/L^2.
///
///   pinned-pinned                         sin beta = 0
///   clamped-clamped, free-free            cos beta cosh beta = 1
///   clamped-free                          cos beta cosh beta = -1
///   clamped-pinned, free-pinned           tan beta = tanh beta
Precise eigenvalue(const Ends& ends, int m);

/// A mass-normalised mode in dimensionless form.
struct UnitMode
{
  Precise frequency = 0;      ///< beta^2
  Precise contact = 0;        ///< shape at the contact point
  Precise participation = 0;  ///< integral of the shape over the mass
};

/// Every motion of a uniform beam at one frequency, written so that nothing overflows and nothing cancels at high wave
/// numbers, z = lambda times the coordinate from 0 to Z:
///   w = a sin z + b cos z + c exp(-z) + d exp(z - Z)
struct Wave
{
  Precise a = 0, b = 0, c = 0, d = 0;
  Precise end = 0;  // Z
};

/// A uniform beam of unit length, bending stiffness and mass per length, with a rigid body in it: two segments that end
/// at the body. A plain beam is the same with a body of no length, mass and inertia at the contact point.
class UnitBeam
{
public:
  struct Body
  {
    Precise length = 0;
    Precise mass = 0;            // over the mass per length times length of the beam
    Precise rotary_inertia = 0;  // over the mass per length times the cube of the length
  };

  /// The beam alone, with the contact at `contact` in [0, 1].
  UnitBeam(const Ends& ends, Precise contact);

  /// With a body at its middle and the contact on it, `offset` from its middle.
  UnitBeam(const Ends& ends, const Body& body, Precise offset);

  int rigidBodyModeCount() const
  {
    return rigid_body_modes_;
  }

  UnitMode mode(int m) const;

  /// The same mode along the beam, at the distances `x` in [0, 1] from the first end.
  std::vector<Precise> shape(int m, const std::vector<Precise>& x) const;

  /// Deflection of the points `x` under a unit force at the contact, without the rigid-body modes.
  std::vector<Precise> staticShape(const std::vector<Precise>& x) const;

  /// Deflection of the contact point under a unit force there, without the rigid-body modes: whatever moves as a rigid
  /// body is held by its own inertia (inertia relief).
  Precise staticReceptance() const
  {
    return static_receptance_;
  }

  /// The same under a unit deceleration of the base.
  Precise staticBaseResponse() const
  {
    return static_base_response_;
  }

  /// Point receptance at the wave number lambda > 0, the frequency being lambda^2; from the dynamic stiffness of the
  /// segments, which loses lambda^4 of its precision far below the first mode.
  Precise receptance(Precise lambda) const;

private:
  /// A shape that moves the beam as a rigid body: value at the middle of the body, and slope.
  struct RigidShape
  {
    Precise value = 0;
    Precise slope = 0;
  };

  /// One side of the body, seen from it. Deflection and slope of its inner end are those of the body,
  /// (y + side arm theta, side theta) with the slope along the outward coordinate.
  struct Segment
  {
    End outer = End::free;
    Precise length = 0;
    Precise side = 1;  // +1 beyond the body, -1 before it
  };

  /// Load on the beam: on its segments per length, as value at the middle of the body and slope; on the body.
  struct Load
  {
    RigidShape distributed;
    Precise force = 0;
    Precise moment = 0;
  };

  /// Symmetric stiffness of the body's deflection and rotation.
  struct Stiffness
  {
    Precise deflection = 0;
    Precise coupling = 0;
    Precise rotation = 0;
  };

  /// How many modes lie below a wave number: those that move the body's deflection and those that move its rotation,
  /// which are apart where both ends are alike; else all are in the first number.
  using Count = std::array<int, 2>;

  /// A mode of the beam with its body, all but `scale` not normalised.
  struct BodyMode
  {
    Precise lambda = 0;
    Precise deflection = 1;  // of the body
    Precise rotation = 0;
    std::array<Wave, 2> waves;  // of the segments, over lambda times the outward coordinate
    Precise participation = 0;
    Precise scale = 1;
  };

  /// How the beam lies under a load. Along the outward coordinate t of segment i
  ///   w = deflection + side arm rotation + side rotation t + moment_i t^2/2 + shear_i t^3/6 + q0 t^4/24 + q1 t^5/120
  struct StaticSolution
  {
    Precise deflection = 0;  // of the body
    Precise rotation = 0;
    std::array<Precise, 2> shear;
    std::array<Precise, 2> moment;
    RigidShape distributed;  // the load on the segments, inertia relief included
  };

  /// Where on the beam a point lies: `segment` and the outward coordinate there, or -1 and the distance from the middle
  /// of the body.
  struct Place
  {
    int segment;
    Precise t;
  };

  Precise middle() const  // of the body
  {
    return contact_ - offset_;
  }
  Place place(Precise x) const;
  void findRigidBodyModes();
  UnitMode rigidBodyMode(int m) const;
  /// With the shape at `at` for that at the contact.
  UnitMode plainMode(int m, Precise at) const;
  UnitMode modeWithBody(int m) const;
  BodyMode findBodyMode(int m) const;
  Precise staticDeflection(const Load& load) const;
  StaticSolution solveStatics(Load load) const;
  Stiffness dynamicStiffness(Precise lambda) const;
  Count modesBelow(Precise lambda) const;

  Ends ends_;
  bool plain_;
  bool symmetric_;
  Precise contact_;  // from the first end
  Body body_;
  Precise offset_ = 0;  // of the contact from the middle of the body
  std::array<Segment, 2> segments_;
  int rigid_body_modes_ = 0;
  std::array<RigidShape, 2> rigid_shapes_;
  std::array<Precise, 2> rigid_participations_ = {0, 0};
  Precise static_receptance_ = 0;
  Precise static_base_response_ = 0;
};

}  // namespace vibro_impact::core
