#include "vibro_impact/core/structure_shapes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "reference_system.h"
#include "vibro_impact/core/simulation.h"

using namespace vibro_impact::core;

namespace
{
constexpr double period = 2.0e-5;

/// Advances by one sample of a strong drive near the resonance.
class Driven
{
public:
  explicit Driven(const SystemParameters& parameters)
      : model(std::make_shared<const SwitchedModel>(parameters)), simulation_(model, period)
  {
  }

  void advance()
  {
    const double acceleration =
        50.0 * std::sin(1.6 * model->scales().frequency * period * static_cast<double>(simulation_.samples()));
    simulation_.advance(&acceleration, 1, &gap, &force, sink_);
    simulation_.structureCoordinates(coordinates);
  }

  std::shared_ptr<const SwitchedModel> model;
  double gap = 0.0;
  double force = 0.0;
  Eigen::VectorXd coordinates;

private:
  Recorder sink_;
  SampledSimulation simulation_;
};

/// Everything but zero clearance, contact at midspan and pinned ends.
SystemParameters oddCase(const BasisParameters& basis)
{
  SystemParameters parameters = limitingCase(300.0, basis);
  beamOf(parameters.beam1).ends = {End::clamped, End::free};
  beamOf(parameters.beam1).contact_location = 0.8 * beamOf(parameters.beam1).length;
  beamOf(parameters.beam2).youngs_modulus = beamOf(parameters.beam1).youngs_modulus * 3.0;
  beamOf(parameters.beam2).rigid_body = RigidBody{0.01, 2e-4, 1e-8};
  beamOf(parameters.beam2).contact_location += 0.002;
  parameters.contact.clearance = 2e-6;
  return parameters;
}

Eigen::Index indexOf(const std::vector<double>& positions, double x)
{
  return std::find(positions.begin(), positions.end(), x) - positions.begin();
}
}  // namespace

TEST(StructureShapes, theContactPointsAreAtTheGap)
{
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{4}), BasisParameters(ConjoinedBasis{4, 3})})
  {
    const SystemParameters parameters = oddCase(basis);
    Driven driven(parameters);
    const StructureShapes shapes(parameters, *driven.model, 41);
    ASSERT_EQ(shapes.size(), driven.model->structureModes().size());
    StructureShapes::Displacements displacements;
    int closed = 0;
    for (int i = 0; i < 3000; ++i)
    {
      driven.advance();
      closed += driven.force > 0.0 ? 1 : 0;
      shapes.displacements(driven.coordinates.data(), driven.gap, displacements);
      const double scale = displacements.along[0].cwiseAbs().maxCoeff() + displacements.along[1].cwiseAbs().maxCoeff();
      ASSERT_NEAR(displacements.contact_point[0] - displacements.contact_point[1] + parameters.contact.clearance,
                  driven.gap, 1e-9 * scale + 1e-18);
      for (std::size_t side = 0; side < 2; ++side)
      {
        const BeamParameters& beam = std::get<BeamParameters>(side == 0 ? parameters.beam1 : parameters.beam2);
        const Eigen::Index at = indexOf(shapes.positions(static_cast<int>(side) + 1), beam.contact_location);
        ASSERT_LT(at, displacements.along[side].size());
        ASSERT_NEAR(displacements.along[side](at), displacements.contact_point[side], 1e-9 * scale + 1e-18);
      }
      // clamped at x = 0, supported at both ends
      ASSERT_NEAR(displacements.along[0](0), 0.0, 1e-9 * scale);
      ASSERT_NEAR(displacements.along[1](0), 0.0, 1e-9 * scale);
      ASSERT_NEAR(displacements.along[1](displacements.along[1].size() - 1), 0.0, 1e-9 * scale);
    }
    EXPECT_GT(closed, 100);
  }
}

TEST(StructureShapes, bothBasesShowTheSameMotion)
{
  // Well converged, and driven alike: the curves differ by what the conjoined basis leaves out.
  const SystemParameters attachment = oddCase(AttachmentBasis{12});
  const SystemParameters conjoined = oddCase(ConjoinedBasis{24, 24});
  Driven first(attachment);
  Driven second(conjoined);
  const StructureShapes first_shapes(attachment, *first.model, 31);
  const StructureShapes second_shapes(conjoined, *second.model, 31);
  ASSERT_EQ(first_shapes.positions(2), second_shapes.positions(2));
  StructureShapes::Displacements a;
  StructureShapes::Displacements b;
  double difference = 0.0;
  double greatest = 0.0;
  for (int i = 0; i < 300; ++i)
  {
    first.advance();
    second.advance();
    first_shapes.displacements(first.coordinates.data(), first.gap, a);
    second_shapes.displacements(second.coordinates.data(), second.gap, b);
    for (std::size_t side = 0; side < 2; ++side)
    {
      difference = std::max(difference, (a.along[side] - b.along[side]).cwiseAbs().maxCoeff());
      greatest = std::max(greatest, a.along[side].cwiseAbs().maxCoeff());
    }
  }
  EXPECT_LT(difference, 0.03 * greatest);
}

TEST(StructureShapes, rigidSurfacesAndTablesHaveNoShape)
{
  SystemParameters parameters = rigidCase(1000.0, AttachmentBasis{3});
  const StructureShapes surface(parameters, SwitchedModel(parameters), 11);
  EXPECT_EQ(surface.positions(1).size(), 11u);  // the contact is one of them
  EXPECT_TRUE(surface.positions(2).empty());

  ModalTableParameters table;
  table.frequency_hz = {300.0, 900.0};
  table.contact_deflection = {20.0, -15.0};
  table.participation = {0.03, 0.01};
  parameters.beam2 = table;
  const SwitchedModel model(parameters);
  const StructureShapes shapes(parameters, model, 11);
  EXPECT_TRUE(shapes.positions(2).empty());
  Eigen::VectorXd coordinates = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(shapes.size()));
  coordinates.tail(2) << 1.0e-6, 2.0e-6;
  StructureShapes::Displacements displacements;
  shapes.displacements(coordinates.data(), 10.0e-6, displacements);
  EXPECT_NEAR(displacements.contact_point[1], -10.0e-6, 1e-18);
  EXPECT_EQ(displacements.contact_point[0], 0.0);
  EXPECT_EQ(displacements.along[1].size(), 0);
}
