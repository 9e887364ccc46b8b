#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "reference_system.h"
#include "vibro_impact/core/beam.h"
#include "vibro_impact/core/modal_table.h"
#include "vibro_impact/core/switched_model.h"

using namespace vibro_impact::core;

namespace
{
BeamParameters beamWithEnds(End first, End last, double share)
{
  BeamParameters beam = paperBeam();
  beam.ends = {first, last};
  beam.contact_location = share * beam.length;
  return beam;
}

BeamParameters beamWithBody(End first, End last, double share)
{
  BeamParameters beam = beamWithEnds(first, last, share);
  const double mass = massPerLength(beam) * beam.length;
  beam.rigid_body = RigidBody{0.2 * beam.length, 0.7 * mass, 0.02 * mass * beam.length * beam.length};
  return beam;
}

/// The lowest modes of any structure as a table.
ModalTableParameters tableOf(const Structure& structure, int modes)
{
  ModalTableParameters table;
  for (int m = 1; m <= modes; ++m)
  {
    const Mode mode = structure.mode(m);
    table.frequency_hz.push_back(mode.frequency / two_pi);
    table.contact_deflection.push_back(mode.contact_deflection);
    table.participation.push_back(mode.participation);
  }
  return table;
}

/// A mass that moves freely along the base.
ModalTableParameters freeMass(double mass)
{
  ModalTableParameters table;
  table.frequency_hz = {0.0};
  table.contact_deflection = {1.0 / std::sqrt(mass)};
  table.participation = {std::sqrt(mass)};
  return table;
}

SystemParameters systemOf(const StructureParameters& first, const StructureParameters& second,
                          const BasisParameters& basis)
{
  SystemParameters parameters;
  parameters.beam1 = first;
  parameters.beam2 = second;
  parameters.contact = {1000.0 * paperStiffnessUnit(), 0.0};
  parameters.damping = {0.01, 0.05};
  parameters.basis = basis;
  return parameters;
}

/// Pairs of structures of all kinds, with motions as a rigid body on none, one and both sides.
std::vector<SystemParameters> manySystems(const BasisParameters& basis)
{
  const BeamParameters pinned = beamWithEnds(End::pinned, End::pinned, 0.4);
  const BeamParameters cantilever = beamWithEnds(End::clamped, End::free, 1.0);
  const BeamParameters free = beamWithEnds(End::free, End::free, 0.3);
  const BeamParameters free_middle = beamWithEnds(End::free, End::free, 0.5);
  const BeamParameters hinged = beamWithEnds(End::pinned, End::free, 0.8);
  const BeamParameters body = beamWithBody(End::clamped, End::clamped, 0.45);
  const BeamParameters free_body = beamWithBody(End::free, End::free, 0.5);
  const ModalTableParameters table = tableOf(Beam(beamWithEnds(End::clamped, End::pinned, 0.6)), 40);
  return {systemOf(cantilever, RigidSurface{}, basis),
          systemOf(RigidSurface{}, cantilever, basis),
          systemOf(free, RigidSurface{}, basis),
          systemOf(free_middle, pinned, basis),
          systemOf(hinged, free, basis),
          systemOf(free, free_middle, basis),
          systemOf(body, pinned, basis),
          systemOf(body, free_body, basis),
          systemOf(table, hinged, basis),
          systemOf(table, freeMass(0.001), basis),
          systemOf(free, free, basis),
          systemOf(beamWithEnds(End::clamped, End::pinned, 0.5), body, basis)};
}

double receptanceOf(const StructureParameters& parameters, double omega)
{
  const auto structure = makeStructure(parameters);
  return structure ? structure->receptance(omega) : 0.0;
}

double staticReceptanceOf(const StructureParameters& parameters)
{
  const auto structure = makeStructure(parameters);
  return structure ? structure->staticReceptance(structure->rigidBodyModeCount()) : 0.0;
}
}  // namespace

