#include "vibro_impact/core/switched_model.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "common.h"
#include "reference_system.h"
#include "sanitized.h"
#include "vibro_impact/core/beam.h"

using namespace vibro_impact::core;

namespace
{
/// f(omega) = 1/k + alpha_1 + alpha_2 relative to the size of its terms, from the beams' closed forms.
double characteristicResidual(const SystemParameters& parameters, double omega)
{
  const double spring = 1.0 / parameters.contact.stiffness;
  const double first = Beam(std::get<BeamParameters>(parameters.beam1)).receptance(omega);
  double second = 0.0;
  if (const auto* beam2 = std::get_if<BeamParameters>(&parameters.beam2))
  {
    second = Beam(*beam2).receptance(omega);
  }
  return (spring + first + second) / (spring + std::abs(first) + std::abs(second));
}

/// First symmetric root of 1 + k*(tan(l/2) - tanh(l/2))/(4 l^3) = 0 (rigid surface, spring at midspan), as (l/pi)^2, by
/// bisection.
double symmetricRoot(double relative_stiffness)
{
  const auto f = [relative_stiffness](double l)
  { return 1.0 + relative_stiffness * (std::tan(0.5 * l) - std::tanh(0.5 * l)) / (4.0 * l * l * l); };
  double low = pi * (1.0 + 1e-12);
  double high = 3.0 * pi * (1.0 - 1e-12);
  for (int i = 0; i < 200; ++i)
  {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return std::pow(low / pi, 2);
}

double smallestSpacing(const Eigen::ArrayXd& frequencies)
{
  double spacing = frequencies(0);
  for (Eigen::Index n = 1; n < frequencies.size(); ++n)
  {
    spacing = std::min(spacing, frequencies(n) - frequencies(n - 1));
  }
  return spacing;
}

/// Conjoined modes 1 ... count whose frequency is not a free one: these move the gap.
double lowestGapFrequency(const SwitchedModel& model)
{
  const LinearState& state = model.contact();
  for (Eigen::Index n = 0; n < state.size(); ++n)
  {
    if (state.contact_deflection(n) != 0.0)
    {
      return state.frequency(n);
    }
  }
  return 0.0;
}

SystemParameters unlikeBeams(double relative_stiffness, const BasisParameters& basis)
{
  SystemParameters parameters = limitingCase(relative_stiffness, basis);
  beamOf(parameters.beam1).contact_location = 0.31 * beamOf(parameters.beam1).length;
  auto& beam2 = std::get<BeamParameters>(parameters.beam2);
  beam2.youngs_modulus = 3.0e9;
  beam2.length = 0.071;
  beam2.contact_location = 0.0223;
  return parameters;
}
}  // namespace

TEST(SwitchedModel, rigidSurfaceHasThePublishedFrequencies)
{
  const struct
  {
    double relative_stiffness, expected, tolerance;
  } cases[] = {
      {10.0, 1.0976, 5e-5}, {100.0, 1.7295, 5e-5}, {1000.0, 4.0053, 5e-5}, {1e4, 5.9393, 5e-5}, {1e9, 6.249, 5e-4}};
  for (const auto& known : cases)
  {
    const SwitchedModel model(rigidCase(known.relative_stiffness, ConjoinedBasis{8, 8}));
    const double relative = lowestGapFrequency(model) / model.scales().frequency;
    EXPECT_NEAR(relative, known.expected, known.tolerance);
    EXPECT_NEAR(relative, symmetricRoot(known.relative_stiffness), 1e-9 * relative);
    // antisymmetric modes have their node at the contact
    EXPECT_NEAR((model.contact().frequency / model.scales().frequency - 4.0).abs().minCoeff(), 0.0, 1e-12);
    EXPECT_NEAR((model.contact().frequency / model.scales().frequency - 16.0).abs().minCoeff(), 0.0, 1e-11);
  }
}

TEST(SwitchedModel, identicalBeamsHaveARelativeAndCommonModes)
{
  SystemParameters parameters = limitingCase(1000.0, ConjoinedBasis{8, 8});
  parameters.beam2 = parameters.beam1;
  const SwitchedModel model(parameters);
  const Eigen::ArrayXd relative = model.contact().frequency / model.scales().frequency;
  EXPECT_NEAR(lowestGapFrequency(model) / model.scales().frequency, 4.8613, 5e-5);
  EXPECT_NEAR((relative - 1.0).abs().minCoeff(), 0.0, 1e-12);
  EXPECT_NEAR((relative - 9.0).abs().minCoeff(), 0.0, 1e-11);
  // the relative mode of identical beams is that of one beam on a spring of twice the stiffness on a rigid surface
  EXPECT_NEAR(lowestGapFrequency(model) / model.scales().frequency, symmetricRoot(2000.0), 1e-9);
}

TEST(SwitchedModel, conjoinedFrequenciesSolveTheClosedCharacteristicEquation)
{
  constexpr int count = sanitized ? 20 : 100;
  for (const double relative_stiffness : {1e-3, 1.0, 1e3, 1e6, 1e9})
  {
    for (const SystemParameters& parameters : {rigidCase(relative_stiffness, ConjoinedBasis{count, count}),
                                               limitingCase(relative_stiffness, ConjoinedBasis{count, count}),
                                               unlikeBeams(relative_stiffness, ConjoinedBasis{count, count})})
    {
      SCOPED_TRACE(relative_stiffness);
      const SwitchedModel model(parameters);
      ASSERT_EQ(model.contact().size(), count);
      for (Eigen::Index n = 0; n < count; ++n)
      {
        if (model.contact().contact_deflection(n) == 0.0)
        {
          continue;
        }
        // A root near a pole: the closed form's rounding is that of omega times its slope there. Bracket instead of
        // evaluating.
        const double omega = model.contact().frequency(n);
        const double below = characteristicResidual(parameters, omega * (1.0 - 1e-9));
        const double above = characteristicResidual(parameters, omega * (1.0 + 1e-9));
        const double at_pole = (model.free().frequency / omega - 1.0).abs().minCoeff();
        if (at_pole > 1e-8)
        {
          EXPECT_LT(below, 0.0) << "root " << n;
          EXPECT_GT(above, 0.0) << "root " << n;
        }
      }
    }
  }
}

TEST(SwitchedModel, frequenciesInContactInterlaceTheFreeOnes)
{
  for (const BasisParameters& basis : {BasisParameters(ConjoinedBasis{60, 60}), BasisParameters(AttachmentBasis{30})})
  {
    for (const double relative_stiffness : {1e-3, 1e3, 1e9})
    {
      const SwitchedModel model(unlikeBeams(relative_stiffness, basis));
      const Eigen::ArrayXd& free = model.free().frequency;
      const Eigen::ArrayXd& contact = model.contact().frequency;
      EXPECT_GE(smallestSpacing(contact), 0.0);
      for (Eigen::Index n = 0; n < contact.size(); ++n)
      {
        EXPECT_GE(contact(n), free(n));
        if (n + 1 < free.size())
        {
          EXPECT_LE(contact(n), free(n + 1));
        }
      }
    }
  }
}

TEST(SwitchedModel, attachmentMappingIsOrthogonalAndDiagonalisesTheStiffness)
{
  SystemParameters identical = limitingCase(1e3, AttachmentBasis{6});
  identical.beam2 = identical.beam1;
  for (const double relative_stiffness : {1e-3, 1.0, 1e3, 1e6, 1e9})
  {
    for (SystemParameters parameters :
         {limitingCase(relative_stiffness, AttachmentBasis{5}), rigidCase(relative_stiffness, AttachmentBasis{100}),
          unlikeBeams(relative_stiffness, AttachmentBasis{20}), identical})
    {
      SCOPED_TRACE(relative_stiffness);
      parameters.contact.stiffness = relative_stiffness * paperStiffnessUnit();
      const SwitchedModel model(parameters);
      const Eigen::MatrixXd& t = model.mapping();
      const Eigen::Index size = model.free().size();
      // in mass
      EXPECT_LT((t.transpose() * t - Eigen::MatrixXd::Identity(size, size)).cwiseAbs().maxCoeff(), 1e-13);
      EXPECT_LT((t * t.transpose() - Eigen::MatrixXd::Identity(size, size)).cwiseAbs().maxCoeff(), 1e-13);
      EXPECT_LT(model.mappingLoss().abs().maxCoeff(), 1e-13);
      // in stiffness, relative to the two modes
      const Eigen::VectorXd b = model.free().contact_deflection.matrix();
      Eigen::MatrixXd stiffness = model.free().frequency.square().matrix().asDiagonal();
      stiffness += parameters.contact.stiffness * b * b.transpose();
      const Eigen::MatrixXd diagonal = t.transpose() * stiffness * t;
      const double largest = stiffness.diagonal().cwiseAbs().sum();
      for (Eigen::Index i = 0; i < size; ++i)
      {
        EXPECT_NEAR(diagonal(i, i), std::pow(model.contact().frequency(i), 2), 1e-13 * largest);
        for (Eigen::Index j = 0; j < i; ++j)
        {
          EXPECT_NEAR(diagonal(i, j), 0.0, 1e-13 * largest);
        }
      }
      // the gap is the same in both states
      EXPECT_LT((t.transpose() * b - model.contact().contact_deflection.matrix()).cwiseAbs().maxCoeff(),
                1e-13 * b.cwiseAbs().maxCoeff());
    }
  }
}

TEST(SwitchedModel, attachmentMappingThereAndBackChangesNothing)
{
  const SwitchedModel model(unlikeBeams(1e3, AttachmentBasis{7}));
  const Eigen::VectorXd state = Eigen::VectorXd::LinSpaced(model.free().size(), -1.0, 2.0);
  const Eigen::VectorXd back = model.mapping() * (model.mapping().transpose() * state);
  EXPECT_LT((back - state).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(SwitchedModel, conjoinedModesAreOrthogonalInMassAndStiffnessOverManyFreeModes)
{
  // With all free modes T^T T = 1 and T^T (omega^2 + k b b^T) T is diagonal; what 400 of them miss falls as their
  // frequency^-3 (mass).
  const SystemParameters parameters = unlikeBeams(1e3, ConjoinedBasis{100, 6});
  const SwitchedModel model(parameters);
  const Eigen::MatrixXd& t = model.mapping();
  const Eigen::MatrixXd mass = t.transpose() * t;
  EXPECT_LT((mass - Eigen::MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(), 1e-9);
  const Eigen::VectorXd& d = model.contact().contact_deflection.matrix();
  const Eigen::MatrixXd strain = t.transpose() * model.free().frequency.square().matrix().asDiagonal() * t;
  const Eigen::MatrixXd stiffness = strain + parameters.contact.stiffness * d * d.transpose();
  const Eigen::MatrixXd expected = model.contact().frequency.square().matrix().asDiagonal();
  EXPECT_LT((stiffness - expected).cwiseAbs().maxCoeff(), 1e-4 * expected.maxCoeff());
}

TEST(SwitchedModel, conjoinedDataAreConsistent)
{
  for (const SystemParameters& parameters :
       {unlikeBeams(1e3, ConjoinedBasis{100, 10}), rigidCase(1e3, ConjoinedBasis{100, 10})})
  {
    const SwitchedModel model(parameters);
    const Eigen::MatrixXd& t = model.mapping();
    // d_n = T_n . b and Gamma_n = T_n . Gamma over all free modes; the rest beyond 100 is small
    const Eigen::VectorXd d = t.transpose() * model.free().contact_deflection.matrix();
    const Eigen::VectorXd participation = t.transpose() * model.free().participation.matrix();
    EXPECT_LT((d - model.contact().contact_deflection.matrix()).cwiseAbs().maxCoeff(), 1e-3 * d.cwiseAbs().maxCoeff());
    EXPECT_LT((participation - model.contact().participation.matrix()).cwiseAbs().maxCoeff(),
              1e-5 * participation.cwiseAbs().maxCoeff());
    // T_mn = -k d_n b_m/(omega_m^2 - omega_n^2)
    for (Eigen::Index n = 0; n < 10; ++n)
    {
      const double d_n = model.contact().contact_deflection(n);
      const double x = std::pow(model.contact().frequency(n), 2);
      for (Eigen::Index m = 0; d_n != 0.0 && m < 100; ++m)
      {
        const double expected = -parameters.contact.stiffness * d_n * model.free().contact_deflection(m) /
                                (std::pow(model.free().frequency(m), 2) - x);
        EXPECT_NEAR(t(m, n), expected, 1e-9 * (std::abs(expected) + 1e-3));
      }
    }
  }
}

TEST(SwitchedModel, twoAndTwoConjoinedModesLoseFivePercentASwitch)
{
  const SwitchedModel model(limitingCase(1000.0, ConjoinedBasis{2, 2}));
  EXPECT_NEAR(std::abs(model.mapping()(0, 0)), 0.974, 1e-3);
  EXPECT_NEAR(model.mappingLoss()(0), 0.05, 2e-3);
}

TEST(SwitchedModel, attachmentBasisHasTheStaticReceptanceOfTheBeams)
{
  // sum b^2/omega^2 over the coordinates is alpha_1(0) + alpha_2(0) exactly: that is what the attachment shapes are for
  const SystemParameters parameters = unlikeBeams(1e3, AttachmentBasis{2});
  const SwitchedModel model(parameters);
  const double expected = Beam(std::get<BeamParameters>(parameters.beam1)).staticReceptance(0) +
                          Beam(std::get<BeamParameters>(parameters.beam2)).staticReceptance(0);
  const double sum = (model.free().contact_deflection / model.free().frequency).square().sum();
  EXPECT_NEAR(sum, expected, 1e-13 * expected);
  // and of the static response to the base
  const double response =
      (model.free().contact_deflection * model.free().participation / model.free().frequency.square()).sum();
  const double expected_response = Beam(std::get<BeamParameters>(parameters.beam1)).staticBaseResponse(0) -
                                   Beam(std::get<BeamParameters>(parameters.beam2)).staticBaseResponse(0);
  EXPECT_NEAR(response, expected_response,
              1e-12 * Beam(std::get<BeamParameters>(parameters.beam1)).staticBaseResponse(0));
}

TEST(SwitchedModel, identicalBeamsHaveNoExcitationOfTheGapAtAll)
{
  for (const BasisParameters& basis : {BasisParameters(ConjoinedBasis{6, 6}), BasisParameters(AttachmentBasis{4})})
  {
    SystemParameters parameters = limitingCase(1e3, basis);
    parameters.beam2 = parameters.beam1;
    const SwitchedModel model(parameters);
    for (const LinearState* state : {&model.free(), &model.contact()})
    {
      for (Eigen::Index n = 0; n < state->size(); ++n)
      {
        EXPECT_EQ(state->contact_deflection(n) * state->participation(n), 0.0);
      }
    }
  }
}

TEST(SwitchedModel, refusesParametersOutOfRange)
{
  SystemParameters parameters = limitingCase(1e3, AttachmentBasis{5});
  parameters.contact.stiffness = -1.0;
  EXPECT_THROW(SwitchedModel{parameters}, std::invalid_argument);
}
