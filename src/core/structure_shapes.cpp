#include "vibro_impact/core/structure_shapes.h"

#include <algorithm>
#include <memory>
#include <variant>

#include "vibro_impact/core/beam.h"

namespace vibro_impact::core
{
namespace
{
std::vector<double> positionsAlong(const BeamParameters& beam, int points)
{
  std::vector<double> positions;
  positions.reserve(static_cast<std::size_t>(points) + 3);
  for (int i = 0; i < points; ++i)
  {
    positions.push_back(i + 1 == points ? beam.length : beam.length * i / (points - 1));
  }
  positions.push_back(beam.contact_location);
  if (beam.rigid_body)
  {
    const double arm = 0.5 * beam.rigid_body->length;
    positions.insert(positions.end(), {0.5 * beam.length - arm, 0.5 * beam.length + arm});
  }
  std::sort(positions.begin(), positions.end());
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  return positions;
}

Eigen::VectorXd vector(const std::vector<double>& values)
{
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}
}  // namespace

StructureShapes::StructureShapes(const SystemParameters& parameters, const SwitchedModel& model, int points)
    : sides_{makeSide(parameters.beam1, model, 1, points), makeSide(parameters.beam2, model, 2, points)},
      clearance_(model.clearance())
{
}

StructureShapes::Side StructureShapes::makeSide(const StructureParameters& parameters, const SwitchedModel& model,
                                                int structure, int points)
{
  const std::vector<StructureMode>& modes = model.structureModes();
  const auto columns = static_cast<Eigen::Index>(modes.size());
  Side side;
  side.contact = Eigen::RowVectorXd::Zero(columns);
  int kept = 0;  // modes that are listed by number
  Eigen::Index attachment = -1;
  for (Eigen::Index column = 0; column < columns; ++column)
  {
    const StructureMode& mode = modes[static_cast<std::size_t>(column)];
    if (mode.structure == structure)
    {
      side.contact(column) = mode.contact_deflection;
      kept = std::max(kept, mode.number);
      attachment = mode.number == 0 ? column : attachment;
    }
  }
  const std::unique_ptr<const Structure> any = makeStructure(parameters);
  if (any == nullptr)
  {
    return side;
  }
  const double receptance = any->staticReceptance(std::max(kept, any->rigidBodyModeCount()));
  side.contact_rest = attachment < 0 ? receptance : 0.0;
  const auto* beam_parameters = std::get_if<BeamParameters>(&parameters);
  if (beam_parameters == nullptr)
  {
    return side;
  }

  const Beam beam(*beam_parameters);
  side.positions = positionsAlong(*beam_parameters, points);
  side.shapes = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(side.positions.size()), columns);
  const Eigen::VectorXd rest = vector(beam.staticShape(std::max(kept, beam.rigidBodyModeCount()), side.positions));
  side.rest = attachment < 0 ? rest : Eigen::VectorXd::Zero(rest.size());
  for (Eigen::Index column = 0; column < columns; ++column)
  {
    const StructureMode& mode = modes[static_cast<std::size_t>(column)];
    if (column == attachment)
    {
      side.shapes.col(column) = rest * (mode.contact_deflection / receptance);
    }
    else if (mode.structure == structure)
    {
      side.shapes.col(column) = vector(beam.modeShape(mode.number, side.positions));
    }
  }
  return side;
}

void StructureShapes::displacements(const double* coordinates, double gap, Displacements& displacements) const
{
  const Eigen::Map<const Eigen::VectorXd> eta(coordinates, static_cast<Eigen::Index>(size()));
  std::array<double, 2>& point = displacements.contact_point;
  for (std::size_t i = 0; i < 2; ++i)
  {
    point[i] = sides_[i].contact.dot(eta);
    displacements.along[i].resize(sides_[i].shapes.rows());
    if (sides_[i].shapes.rows() > 0)
    {
      displacements.along[i].noalias() = sides_[i].shapes * eta;
    }
  }
  const double compliance = sides_[0].contact_rest + sides_[1].contact_rest;
  if (!(compliance > 0.0))
  {
    return;
  }
  const double force = (gap - clearance_ - (point[0] - point[1])) / compliance;
  for (std::size_t i = 0; i < 2; ++i)
  {
    const double signed_force = i == 0 ? force : -force;
    point[i] += signed_force * sides_[i].contact_rest;
    if (displacements.along[i].size() > 0)
    {
      displacements.along[i] += signed_force * sides_[i].rest;
    }
  }
}

}  // namespace vibro_impact::core