TEST(ModalTable, isTheStructureThatItListsTheModesOf)
{
  const Beam beam(beamWithEnds(End::pinned, End::free, 0.7));
  ModalTableParameters parameters = tableOf(beam, 30);
  std::swap(parameters.frequency_hz[3], parameters.frequency_hz[20]);  // in any order
  std::swap(parameters.contact_deflection[3], parameters.contact_deflection[20]);
  std::swap(parameters.participation[3], parameters.participation[20]);
  const ModalTable table(parameters);
  EXPECT_EQ(table.modeCount(), 30);
  EXPECT_EQ(table.rigidBodyModeCount(), 1);
  for (int m = 1; m <= 30; ++m)
  {
    EXPECT_NEAR(table.mode(m).frequency, beam.mode(m).frequency, 1e-15 * beam.mode(m).frequency);
    EXPECT_EQ(table.mode(m).contact_deflection, beam.mode(m).contact_deflection);
    EXPECT_FALSE(table.mode(m).damping_ratio);
  }
  for (const int kept : {1, 4, 29})
  {
    EXPECT_NEAR(table.staticReceptance(kept), beam.staticReceptance(kept) - beam.staticReceptance(30),
                1e-12 * beam.staticReceptance(1));
    EXPECT_NEAR(table.staticBaseResponse(kept), beam.staticBaseResponse(kept) - beam.staticBaseResponse(30),
                1e-12 * std::abs(beam.staticBaseResponse(1)));
  }
  EXPECT_EQ(table.staticReceptance(30), 0.0);
}

TEST(ModalTable, theStaticReceptanceCompletesIt)
{
  const Beam beam(beamWithEnds(End::pinned, End::pinned, 0.5));
  ModalTableParameters parameters = tableOf(beam, 6);
  parameters.static_receptance = beam.staticReceptance(0);
  const ModalTable table(parameters);
  ASSERT_EQ(table.modeCount(), 7);
  EXPECT_NEAR(table.staticReceptance(0), beam.staticReceptance(0), 1e-15);
  EXPECT_NEAR(table.staticReceptance(6) / beam.staticReceptance(6), 1.0, 1e-9);
  EXPECT_EQ(table.mode(7).participation, 0.0);
  for (const double relative : {0.5, 3.0, 12.0})
  {
    const double omega = relative * beam.mode(1).frequency;
    const double without = ModalTable(tableOf(beam, 6)).receptance(omega);
    EXPECT_LT(std::abs(table.receptance(omega) - beam.receptance(omega)),
              0.2 * std::abs(without - beam.receptance(omega)))
        << relative;
  }
  // with the digits of a file, and all modes in the list, nothing is left
  parameters.static_receptance = elasticReceptance(parameters) * (1.0 - 0.5 * table_rounding);
  EXPECT_EQ(ModalTable(parameters).modeCount(), 6);
}

TEST(Structures, frequenciesInContactSolveTheCharacteristicEquation)
{
  int number = 0;
  for (const SystemParameters& parameters : manySystems(ConjoinedBasis{20, 20}))
  {
    ++number;
    const SwitchedModel model(parameters);
    const LinearState& state = model.contact();
    ASSERT_GT(state.size(), 0) << number;
    const auto residual = [&](double omega)
    {
      return 1.0 / parameters.contact.stiffness + receptanceOf(parameters.beam1, omega) +
             receptanceOf(parameters.beam2, omega);
    };
    for (Eigen::Index n = 0; n < state.size(); ++n)
    {
      const double omega = state.frequency(n);
      if (std::abs(state.contact_deflection(n)) < 0.05 * state.contact_deflection.abs().maxCoeff())
      {
        continue;  // so near a pole that differences cannot give the slope
      }
      ASSERT_GT(omega, 0.0) << number;
      const double step = 1e-7 * omega;
      const double slope = (residual(omega + step) - residual(omega - step)) / (2.0 * step);
      EXPECT_NEAR(residual(omega) / slope / omega, 0.0, 1e-9) << "system " << number << ", mode " << n;
      // f' = 2 omega/(k d)^2
      EXPECT_NEAR(slope * std::pow(parameters.contact.stiffness * state.contact_deflection(n), 2) / (2.0 * omega), 1.0,
                  1e-3)
          << "system " << number << ", mode " << n;
    }
  }
}

