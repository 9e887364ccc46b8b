#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
/// Both structures along their length, as the coordinates of SwitchedModel::structureModes() and the gap bend them.
/// What the listed modes leave out of the gap (the conjoined basis, in contact) is what the modes that are not listed
/// yield to the contact force: it is added as the static deflection under it.
class StructureShapes
{
public:
  /// How both structures are displaced from the base at one time, m.
  struct Displacements
  {
    std::array<Eigen::VectorXd, 2> along;              ///< at positions(1) and positions(2)
    std::array<double, 2> contact_point = {0.0, 0.0};  ///< their difference and the clearance make the gap
  };

  /// `points` (>= 2) equally spaced ones of each beam, its ends included; the edges of a rigid body and the contact
  /// point come on top. `parameters` are those that `model` was made of.
  StructureShapes(const SystemParameters& parameters, const SwitchedModel& model, int points);

  /// Distances from the first end of a beam in ascending order, m; empty for a structure that has no shape along it: a
  /// modal table, a rigid surface.
  const std::vector<double>& positions(int structure) const
  {
    return sides_.at(static_cast<std::size_t>(structure - 1)).positions;
  }

  /// `coordinates` as in SampledSimulation::structureCoordinates(), of which `size()` begin there; the gap in m.
  void displacements(const double* coordinates, double gap, Displacements& displacements) const;

  /// How many coordinates there are.
  std::size_t size() const
  {
    return static_cast<std::size_t>(sides_[0].contact.size());
  }

private:
  /// One structure; columns of the other one are zero.
  struct Side
  {
    std::vector<double> positions;
    Eigen::MatrixXd shapes;      // a row for each position, a column for each coordinate
    Eigen::RowVectorXd contact;  // the same at the contact point
    Eigen::VectorXd rest;        // static deflection by the modes that are not listed, under a unit force
    double contact_rest = 0.0;
  };

  static Side makeSide(const StructureParameters& parameters, const SwitchedModel& model, int structure, int points);

  std::array<Side, 2> sides_;
  double clearance_;
};

}  // namespace vibro_impact::core
