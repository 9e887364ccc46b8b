#include "unit_beam.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <utility>

#include <Eigen/Dense>

namespace vibro_impact::core
{
namespace
{
constexpr Precise pi = 3.14159265358979323846264338327950288L;

/// A shape that is smaller than this share of its greatest value at the contact has a node there, which the rounding of
/// the contact location has moved.
constexpr Precise node = 1.0e-12L;

/// Pairs of ends come in six kinds and their mirror images.
struct Orientation
{
  Ends ends;
  bool mirrored = false;
};

Orientation canonical(const Ends& ends)
{
  // clamped-free, clamped-pinned, free-pinned
  const auto rank = [](End end) { return end == End::clamped ? 0 : (end == End::free ? 1 : 2); };
  return rank(ends[0]) <= rank(ends[1]) ? Orientation{ends, false} : Orientation{{ends[1], ends[0]}, true};
}

/// beta in parts: the value it tends to with growing m is q pi/4; the rest falls as exp(-beta).
struct Eigenvalue
{
  int quarters = 0;  // q
  Precise rest = 0;

  Precise value() const
  {
    return static_cast<Precise>(quarters) * (pi / 4) + rest;
  }
};

Eigenvalue findEigenvalue(const Ends& ends, int m)
{
  Eigenvalue beta;
  if (ends[0] == End::pinned)
  {
    beta.quarters = 4 * m;
    return beta;
  }
  if (ends[1] == End::pinned)
  {
    // tanh beta = tan(pi/4 - atan exp(-2 beta)), so that rest = -atan exp(-2 beta)
    beta.quarters = 4 * m + 1;
    for (Precise last = 1; beta.rest != last;)
    {
      last = beta.rest;
      beta.rest = -std::atan(std::exp(-2 * beta.value()));
      if (std::abs(beta.rest - last) <= std::numeric_limits<Precise>::epsilon())
      {
        break;
      }
    }
    return beta;
  }
  // cos beta = +-sech beta, and asin sech beta = 2 atan exp(-beta): rest = sign 2 atan exp(-beta), by Newton's method
  const bool alike = ends[0] == ends[1];
  beta.quarters = alike ? 4 * m + 2 : 4 * m - 2;
  const Precise sign = m % 2 == 0 ? -1 : 1;
  for (int i = 0; i < 20; ++i)
  {
    const Precise decay = std::exp(-beta.value());
    const Precise step = (beta.rest - sign * 2 * std::atan(decay)) / (1 + sign * 2 * decay / (1 + decay * decay));
    beta.rest -= step;
    if (std::abs(step) <= std::numeric_limits<Precise>::epsilon())
    {
      break;
    }
  }
  return beta;
}

/// Deflection of the point x of the beam alone under a unit force there, and under a unit deceleration of its base.
struct StaticDeflections
{
  Precise receptance = 0;
  Precise base_response = 0;
};

// Polynomials, since nothing else keeps as many digits: textbook cases of supported beams; of the others, the elastic
// part of the deflection under the force or deceleration and the inertia of the motion as a rigid body.
StaticDeflections plainDeflections(const Ends& ends, Precise x)
{
  const Orientation orientation = canonical(ends);
  const Precise a = orientation.mirrored ? 1 - x : x;
  const Precise b = 1 - a;
  const Precise u = a * b;
  if (orientation.ends[0] == End::pinned)
  {
    return {u * u / 3, u * (1 + u) / 24};
  }
  if (orientation.ends[0] == End::clamped)
  {
    switch (orientation.ends[1])
    {
      case End::pinned:
        return {a * a * a * b * b * (3 + b) / 12, a * a * b * (1 + 2 * b) / 48};
      case End::clamped:
        return {u * u * u / 3, u * u / 24};
      case End::free:
        return {a * a * a / 3, a * a * (6 - 4 * a + a * a) / 24};
    }
  }
  if (orientation.ends[1] == End::free)
  {
    return {(1 - 11 * u + 28 * u * u + 21 * u * u * u) / 105, 0};
  }
  return {b * b * (99 - 280 * b + 210 * b * b - 21 * b * b * b * b) / 420,
          b * (16 - 70 * b * b + 70 * b * b * b - 21 * b * b * b * b) / 1680};
}

/// w and its first three derivatives to z.
using Derivatives = std::array<Precise, 4>;

Derivatives derivatives(const Wave& wave, Precise z)
{
  const Precise sine = std::sin(z);
  const Precise cosine = std::cos(z);
  const Precise falling = wave.c * std::exp(-z);
  const Precise rising = wave.d * std::exp(z - wave.end);
  const Precise even = wave.a * sine + wave.b * cosine;
  const Precise odd = wave.a * cosine - wave.b * sine;
  return {even + falling + rising, odd - falling + rising, -even + falling + rising, -odd - falling + rising};
}

/// Integral of w over z. (w'''' = w)
Precise integral(const Derivatives& from, const Derivatives& to)
{
  return to[3] - from[3];
}

/// Integral of w^2 over z from 0 to `length`:  4 w^2 = (3 w w''' - w' w'' + z (w''^2 - 2 w' w''' + w^2))'
Precise integralOfSquare(const Derivatives& from, const Derivatives& to, Precise length)
{
  const Precise upper =
      3 * to[0] * to[3] - to[1] * to[2] + length * (to[2] * to[2] - 2 * to[1] * to[3] + to[0] * to[0]);
  return (upper - (3 * from[0] * from[3] - from[1] * from[2])) / 4;
}

/// The wave with the given deflection and slope (to z) at z = 0 and the conditions of `outer` at z = Z. Infinite at the
/// frequencies of a segment clamped at its inner end.
Wave solveSegment(End outer, Precise Z, Precise deflection, Precise slope)
{
  const Precise s = std::sin(Z);
  const Precise k = std::cos(Z);
  const Precise E = std::exp(-Z);
  // a = slope + c - d E,  b = deflection - c - d E: what is left are two equations  m_ic c + m_id d = r_i
  const Precise even = slope * s + deflection * k;
  const Precise odd = slope * k - deflection * s;
  Precise m1c = 0, m1d = 0, r1 = 0, m2c = 0, m2d = 0, r2 = 0;
  switch (outer)
  {
    case End::pinned:
      m1c = s - k, m1d = -E * (s + k), r1 = -even;
      m2c = E, m2d = 1, r2 = 0;
      break;
    case End::clamped:
      m1c = s - k + E, m1d = 1 - E * (s + k), r1 = -even;
      m2c = k + s - E, m2d = 1 + E * (s - k), r2 = -odd;
      break;
    case End::free:
      m1c = k - s + E, m1d = 1 + E * (s + k), r1 = even;
      m2c = -k - s - E, m2d = 1 - E * (s - k), r2 = odd;
      break;
  }
  const Precise determinant = m1c * m2d - m1d * m2c;
  Wave wave;
  wave.c = (r1 * m2d - m1d * r2) / determinant;
  wave.d = (m1c * r2 - r1 * m2c) / determinant;
  wave.a = slope + wave.c - wave.d * E;
  wave.b = deflection - wave.c - wave.d * E;
  wave.end = Z;
  return wave;
}

int negative(Precise value)
{
  return value < 0 ? 1 : 0;
}

}  // namespace

Precise eigenvalue(const Ends& ends, int m)
{
  return findEigenvalue(canonical(ends).ends, m).value();
}

UnitBeam::UnitBeam(const Ends& ends, Precise contact)
    : ends_(ends),
      plain_(true),
      symmetric_(false),
      contact_(contact),
      segments_{Segment{ends[0], contact, -1}, Segment{ends[1], 1 - contact, 1}}
{
  findRigidBodyModes();
  const StaticDeflections plain = plainDeflections(ends, contact);
  static_receptance_ = plain.receptance;
  static_base_response_ = plain.base_response;
}

UnitBeam::UnitBeam(const Ends& ends, const Body& body, Precise offset)
    : ends_(ends),
      plain_(false),
      symmetric_(ends[0] == ends[1]),
      contact_(0.5L + offset),
      body_(body),
      offset_(offset),
      segments_{Segment{ends[0], (1 - body.length) / 2, -1}, Segment{ends[1], (1 - body.length) / 2, 1}}
{
  findRigidBodyModes();
  Load force;
  force.force = 1;
  force.moment = offset_;
  static_receptance_ = staticDeflection(force);
  Load deceleration;
  deceleration.distributed.value = 1;
  deceleration.force = body_.mass;
  static_base_response_ = staticDeflection(deceleration);
}

void UnitBeam::findRigidBodyModes()
{
  // mass, and its first and second moment about the middle of the body
  const Precise arm = body_.length / 2;
  Precise mass = body_.mass;
  Precise first = 0;
  Precise second = body_.rotary_inertia;
  for (const Segment& segment : segments_)
  {
    const Precise tip = arm + segment.length;
    mass += segment.length;
    first += segment.side * segment.length * (arm + segment.length / 2);
    second += (tip * tip * tip - arm * arm * arm) / 3;
  }
  const auto add = [&](Precise value, Precise slope)
  {
    const Precise norm = std::sqrt(value * value * mass + 2 * value * slope * first + slope * slope * second);
    const auto at = static_cast<std::size_t>(rigid_body_modes_);
    rigid_shapes_[at] = {value / norm, slope / norm};
    rigid_participations_[at] = (value * mass + slope * first) / norm;
    ++rigid_body_modes_;
  };
  if (ends_[0] == End::free && ends_[1] == End::free)
  {
    add(1, 0);
    add(-first / mass, 1);
    rigid_participations_[1] = 0;
  }
  else if (ends_[0] == End::pinned && ends_[1] == End::free)
  {
    add(arm + segments_[0].length, 1);
  }
  else if (ends_[0] == End::free && ends_[1] == End::pinned)
  {
    add(arm + segments_[1].length, -1);
  }
}

UnitMode UnitBeam::mode(int m) const
{
  UnitMode mode = m <= rigid_body_modes_ ? rigidBodyMode(m) : (plain_ ? plainMode(m, contact_) : modeWithBody(m));
  if (std::abs(mode.contact) < node)
  {
    mode.contact = 0;
  }
  return mode;
}

UnitMode UnitBeam::rigidBodyMode(int m) const
{
  const auto at = static_cast<std::size_t>(m - 1);
  return {0, rigid_shapes_[at].value + rigid_shapes_[at].slope * offset_, rigid_participations_[at]};
}

std::vector<Precise> UnitBeam::shape(int m, const std::vector<Precise>& x) const
{
  std::vector<Precise> shape;
  if (m <= rigid_body_modes_)
  {
    const RigidShape& rigid = rigid_shapes_[static_cast<std::size_t>(m - 1)];
    std::transform(x.begin(), x.end(), std::back_inserter(shape),
                   [&](Precise at) { return rigid.value + rigid.slope * (at - middle()); });
  }
  else if (plain_)
  {
    std::transform(x.begin(), x.end(), std::back_inserter(shape), [&](Precise at) { return plainMode(m, at).contact; });
  }
  else
  {
    const BodyMode mode = findBodyMode(m);
    const auto value = [&](Precise at)
    {
      const auto [segment, t] = place(at);
      return mode.scale * (segment < 0
                               ? mode.deflection + mode.rotation * (at - middle())
                               : derivatives(mode.waves[static_cast<std::size_t>(segment)], mode.lambda * t)[0]);
    };
    std::transform(x.begin(), x.end(), std::back_inserter(shape), value);
  }
  return shape;
}

UnitBeam::Place UnitBeam::place(Precise x) const
{
  const Precise from_middle = x - middle();
  const Precise t = std::abs(from_middle) - body_.length / 2;
  return t <= 0 ? Place{-1, from_middle} : Place{from_middle < 0 ? 0 : 1, t};
}

UnitMode UnitBeam::plainMode(int m, Precise at) const
{
  const int number = m - rigid_body_modes_;  // among the elastic ones
  const Orientation orientation = canonical(ends_);
  const Ends& ends = orientation.ends;
  const Precise beta = findEigenvalue(ends, number).value();
  const Precise x = orientation.mirrored ? 1 - at : at;

  if (ends[0] == End::pinned)
  {
    // The sine of a whole number of half waves keeps its digits by taking the whole waves out of it.
    const Precise turns = std::remainder(number * x, Precise{2});
    const Precise sine =
        std::abs(turns) > 0.5L ? std::copysign(std::sin(pi * (1 - std::abs(turns))), turns) : std::sin(pi * turns);
    return {beta * beta, std::sqrt(Precise{2}) * sine,
            number % 2 == 1 ? 2 * std::sqrt(Precise{2}) / (number * pi) : Precise{0}};
  }

  // The shape with c = 1; its norm is the integral of w^2, for which the general formula leaves a single term.
  const Precise E = std::exp(-beta);
  const Precise even = number % 2 == 1 ? 1 : -1;  // symmetric, or antisymmetric, about midspan
  Wave wave;
  wave.end = beta;
  wave.c = 1;
  Precise norm = 1;
  Precise area = 0;  // integral of w
  if (ends[1] == End::pinned)
  {
    const bool clamped = ends[0] == End::clamped;
    wave.d = -E;
    wave.a = clamped ? 1 + E * E : -1 - E * E;
    wave.b = clamped ? -1 + E * E : 1 - E * E;
    norm = 1 - E * E;
    // at the pin a sin beta + b cos beta = 0, so that w' there is +-sqrt(a^2 + b^2) - 2 E
    const Precise slope = even * std::copysign(std::sqrt(wave.a * wave.a + wave.b * wave.b), -wave.a);
    const Precise at_pin = -slope - 2 * E;
    area = (at_pin - (clamped ? -2 * (1 + E * E) : Precise{0})) / beta;
  }
  else if (ends[0] == ends[1])
  {
    const bool clamped = ends[0] == End::clamped;
    wave.d = even;
    wave.a = clamped ? 1 - even * E : -1 + even * E;
    wave.b = clamped ? -1 - even * E : 1 + even * E;
    norm = std::abs(even + E);
    area = clamped ? 2 * (1 - E) * (1 + even) / beta : Precise{0};
  }
  else
  {
    const Precise s = std::sin(beta);
    const Precise k = std::cos(beta);
    wave.d = -(k - s + E) / (1 + E * (s + k));
    wave.a = 1 - wave.d * E;
    wave.b = -1 - wave.d * E;
    norm = std::abs(wave.d + E);
    area = 2 * (1 - wave.d * E) / beta;
  }
  return {beta * beta, derivatives(wave, beta * x)[0] / norm, area / norm};
}

UnitBeam::Stiffness UnitBeam::dynamicStiffness(Precise lambda) const
{
  const Precise arm = body_.length / 2;
  const Precise square = lambda * lambda;
  Stiffness sum;
  sum.deflection = -square * square * body_.mass;
  sum.rotation = -square * square * body_.rotary_inertia;
  for (const Segment& segment : segments_)
  {
    if (segment.length <= 0)
    {
      continue;  // a contact at the very end, which is free
    }
    // What bends the segment is what its inner end needs: the force w''', the moment -w''.
    const Precise Z = lambda * segment.length;
    const Derivatives shift = derivatives(solveSegment(segment.outer, Z, 1, 0), 0);
    const Derivatives turn = derivatives(solveSegment(segment.outer, Z, 0, 1 / lambda), 0);
    const Precise ww = square * lambda * shift[3];
    const Precise wt = square * lambda * turn[3];
    const Precise tt = -square * turn[2];
    sum.deflection += ww;
    sum.coupling += segment.side * (arm * ww + wt);
    sum.rotation += arm * arm * ww + 2 * arm * wt + tt;
  }
  if (symmetric_)
  {
    sum.coupling = 0;
  }
  return sum;
}

Precise UnitBeam::receptance(Precise lambda) const
{
  const Stiffness stiffness = dynamicStiffness(lambda);
  const Precise determinant = stiffness.deflection * stiffness.rotation - stiffness.coupling * stiffness.coupling;
  // (1, e) D^-1 (1, e)^T
  return (stiffness.rotation - 2 * offset_ * stiffness.coupling + offset_ * offset_ * stiffness.deflection) /
         determinant;
}

// W. H. Wittrick and F. W. Williams, A general algorithm for computing natural frequencies of elastic structures,
// Quart. J. Mech. Appl. Math. 24 (1971), 263-284: below a frequency lie as many modes as the segments have with the
// body held, and one more for each negative eigenvalue of the dynamic stiffness of the body.
UnitBeam::Count UnitBeam::modesBelow(Precise lambda) const
{
  std::array<int, 2> held = {0, 0};
  for (std::size_t i = 0; i < 2; ++i)
  {
    const Ends ends = {segments_[i].outer, End::clamped};
    const Precise Z = lambda * segments_[i].length;
    // the m-th eigenvalue lies above (m - 1) pi for any kind of ends
    int m = std::max(0, static_cast<int>(Z / pi) - 2);
    while (eigenvalue(ends, m + 1) < Z)
    {
      ++m;
    }
    held[i] = m;
  }
  const Stiffness stiffness = dynamicStiffness(lambda);
  if (symmetric_)
  {
    return {held[0] + negative(stiffness.deflection), held[1] + negative(stiffness.rotation)};
  }
  const Precise rest = stiffness.rotation - stiffness.coupling * stiffness.coupling / stiffness.deflection;
  return {held[0] + held[1] + negative(stiffness.deflection) + negative(rest), 0};
}

UnitBeam::BodyMode UnitBeam::findBodyMode(int m) const
{
  const auto total = [](const Count& count) { return count[0] + count[1]; };
  Precise low = 0;
  // No simple share of pi: on a frequency of a held segment, to the last bit, the two parts of the count need not
  // agree.
  Precise high = 3.7L * static_cast<Precise>(m + 1);
  Count below = {0, 0};
  Count above = modesBelow(high);
  while (total(above) < m)
  {
    low = high;
    below = above;
    high *= 2;
    above = modesBelow(high);
  }
  for (Precise middle = (low + high) / 2; middle > low && middle < high; middle = (low + high) / 2)
  {
    const Count count = modesBelow(middle);
    if (total(count) < m)
    {
      low = middle;
      below = count;
    }
    else
    {
      high = middle;
      above = count;
    }
  }

  // How the body moves: the vector that its dynamic stiffness takes to zero.
  BodyMode mode;
  const Precise lambda = mode.lambda = high;
  Precise& deflection = mode.deflection;
  Precise& rotation = mode.rotation;
  if (symmetric_)
  {
    const bool moves = above[0] > below[0] && m == total(below) + 1;
    deflection = moves ? 1 : 0;
    rotation = moves ? 0 : 1;
  }
  else
  {
    const Stiffness stiffness = dynamicStiffness(lambda);
    const bool first = std::abs(stiffness.deflection) >= std::abs(stiffness.rotation);
    deflection = first ? -stiffness.coupling : stiffness.rotation;
    rotation = first ? stiffness.deflection : -stiffness.coupling;
    const Precise size = std::hypot(deflection, rotation);
    deflection /= size;
    rotation /= size;
  }

  Precise norm = body_.mass * deflection * deflection + body_.rotary_inertia * rotation * rotation;
  mode.participation = body_.mass * deflection;
  for (std::size_t i = 0; i < 2; ++i)
  {
    const Segment& segment = segments_[i];
    const Precise Z = lambda * segment.length;
    const Precise inner = deflection + segment.side * body_.length / 2 * rotation;
    mode.waves[i] = solveSegment(segment.outer, Z, inner, segment.side * rotation / lambda);
    const Derivatives from = derivatives(mode.waves[i], 0);
    const Derivatives to = derivatives(mode.waves[i], Z);
    norm += integralOfSquare(from, to, Z) / lambda;
    mode.participation += integral(from, to) / lambda;
  }
  mode.scale = 1 / std::sqrt(norm);
  return mode;
}

UnitMode UnitBeam::modeWithBody(int m) const
{
  const BodyMode mode = findBodyMode(m);
  return {mode.lambda * mode.lambda, mode.scale * (mode.deflection + offset_ * mode.rotation),
          symmetric_ && mode.deflection == 0 ? Precise{0} : mode.scale * mode.participation};
}

std::vector<Precise> UnitBeam::staticShape(const std::vector<Precise>& x) const
{
  Load load;
  load.force = 1;
  load.moment = offset_;
  const StaticSolution solution = solveStatics(load);
  const auto value = [&](Precise at)
  {
    const auto [side, t] = place(at);
    if (side < 0)
    {
      return solution.deflection + solution.rotation * t;
    }
    const auto i = static_cast<std::size_t>(side);
    const Segment& segment = segments_[i];
    const Precise arm = body_.length / 2;
    const Precise q0 = solution.distributed.value + solution.distributed.slope * segment.side * arm;
    const Precise q1 = solution.distributed.slope * segment.side;
    return solution.deflection + segment.side * solution.rotation * (arm + t) +
           t * t * (solution.moment[i] / 2 + t * (solution.shear[i] / 6 + t * (q0 / 24 + t * q1 / 120)));
  };
  std::vector<Precise> shape;
  std::transform(x.begin(), x.end(), std::back_inserter(shape), value);
  return shape;
}

Precise UnitBeam::staticDeflection(const Load& load) const
{
  const StaticSolution solution = solveStatics(load);
  return solution.deflection + offset_ * solution.rotation;
}

UnitBeam::StaticSolution UnitBeam::solveStatics(Load load) const
{
  // What would accelerate the beam as a rigid body is balanced by its inertia.
  for (int i = 0; i < rigid_body_modes_; ++i)
  {
    const RigidShape& shape = rigid_shapes_[static_cast<std::size_t>(i)];
    Precise share = load.force * shape.value + load.moment * shape.slope;
    for (const Segment& segment : segments_)
    {
      // integral of the product of two straight lines over the segment, by Simpson's rule
      const Precise arm = body_.length / 2;
      const auto product = [&](Precise t)
      {
        const Precise x = segment.side * (arm + t);
        return (load.distributed.value + load.distributed.slope * x) * (shape.value + shape.slope * x);
      };
      share += segment.length / 6 * (product(0) + 4 * product(segment.length / 2) + product(segment.length));
    }
    load.distributed.value -= share * shape.value;
    load.distributed.slope -= share * shape.slope;
    load.force -= share * body_.mass * shape.value;
    load.moment -= share * body_.rotary_inertia * shape.slope;
  }

  // Unknowns: deflection y and rotation theta of the body, and A, B of each segment, whose deflection over the outward
  // coordinate t under the load q0 + q1 t is
  //   w = y + side arm theta + side theta t + B t^2/2 + A t^3/6 + q0 t^4/24 + q1 t^5/120
  // Equations: two at each outer end, the balance of the body, and no part in a mode as a rigid body. These last ones
  // are in place of as many of the others that then hold by themselves.
  const int rows = 6 + rigid_body_modes_;
  using Matrix = Eigen::Matrix<Precise, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix equations = Matrix::Zero(rows, 6);
  Eigen::Matrix<Precise, Eigen::Dynamic, 1> right = Eigen::Matrix<Precise, Eigen::Dynamic, 1>::Zero(rows);
  const Precise arm = body_.length / 2;
  right(4) = load.force;
  right(5) = load.moment;
  for (int i = 0; i < 2; ++i)
  {
    const Segment& segment = segments_[static_cast<std::size_t>(i)];
    const Precise s = segment.length;
    const Precise side = segment.side;
    const Precise q0 = load.distributed.value + load.distributed.slope * side * arm;
    const Precise q1 = load.distributed.slope * side;
    const int A = 2 + 2 * i;
    const int B = 3 + 2 * i;
    int row = 2 * i;
    if (segment.outer != End::free)  // w = 0
    {
      equations(row, 0) = 1;
      equations(row, 1) = side * (arm + s);
      equations(row, A) = s * s * s / 6;
      equations(row, B) = s * s / 2;
      right(row) = -s * s * s * s * (q0 / 24 + q1 * s / 120);
      ++row;
    }
    if (segment.outer == End::clamped)  // w' = 0
    {
      equations(row, 1) = side;
      equations(row, A) = s * s / 2;
      equations(row, B) = s;
      right(row) = -s * s * s * (q0 / 6 + q1 * s / 24);
    }
    else  // w'' = 0
    {
      equations(row, A) = s;
      equations(row, B) = 1;
      right(row) = -s * s * (q0 / 2 + q1 * s / 6);
      ++row;
    }
    if (segment.outer == End::free)  // w''' = 0
    {
      equations(row, A) = 1;
      right(row) = -s * (q0 + q1 * s / 2);
    }
    equations(4, A) = 1;
    equations(5, A) = side * arm;
    equations(5, B) = -side;
    for (int mode = 0; mode < rigid_body_modes_; ++mode)
    {
      // integral of w times the shape: value at the inner end and slope along t
      const RigidShape& shape = rigid_shapes_[static_cast<std::size_t>(mode)];
      const Precise v = shape.value + shape.slope * side * arm;
      const Precise u = shape.slope * side;
      // integral of t^n times the shape
      const auto moment = [&](int n)
      { return std::pow(s, Precise(n + 1)) * (v / Precise(n + 1) + u * s / Precise(n + 2)); };
      const int at = 6 + mode;
      equations(at, 0) += moment(0);
      equations(at, 1) += side * (arm * moment(0) + moment(1));
      equations(at, B) = moment(2) / 2;
      equations(at, A) = moment(3) / 6;
      right(at) -= q0 * moment(4) / 24 + q1 * moment(5) / 120;
    }
  }
  for (int mode = 0; mode < rigid_body_modes_; ++mode)
  {
    const RigidShape& shape = rigid_shapes_[static_cast<std::size_t>(mode)];
    equations(6 + mode, 0) += body_.mass * shape.value;
    equations(6 + mode, 1) += body_.rotary_inertia * shape.slope;
  }
  const Eigen::Matrix<Precise, Eigen::Dynamic, 1> solution = equations.colPivHouseholderQr().solve(right);
  return {solution(0), solution(1), {solution(2), solution(4)}, {solution(3), solution(5)}, load.distributed};
}

}  // namespace vibro_impact::core