TEST(Structures, theAttachmentBasisConvergesToTheConjoinedModes)
{
  int number = 0;
  const std::vector<SystemParameters> conjoined = manySystems(ConjoinedBasis{6, 6});
  for (const SystemParameters& parameters : manySystems(AttachmentBasis{12}))
  {
    const SwitchedModel exact(conjoined[static_cast<std::size_t>(number)]);
    ++number;
    const SwitchedModel model(parameters);
    for (Eigen::Index n = 0; n < exact.contact().size(); ++n)
    {
      EXPECT_NEAR(model.contact().frequency(n), exact.contact().frequency(n), 1e-3 * exact.contact().frequency(n))
          << "system " << number << ", mode " << n;
    }
  }
}

TEST(Structures, modesAreOrthogonalInBothStates)
{
  int number = 0;
  for (const SystemParameters& parameters : manySystems(AttachmentBasis{7}))
  {
    ++number;
    const SwitchedModel model(parameters);
    const Eigen::MatrixXd& T = model.mapping();
    ASSERT_EQ(T.rows(), T.cols());
    EXPECT_LT((T.transpose() * T - Eigen::MatrixXd::Identity(T.cols(), T.cols())).cwiseAbs().maxCoeff(), 1e-13)
        << number;
    const Eigen::VectorXd b = model.free().contact_deflection.matrix();
    Eigen::MatrixXd stiffness = parameters.contact.stiffness * b * b.transpose();
    stiffness.diagonal() += model.free().frequency.square().matrix();
    const Eigen::MatrixXd modal = T.transpose() * stiffness * T;
    const Eigen::MatrixXd expected = model.contact().frequency.square().matrix().asDiagonal();
    EXPECT_LT((modal - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.maxCoeff()) << number;
    EXPECT_LT((T.transpose() * b - model.contact().contact_deflection.matrix()).cwiseAbs().maxCoeff(), 1e-11 * b.norm())
        << number;
    EXPECT_LT((T.transpose() * model.free().participation.matrix() - model.contact().participation.matrix())
                  .cwiseAbs()
                  .maxCoeff(),
              1e-11 * model.free().participation.matrix().norm())
        << number;
  }
}

TEST(Structures, motionsAsARigidBodyAreKeptApart)
{
  int number = 0;
  for (const SystemParameters& parameters : manySystems(AttachmentBasis{1}))
  {
    ++number;
    const SwitchedModel model(parameters);
    int rigid = 0;
    for (const StructureParameters& side : {parameters.beam1, parameters.beam2})
    {
      const auto structure = makeStructure(side);
      rigid += structure ? structure->rigidBodyModeCount() : 0;
    }
    const LinearState& free = model.free();
    EXPECT_EQ((free.frequency == 0.0).count(), rigid) << number;
    EXPECT_LE((free.frequency == 0.0 && free.contact_deflection != 0.0).count(), 1) << number;
    const LinearState& contact = model.contact();
    EXPECT_EQ((contact.frequency == 0.0).count(), std::max(0, rigid - 1)) << number;
    EXPECT_EQ((contact.frequency == 0.0 && contact.contact_deflection != 0.0).count(), 0) << number;
    // one mode a side, or those as a rigid body, and an attachment shape give the static receptance
    double receptance = 0.0;
    for (Eigen::Index n = 0; n < free.size(); ++n)
    {
      receptance += free.frequency(n) > 0.0 ? std::pow(free.contact_deflection(n) / free.frequency(n), 2) : 0.0;
    }
    const double expected = staticReceptanceOf(parameters.beam1) + staticReceptanceOf(parameters.beam2);
    EXPECT_NEAR(receptance, expected, 1e-10 * expected) << number;
    // all that moves takes part in what the base does
    EXPECT_NEAR(model.contact().participation.square().sum(), free.participation.square().sum(),
                1e-12 * free.participation.square().sum())
        << number;
  }
}

TEST(Structures, aFreeMassOnASurfaceBouncesOnTheSpringAlone)
{
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{5}), BasisParameters(ConjoinedBasis{2, 2})})
  {
    const SystemParameters parameters = systemOf(freeMass(0.02), RigidSurface{}, basis);
    const SwitchedModel model(parameters);
    ASSERT_EQ(model.free().size(), 1);
    ASSERT_EQ(model.contact().size(), 1);
    EXPECT_EQ(model.free().frequency(0), 0.0);
    EXPECT_NEAR(model.contact().frequency(0), std::sqrt(parameters.contact.stiffness / 0.02), 1e-9);
    EXPECT_NEAR(std::abs(model.mapping()(0, 0)), 1.0, 1e-15);
    EXPECT_EQ(model.scales().frequency, 1.0);
    EXPECT_EQ(model.scales().stiffness, 1.0);
  }
  // two free masses: their relative motion has the reduced mass, their common motion stays free
  const SwitchedModel model(systemOf(freeMass(0.02), freeMass(0.03), AttachmentBasis{5}));
  ASSERT_EQ(model.contact().size(), 2);
  EXPECT_EQ(model.contact().frequency(0), 0.0);
  EXPECT_EQ(model.contact().contact_deflection(0), 0.0);
  EXPECT_NEAR(model.contact().participation.square().sum(), 0.05, 1e-15);
  EXPECT_NEAR(model.contact().frequency(1), std::sqrt(1000.0 * paperStiffnessUnit() / 0.012), 1e-9);
}

