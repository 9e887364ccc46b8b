#pragma once

#include <array>

#include <Eigen/Core>

#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::peers
{
/// One linear state, dimensionless, each coordinate by itself:  x'' + damping x' + stiffness x = load cos(Omega t).
struct State
{
  Eigen::ArrayXd stiffness;
  Eigen::ArrayXd damping;
  Eigen::ArrayXd load;
  Eigen::VectorXd deflection;  ///< gap per unit coordinate

  Eigen::Index size() const
  {
    return stiffness.size();
  }
};

/// What every competitor integrates: a switched model without clearance from rest under a harmonic drive, the base
/// acceleration being -A cos(Omega t). The unit of time is 1/omega_11, that of displacement such that the gap of the
/// first mode alone under a static load is one: a tolerance means the same in every case.
struct Problem
{
  Problem(const core::SwitchedModel& model, double omega_star);

  std::array<State, 2> states;  ///< free, in contact
  Eigen::MatrixXd mapping;      ///< free coordinates = mapping . those in contact; it is orthogonal
  double drive_frequency;       ///< omega*
  double cycle;                 ///< 2 pi/Omega
  double time_unit;             ///< s
  double gap_unit;              ///< m, at A = 1 m/s^2
};

/// [displacement; velocity] of all coordinates.
using Vector = Eigen::VectorXd;
using VectorView = Eigen::Map<const Eigen::VectorXd>;

struct GapAndRate
{
  double gap;
  double rate;
};

inline GapAndRate gapAndRate(const State& state, const double* y)
{
  const Eigen::Index n = state.size();
  return {state.deflection.dot(VectorView(y, n)), state.deflection.dot(VectorView(y + n, n))};
}

/// The right-hand side, with drive = cos(Omega t).
inline void derivative(const State& state, double drive, const double* y, double* result)
{
  const Eigen::Index n = state.size();
  const Eigen::Map<const Eigen::ArrayXd> x(y, n);
  const Eigen::Map<const Eigen::ArrayXd> v(y + n, n);
  Eigen::Map<Eigen::ArrayXd>(result, n) = v;
  Eigen::Map<Eigen::ArrayXd>(result + n, n) = drive * state.load - state.damping * v - state.stiffness * x;
}

/// From the coordinates of `state` to those of the other; `scratch` has the size of `y`.
inline void mapToOther(const Problem& problem, int state, Vector& y, Vector& scratch)
{
  const Eigen::Index n = problem.mapping.rows();
  scratch = y;
  for (const Eigen::Index start : {Eigen::Index{0}, n})
  {
    if (state == 0)
    {
      y.segment(start, n).noalias() = problem.mapping.transpose() * scratch.segment(start, n);
    }
    else
    {
      y.segment(start, n).noalias() = problem.mapping * scratch.segment(start, n);
    }
  }
}

}  // namespace vibro_impact::peers
