#pragma once

#include <cmath>

#include <Eigen/Core>

#include "eigenmodes.h"
#include "vibro_impact/core/parameters.h"

namespace vibro_impact::core
{
/// The same beam by another method: cubic finite elements with consistent mass, a node at the contact or at the edges
/// of the body. Frequencies are off by about (beta h)^4/720.
class FiniteElementBeam
{
public:
  FiniteElementBeam(const BeamParameters& beam, int elements_per_side)
  {
    const double arm = beam.rigid_body ? 0.5 * beam.rigid_body->length : 0.0;
    const double middle = beam.rigid_body ? 0.5 * beam.length : beam.contact_location;
    const double mass = massPerLength(beam);
    const int nodes = 2 * (elements_per_side + 1);
    const int size = 2 * nodes;

    // Two chains of elements that do not know of each other.
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size);
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd translation = Eigen::VectorXd::Zero(size);
    const double lengths[] = {middle - arm, beam.length - middle - arm};
    for (int side = 0; side < 2; ++side)
    {
      for (int element = 0; element < elements_per_side && lengths[side] > 0.0; ++element)
      {
        const int at = 2 * (side * (elements_per_side + 1) + element);
        addElement(lengths[side] / elements_per_side, bendingStiffness(beam), mass, K.block<4, 4>(at, at),
                   M.block<4, 4>(at, at));
      }
    }
    for (int node = 0; node < nodes; ++node)
    {
      translation(2 * node) = 1.0;
    }

    // The inner ends follow the body, whose deflection and rotation are the first two coordinates; the outer ones may
    // be held.
    const int left = 2 * elements_per_side;
    const int right = left + 2;
    Eigen::MatrixXd follow = Eigen::MatrixXd::Zero(size, size);
    follow(left, 0) = follow(right, 0) = 1.0;
    follow(left, 1) = -arm;
    follow(right, 1) = arm;
    follow(left + 1, 1) = follow(right + 1, 1) = 1.0;
    int count = 2;
    const auto held = [&](int dof)
    {
      const End end = beam.ends[dof < left ? 0 : 1];
      const bool outer = dof < 2 || dof >= size - 2;
      return outer && (end == End::clamped || (end == End::pinned && dof % 2 == 0));
    };
    for (int dof = 0; dof < size; ++dof)
    {
      // a side without length is its inner end
      const bool there = lengths[dof < right ? 0 : 1] > 0.0;
      if ((dof < left || dof >= right + 2) && there && !held(dof))
      {
        follow(dof, count++) = 1.0;
      }
    }
    follow.conservativeResize(size, count);
    const Eigen::MatrixXd stiffness = follow.transpose() * K * follow;
    Eigen::MatrixXd inertia = follow.transpose() * M * follow;
    Eigen::VectorXd base = follow.transpose() * M * translation;
    Eigen::VectorXd contact = Eigen::VectorXd::Zero(count);
    contact(0) = 1.0;
    contact(1) = beam.contact_location - middle;
    if (beam.rigid_body)
    {
      inertia(0, 0) += beam.rigid_body->mass;
      inertia(1, 1) += beam.rigid_body->rotary_inertia;
      base(0) += beam.rigid_body->mass;
    }
    const Eigenmodes modes = eigenmodes(stiffness, inertia);
    frequencies = modes.values.cwiseMax(0.0).cwiseSqrt();
    deflections = modes.vectors.transpose() * contact;
    participations = modes.vectors.transpose() * base;
  }

  // Mass-normalised modes, by ascending frequency.
  Eigen::VectorXd frequencies;
  Eigen::VectorXd deflections;
  Eigen::VectorXd participations;

  double receptance(double omega) const
  {
    return (deflections.array().square() / (frequencies.array().square() - omega * omega)).sum();
  }

private:
  template <typename Stiffness, typename Mass>
  static void addElement(double h, double bending, double mass_per_length, Stiffness K, Mass M)
  {
    Eigen::Matrix4d k;
    k << 12.0, 6.0 * h, -12.0, 6.0 * h, 6.0 * h, 4.0 * h * h, -6.0 * h, 2.0 * h * h, -12.0, -6.0 * h, 12.0, -6.0 * h,
        6.0 * h, 2.0 * h * h, -6.0 * h, 4.0 * h * h;
    Eigen::Matrix4d m;
    m << 156.0, 22.0 * h, 54.0, -13.0 * h, 22.0 * h, 4.0 * h * h, 13.0 * h, -3.0 * h * h, 54.0, 13.0 * h, 156.0,
        -22.0 * h, -13.0 * h, -3.0 * h * h, -22.0 * h, 4.0 * h * h;
    K += bending / (h * h * h) * k;
    M += mass_per_length * h / 420.0 * m;
  }
};

}  // namespace vibro_impact::core