TEST(Structures, aTableOfABeamGivesTheModelOfTheBeam)
{
  const BeamParameters beam = beamWithEnds(End::clamped, End::free, 0.9);
  const BeamParameters other = beamWithEnds(End::free, End::pinned, 0.4);
  ModalTableParameters table = tableOf(Beam(beam), 20);
  table.static_receptance = Beam(beam).staticReceptance(0);
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{5}), BasisParameters(ConjoinedBasis{8, 8})})
  {
    const SwitchedModel expected(systemOf(beam, other, basis));
    const SwitchedModel model(systemOf(table, other, basis));
    ASSERT_EQ(model.free().size(), expected.free().size());
    ASSERT_EQ(model.contact().size(), expected.contact().size());
    EXPECT_LT((model.free().frequency - expected.free().frequency).abs().maxCoeff(),
              2e-4 * expected.free().frequency.maxCoeff());
    EXPECT_LT((model.contact().frequency - expected.contact().frequency).abs().maxCoeff(),
              2e-4 * expected.contact().frequency.maxCoeff());
    // its scales are its own: the stiffness is that at the contact, the length 1 m
    EXPECT_NEAR(model.scales().frequency, expected.scales().frequency, 1e-12 * expected.scales().frequency);
    EXPECT_NEAR(model.scales().stiffness * *table.static_receptance, 1.0, 1e-10);
    EXPECT_EQ(model.scales().length, 1.0);
  }
}

TEST(Structures, shortTablesGiveWhatTheyHave)
{
  ModalTableParameters table;
  table.frequency_hz = {100.0, 0.0, 250.0};
  table.contact_deflection = {1.5, 0.5, 0.0};
  table.participation = {0.3, 0.8, 0.1};
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{50}), BasisParameters(ConjoinedBasis{50, 50})})
  {
    const SwitchedModel model(systemOf(table, RigidSurface{}, basis));
    ASSERT_EQ(model.free().size(), 3);
    ASSERT_EQ(model.contact().size(), 3);
    EXPECT_LT(model.mappingLoss().abs().maxCoeff(), 1e-14);
    EXPECT_EQ(model.free().frequency(0), 0.0);
    EXPECT_NEAR(model.free().frequency(1), two_pi * 100.0, 1e-12);
    EXPECT_NEAR(model.scales().frequency, two_pi * 100.0, 1e-12);
    EXPECT_NEAR(model.scales().stiffness, std::pow(two_pi * 100.0 / 1.5, 2), 1e-6);
  }
  // one mode a side, and what is left of each has a shape only where it moves the contact
  EXPECT_EQ(SwitchedModel(systemOf(table, RigidSurface{}, AttachmentBasis{1})).free().size(), 2);
  table.contact_deflection = {1.5, 0.5, 1.0};
  EXPECT_EQ(SwitchedModel(systemOf(table, RigidSurface{}, AttachmentBasis{2})).free().size(), 3);
  EXPECT_EQ(SwitchedModel(systemOf(table, table, ConjoinedBasis{4, 50})).contact().size(), 6);
}

