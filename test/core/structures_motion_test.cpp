// Structures of every kind in motion, against an independent integrator.

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "independent_integrator.h"
#include "switched_motion.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
namespace
{
/// Of unit length, bending stiffness and mass.
BeamParameters unitBeam(End first, End last, double contact)
{
  BeamParameters beam;
  beam.length = 1.0;
  beam.cross_section = Section{1.0, 1.0};
  beam.ends = {first, last};
  beam.contact_location = contact;
  return beam;
}

TEST(StructuresInMotion, agreeWithAnIndependentIntegrator)
{
  BeamParameters body = unitBeam(End::clamped, End::clamped, 0.55);
  body.rigid_body = RigidBody{0.2, 0.7, 0.01};
  BeamParameters free_body = unitBeam(End::free, End::free, 0.5);
  free_body.rigid_body = RigidBody{0.1, 0.5, 0.02};
  ModalTableParameters table;
  table.frequency_hz = {0.5, 1.7, 4.1};
  table.contact_deflection = {1.1, -0.7, 0.4};
  table.participation = {0.8, 0.3, -0.2};
  table.damping_ratio = {0.03, 0.01, 0.002};
  table.static_receptance = 0.14;
  const struct
  {
    StructureParameters first, second;
  } systems[] = {{unitBeam(End::clamped, End::free, 0.9), RigidSurface{}},
                 {RigidSurface{}, unitBeam(End::clamped, End::pinned, 0.4)},
                 {body, unitBeam(End::pinned, End::free, 0.8)},
                 {unitBeam(End::free, End::free, 0.3), body},
                 {free_body, table},
                 {table, unitBeam(End::pinned, End::free, 0.7)}};
  const double frequency = 5.0;
  const double cycle = 2.0 * pi / frequency;
  int number = 0;
  for (const auto& system : systems)
  {
    SCOPED_TRACE(++number);
    SystemParameters parameters;
    parameters.beam1 = system.first;
    parameters.beam2 = system.second;
    parameters.contact = {200.0, 0.01};
    parameters.damping = {0.02, 0.05};
    parameters.basis = AttachmentBasis{2};
    const auto model = std::make_shared<const SwitchedModel>(parameters);
    SwitchedMotion motion(model, true);
    Integrator integrator(model, [&](double time) { return -std::cos(frequency * time); });
    // Both approach each other, so that those touch that nothing holds.
    const Eigen::VectorXd displacement = Eigen::VectorXd::Zero(model->free().size());
    Eigen::VectorXd velocity = displacement;
    for (Eigen::Index n = 0; n < 2; ++n)
    {
      velocity(n) = -0.1 * std::copysign(1.0, model->free().contact_deflection(n));
    }
    motion.setFreeCoordinates(displacement, velocity);
    integrator.startFree(displacement, velocity);
    motion.setHarmonicDrive(frequency, 1.0);
    Recorder recorder;
    double greatest = 0.0;
    for (int i = 1; i <= 4; ++i)
    {
      motion.advanceHarmonic(recorder);
      integrator.advance(i * cycle);
      ASSERT_EQ(motion.inContact(), integrator.inContact()) << "cycle " << i;
      greatest = std::max(greatest, integrator.displacement().norm());
      Eigen::VectorXd found;
      Eigen::VectorXd rate;
      motion.coordinates(found, rate);
      EXPECT_LE((found - integrator.displacement()).norm(), 1e-8 * greatest) << "cycle " << i;
    }
    ASSERT_EQ(recorder.impacts.size(), integrator.episodes().size());
    ASSERT_GT(recorder.impacts.size(), 0u);
    for (std::size_t i = 0; i < recorder.impacts.size(); ++i)
    {
      EXPECT_NEAR(recorder.impacts[i].duration, integrator.episodes()[i].duration, 1e-7) << "impact " << i;
      EXPECT_NEAR(recorder.impacts[i].impulse, integrator.episodes()[i].impulse, 1e-8) << "impact " << i;
    }
  }
}

}  // namespace
}  // namespace vibro_impact::core
