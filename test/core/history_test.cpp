// Initial motions, and the history of a motion.

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "reference_system.h"
#include "vibro_impact/core/beam.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/simulation.h"

namespace vibro_impact::core
{
namespace
{
SystemParameters identicalBeams(const BasisParameters& basis)
{
  SystemParameters parameters = limitingCase(1000.0, basis);
  parameters.beam2 = parameters.beam1;
  return parameters;
}

std::shared_ptr<const SwitchedModel> makeModel(const SystemParameters& parameters)
{
  return std::make_shared<const SwitchedModel>(parameters);
}

class History : public ::testing::TestWithParam<BasisParameters>
{
};

TEST_P(History, doesNotDisturbTheMotion)
{
  const auto model = makeModel(limitingCase(1000.0, GetParam()));
  const double frequency = 1.6 * model->scales().frequency;
  HarmonicSimulation alone(model);
  alone.setDrive(frequency, 10.0);
  Recorder expected;
  alone.advance(40, expected);
  HarmonicSimulation observed(model);
  observed.setDrive(frequency, 10.0);
  Recorder found;
  std::vector<HistorySample> history(40 * 37);
  observed.advance(10, found, 37, history.data());
  observed.advance(30, found, 37, history.data() + 370);
  EXPECT_EQ(observed.sample().gap, alone.sample().gap);
  EXPECT_EQ(observed.sample().gap_velocity, alone.sample().gap_velocity);
  ASSERT_EQ(found.impacts.size(), expected.impacts.size());
  ASSERT_GT(found.impacts.size(), 20u);
  for (std::size_t i = 0; i < found.impacts.size(); ++i)
  {
    EXPECT_EQ(found.impacts[i].offset, expected.impacts[i].offset);
    EXPECT_EQ(found.impacts[i].impulse, expected.impacts[i].impulse);
    EXPECT_EQ(found.impacts[i].energy_lost, expected.impacts[i].energy_lost);
  }
  for (std::size_t i = 0; i < history.size(); ++i)
  {
    const double cycles = static_cast<double>(i + 1) / 37.0;
    EXPECT_NEAR(history[i].time * frequency, two_pi * cycles, 1e-12 * cycles);
    EXPECT_NEAR(history[i].acceleration, -10.0 * std::cos(two_pi * cycles), 1e-11);
  }
  EXPECT_EQ(history.back().gap, observed.sample().gap);
}

TEST_P(History, isThatOfTheMotion)
{
  SystemParameters parameters = limitingCase(1000.0, GetParam());
  parameters.contact.clearance = 2e-7;
  const auto model = makeModel(parameters);
  const double frequency = 1.6 * model->scales().frequency;
  constexpr std::size_t per_cycle = 20000;
  constexpr std::size_t cycles = 6;
  std::vector<HistorySample> history(cycles * per_cycle);
  HarmonicSimulation simulation(model);
  simulation.setDrive(frequency, 10.0);
  Recorder recorder;
  simulation.advance(cycles, recorder, per_cycle, history.data());
  const double step = history[0].time;
  double impulse = 0.0;
  double greatest = 0.0;
  for (const HistorySample& sample : history)
  {
    EXPECT_NEAR(sample.force, sample.in_contact ? -parameters.contact.stiffness * sample.gap : 0.0, 1e-12);
    impulse += sample.force * step;
    greatest = std::max(greatest, std::abs(sample.gap_velocity));
  }
  for (std::size_t i = 1; i + 1 < history.size(); ++i)
  {
    if (history[i - 1].in_contact == history[i + 1].in_contact)
    {
      EXPECT_NEAR((history[i + 1].gap - history[i - 1].gap) / (2.0 * step), history[i].gap_velocity, 1e-3 * greatest);
    }
  }
  double expected = 0.0;
  for (const Impact& impact : recorder.impacts)
  {
    expected += impact.impulse;
  }
  ASSERT_GT(recorder.impacts.size(), 3u);
  ASSERT_FALSE(history.back().in_contact);
  EXPECT_NEAR(impulse, expected, 1e-5 * expected);

  // Fewer samples are some of these.
  std::vector<HistorySample> coarse(cycles * 16);
  HarmonicSimulation again(model);
  again.setDrive(frequency, 10.0);
  again.advance(cycles, recorder, 16, coarse.data());
  for (std::size_t i = 0; i < coarse.size(); ++i)
  {
    const HistorySample& same = history[(i + 1) * per_cycle / 16 - 1];
    EXPECT_EQ(coarse[i].in_contact, same.in_contact);
    EXPECT_NEAR(coarse[i].gap, same.gap, 1e-19);
    EXPECT_NEAR(coarse[i].energy.stored(), same.energy.stored(), 1e-12 * same.energy.stored());
  }
}

TEST_P(History, ofASampledRunIsWhatItAnswers)
{
  const auto model = makeModel(limitingCase(1000.0, GetParam()));
  const double frequency = 1.6 * model->scales().frequency;
  SampledSimulation simulation(model, 2e-5);
  Recorder recorder;
  bool contact = false;
  for (int i = 0; i < 2000; ++i)
  {
    const double acceleration = 10.0 * std::cos(frequency * 2e-5 * i);
    double gap = 0.0;
    double force = 0.0;
    simulation.advance(&acceleration, 1, &gap, &force, recorder);
    const HistorySample sample = simulation.sample();
    EXPECT_NEAR(sample.time, 2e-5 * i, 1e-12);
    EXPECT_EQ(sample.acceleration, acceleration);
    EXPECT_EQ(sample.gap, gap);
    EXPECT_EQ(sample.force, force);
    contact |= sample.in_contact;
  }
  EXPECT_TRUE(contact);
}

TEST_P(History, startsInTheGivenMotion)
{
  // Of identical beams the modes of both structures are mixed in the coordinates of the model.
  for (SystemParameters parameters :
       {identicalBeams(GetParam()), limitingCase(1000.0, GetParam()), rigidCase(1000.0, GetParam())})
  {
    parameters.contact.clearance = 1.0;
    const auto model = makeModel(parameters);
    const Beam beam(beamOf(parameters.beam1));
    InitialMotion motion;
    motion.structure1 = {{0.001}, {0.3}};
    const auto* beam2 = std::get_if<BeamParameters>(&parameters.beam2);
    if (beam2 != nullptr && beam2->youngs_modulus == beamOf(parameters.beam1).youngs_modulus)
    {
      motion.structure2 = {{}, {0.1}};
    }
    HarmonicSimulation harmonic(model);
    SampledSimulation sampled(model, 1e-5);
    Recorder recorder;
    harmonic.start(motion);
    sampled.start(motion, recorder);
    for (const HistorySample& sample : {harmonic.sample(), sampled.sample()})
    {
      const Mode mode = beam.mode(1);
      EXPECT_NEAR(sample.gap, 1.0 + mode.contact_deflection * 0.001, 1e-14);
      const double stored = 0.5 * (0.3 * 0.3 + std::pow(mode.frequency * 0.001, 2));
      EXPECT_NEAR(sample.energy.structure1, stored, 1e-14);
      EXPECT_NEAR(sample.energy.structure2, motion.structure2.velocity.empty() ? 0.0 : 0.5 * 0.1 * 0.1, 1e-16);
      EXPECT_EQ(sample.energy.spring, 0.0);
      EXPECT_FALSE(sample.in_contact);
      EXPECT_EQ(sample.time, 0.0);
    }
    double gap = 0.0;
    double force = 0.0;
    const double none = 0.0;
    sampled.advance(&none, 1, &gap, &force, recorder);
    EXPECT_NEAR(gap, harmonic.sample().gap, 1e-15) << "sample 0 is the start";
  }
}

TEST_P(History, refusesAnInitialMotionThatTheBasisDoesNotHave)
{
  HarmonicSimulation simulation(makeModel(rigidCase(1000.0, GetParam())));
  const auto message = [&simulation](const InitialMotion& motion)
  {
    try
    {
      simulation.start(motion);
    }
    catch (const std::invalid_argument& error)
    {
      return std::string(error.what());
    }
    return std::string();
  };
  InitialMotion motion;
  motion.structure1.velocity.assign(50, 1.0);
  EXPECT_NE(message(motion).find("initial velocity of structure 1, mode "), std::string::npos) << message(motion);
  EXPECT_NE(message(motion).find("allowed: modes 1 to "), std::string::npos);
  motion = InitialMotion();
  motion.structure2.displacement = {1.0};
  EXPECT_NE(
      message(motion).find("initial displacement of structure 2, mode 1: 1.000000; allowed: none, it has no modes"),
      std::string::npos)
      << message(motion);
  motion = InitialMotion();
  motion.structure1.displacement = {std::numeric_limits<double>::infinity()};
  EXPECT_NE(message(motion).find("mode 1: inf; allowed: finite"), std::string::npos);
}

TEST_P(History, energiesOfStructuresAndSpringAreAllThereIs)
{
  for (SystemParameters parameters :
       {identicalBeams(GetParam()), limitingCase(1000.0, GetParam()), rigidCase(73223.0, GetParam())})
  {
    beamOf(parameters.beam1).contact_location = 0.021;
    parameters.contact.clearance = -1e-7;
    const SwitchedModel model(parameters);
    for (const LinearState* state : {&model.free(), &model.contact()})
    {
      const bool contact = state == &model.contact();
      const StructureEnergy& first = contact ? model.contactEnergy(1) : model.freeEnergy(1);
      const StructureEnergy& second = contact ? model.contactEnergy(2) : model.freeEnergy(2);
      const Eigen::VectorXd unit = Eigen::VectorXd::Ones(state->size());
      EXPECT_NEAR((first.kinetic + second.kinetic - Eigen::MatrixXd(unit.asDiagonal())).norm(), 0.0, 1e-12);
      Eigen::MatrixXd stiffness = first.strain + second.strain;
      if (contact)
      {
        stiffness +=
            model.stiffness() * state->contact_deflection.matrix() * state->contact_deflection.matrix().transpose();
      }
      // In units of the frequencies of row and column.
      const Eigen::VectorXd scale = state->frequency.inverse().matrix();
      const Eigen::MatrixXd scaled = scale.asDiagonal() * stiffness * scale.asDiagonal();
      EXPECT_NEAR((scaled - Eigen::MatrixXd(unit.asDiagonal())).norm(), 0.0, 1e-10) << contact;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bases, History,
                         ::testing::Values(BasisParameters(ConjoinedBasis{2, 2}), BasisParameters(ConjoinedBasis{6, 6}),
                                           BasisParameters(AttachmentBasis{3})));

}  // namespace
}  // namespace vibro_impact::core