TEST(Structures, modesOfATableKeepTheirDampingWhileApart)
{
  ModalTableParameters table;
  table.frequency_hz = {0.0, 100.0, 250.0, 400.0};
  table.contact_deflection = {0.5, 1.5, 1.0, 0.7};
  table.participation = {0.8, 0.3, 0.1, 0.0};
  table.damping_ratio = {0.5, 0.03, 0.002, 0.2};
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{3}), BasisParameters(ConjoinedBasis{3, 3})})
  {
    const SwitchedModel model(systemOf(table, RigidSurface{}, basis));
    EXPECT_EQ(model.free().damping_ratio(0), 0.5);
    EXPECT_EQ(model.free().damping_ratio(1), 0.03);
    EXPECT_EQ(model.free().damping_ratio(2), 0.002);
    EXPECT_TRUE((model.contact().damping_ratio == 0.05).all());
  }
  // the attachment shape has that of the configuration
  EXPECT_EQ(SwitchedModel(systemOf(table, RigidSurface{}, AttachmentBasis{3})).free().damping_ratio(3), 0.01);
  // of two modes of one frequency, the motion that moves the gap has its share of both
  table.frequency_hz = {100.0, 100.0};
  table.contact_deflection = {3.0, 4.0};
  table.participation = {0.3, 0.4};
  table.damping_ratio = {0.1, 0.2};
  const SwitchedModel model(systemOf(table, RigidSurface{}, AttachmentBasis{2}));
  EXPECT_NEAR(model.free().contact_deflection(0), 5.0, 1e-14);
  EXPECT_NEAR(model.free().damping_ratio(0), (9.0 * 0.1 + 16.0 * 0.2) / 25.0, 1e-14);
}

TEST(Structures, scalesAreThoseOfTheFirstStructureThatBends)
{
  const auto scales = [](const StructureParameters& first, const StructureParameters& second)
  { return referenceScales(systemOf(first, second, AttachmentBasis{})); };
  const BeamParameters beam = paperBeam();
  const double unit = paperStiffnessUnit();
  const double omega = std::sqrt(bendingStiffness(beam) / massPerLength(beam)) / std::pow(beam.length, 2);
  const struct
  {
    End first, last;
    double wave_number, stiffness;  // of a force at midspan
  } cases[] = {{End::pinned, End::pinned, 3.141592653589793, 48.0},
               {End::clamped, End::clamped, 4.730040744862704, 192.0},
               {End::clamped, End::free, 1.875104068711961, 24.0},
               {End::clamped, End::pinned, 3.926602312047919, 768.0 / 7.0},
               {End::free, End::free, 4.730040744862704, 320.0}};
  for (const auto& known : cases)
  {
    const ReferenceScales found = scales(beamWithEnds(known.first, known.last, 0.7), RigidSurface{});
    EXPECT_NEAR(found.frequency / (known.wave_number * known.wave_number * omega), 1.0, 1e-13);
    EXPECT_NEAR(found.stiffness / (known.stiffness * unit), 1.0, 1e-13);
    EXPECT_EQ(found.length, beam.length);
  }
  EXPECT_EQ(scales(RigidSurface{}, beam).frequency, scales(beam, RigidSurface{}).frequency);
  EXPECT_EQ(scales(freeMass(0.1), beam).stiffness, scales(beam, RigidSurface{}).stiffness);
}

TEST(Structures, sidesCanBeExchanged)
{
  const BeamParameters beam = beamWithBody(End::clamped, End::pinned, 0.55);
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{4}), BasisParameters(ConjoinedBasis{5, 4})})
  {
    const SwitchedModel one(systemOf(beam, RigidSurface{}, basis));
    const SwitchedModel other(systemOf(RigidSurface{}, beam, basis));
    EXPECT_EQ((one.free().frequency - other.free().frequency).abs().maxCoeff(), 0.0);
    EXPECT_EQ((one.contact().frequency - other.contact().frequency).abs().maxCoeff(), 0.0);
    EXPECT_EQ((one.free().contact_deflection + other.free().contact_deflection).abs().maxCoeff(), 0.0);
    EXPECT_EQ((one.free().participation - other.free().participation).abs().maxCoeff(), 0.0);
  }
}
