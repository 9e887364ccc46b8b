#include "switched_motion.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "reference_system.h"
#include "vibro_impact/core/beam.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/simulation.h"

using namespace vibro_impact::core;

namespace
{
std::shared_ptr<const SwitchedModel> makeModel(const SystemParameters& parameters)
{
  return std::make_shared<const SwitchedModel>(parameters);
}

/// A mass of 100 kg on a spring of 1e4 N/m (10 rad/s), `clearance` away from a stop.
std::shared_ptr<const SwitchedModel> oneMass(double stop_stiffness, double clearance,
                                             const DampingParameters& damping = {})
{
  const std::vector<Mode> modes = {Mode{10.0, 0.1, 10.0}};
  return std::make_shared<const SwitchedModel>(modes, ContactParameters{stop_stiffness, clearance}, damping);
}

/// Displacement (m) and velocity (m/s) of that mass.
void setMass(SwitchedMotion& motion, double displacement, double velocity)
{
  motion.setFreeCoordinates(Eigen::VectorXd::Constant(1, displacement / 0.1),
                            Eigen::VectorXd::Constant(1, velocity / 0.1));
}

void runWithoutDrive(SwitchedMotion& motion, int intervals, ImpactSink& sink)
{
  for (int i = 0; i < intervals; ++i)
  {
    motion.advanceLinear(0.0, 0.0, sink);
  }
}

double onsetTime(const Impact& impact, double interval)
{
  return static_cast<double>(impact.interval) * interval + impact.offset;
}

std::vector<double> noise(std::size_t count, double amplitude)
{
  std::vector<double> samples(count);
  std::uint64_t state = 12345;
  for (double& sample : samples)
  {
    state = state * 6364136223846793005u + 1442695040888963407u;
    sample = amplitude * (static_cast<double>(state >> 11) / 4503599627370496.0 - 1.0);
  }
  return samples;
}

struct SampledRun
{
  std::vector<double> gap, force;
  std::vector<Impact> impacts;
};

SampledRun simulate(const std::shared_ptr<const SwitchedModel>& model, const std::vector<double>& acceleration,
                    double period)
{
  SampledRun run;
  run.gap.resize(acceleration.size());
  run.force.resize(acceleration.size());
  Recorder recorder;
  SampledSimulation simulation(model, period);
  simulation.advance(acceleration.data(), acceleration.size(), run.gap.data(), run.force.data(), recorder);
  run.impacts = recorder.impacts;
  EXPECT_EQ(simulation.switchLimitReached(), 0u);
  return run;
}

std::vector<double> sine(std::size_t count, double amplitude, double omega, double period)
{
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    samples[i] = amplitude * std::sin(omega * static_cast<double>(i) * period);
  }
  return samples;
}
}  // namespace

// Known answers ------------------------------------------------------------------------------------------------------

TEST(SwitchedMotion, massThrownAtAStop)
{
  for (const double interval : {1e-4, 0.01, 0.5})  // the last holds the whole contact
  {
    SwitchedMotion motion(oneMass(1e6, 0.0), false);
    motion.setInterval(interval);
    setMass(motion, 0.0, -1.0);
    Recorder recorder;
    runWithoutDrive(motion, static_cast<int>(0.25 / interval) + 1, recorder);
    ASSERT_GE(recorder.impacts.size(), 1u);
    const Impact& impact = recorder.impacts.front();
    const double omega = std::sqrt(1.01e4);
    EXPECT_NEAR(impact.duration, 0.03126, 5e-6);
    EXPECT_NEAR(impact.peak_force, 9950.4, 0.05);
    EXPECT_NEAR(impact.impulse, 198.02, 5e-3);
    EXPECT_NEAR(impact.duration, pi / omega, 1e-11);
    EXPECT_NEAR(impact.peak_force, 1e6 / omega, 1e-6);
    EXPECT_NEAR(impact.peak_time, 0.5 * pi / omega, 1e-8);
    EXPECT_NEAR(impact.impulse, 2.0 * 1e6 / (omega * omega), 1e-9);
    EXPECT_NEAR(impact.approach_speed, 1.0, 1e-12);
    EXPECT_NEAR(impact.separation_speed, 1.0, 1e-12);
    EXPECT_NEAR(impact.energy_lost, 0.0, 1e-11);
    EXPECT_FALSE(impact.cut_short);
  }
}

TEST(SwitchedMotion, undampedPeriodIsHalfAPeriodOfEachState)
{
  const double interval = 0.0037;
  SwitchedMotion motion(oneMass(1e6, 0.0), false);
  motion.setInterval(interval);
  setMass(motion, 0.0, -1.0);
  Recorder recorder;
  runWithoutDrive(motion, 10000, recorder);
  ASSERT_GT(recorder.impacts.size(), 100u);
  const double period = pi / 10.0 + pi / std::sqrt(1.01e4);
  for (std::size_t i = 0; i < recorder.impacts.size(); ++i)
  {
    EXPECT_NEAR(onsetTime(recorder.impacts[i], interval), static_cast<double>(i) * period,
                1e-11 * static_cast<double>(i + 1));
  }
}

TEST(SwitchedMotion, dampedContactLosesTheEnergyOfItsDecay)
{
  const double ratio = 0.1;
  SwitchedMotion motion(oneMass(1e6, 0.0, {0.0, ratio}), false);
  motion.setInterval(1e-3);
  setMass(motion, 0.0, -1.0);
  Recorder recorder;
  runWithoutDrive(motion, 100, recorder);
  ASSERT_GE(recorder.impacts.size(), 1u);
  const double factor = std::exp(-pi * ratio / std::sqrt(1.0 - ratio * ratio));  // half a damped period
  EXPECT_NEAR(recorder.impacts[0].separation_speed, factor, 1e-12);
  EXPECT_NEAR(recorder.impacts[0].energy_lost, 50.0 * (1.0 - factor * factor), 1e-9);
}

TEST(SwitchedMotion, responseToARampOfTheBaseIsExact)
{
  // eta'' + omega^2 eta = -Gamma s t from rest: eta = -Gamma s/omega^2 (t - sin(omega t)/omega). Away from the stop.
  SwitchedMotion motion(oneMass(1e6, 100.0), false);
  const double interval = 0.37;
  motion.setInterval(interval);
  Recorder recorder;
  const double slope = 3.0;
  for (int i = 0; i < 40; ++i)
  {
    motion.advanceLinear(slope * interval * i, slope * interval * (i + 1), recorder);
    const double t = interval * (i + 1);
    EXPECT_NEAR(motion.gap(), 100.0 - slope / 100.0 * (t - std::sin(10.0 * t) / 10.0), 1e-12);
    EXPECT_NEAR(motion.gapRate(), -slope / 100.0 * (1.0 - std::cos(10.0 * t)), 1e-12);
  }
}

TEST(SwitchedMotion, harmonicResponseIsExactWithoutContact)
{
  // Steady amplitude of the gap of a damped mass: A/|omega_0^2 - Omega^2 + 2 i zeta omega_0 Omega|.
  SwitchedMotion motion(oneMass(1e6, 1.0, {0.05, 0.0}), true);
  motion.setHarmonicDrive(8.0, 2.0);
  Recorder recorder;
  for (int i = 0; i < 200; ++i)
  {
    motion.advanceHarmonic(recorder);
  }
  // a = -A cos(Omega t); at whole cycles the gap is clearance + Re(-A H), H = -1/(...)
  const std::complex<double> dynamic(100.0 - 64.0, 2.0 * 0.05 * 10.0 * 8.0);
  EXPECT_NEAR(motion.gap(), 1.0 + (2.0 / dynamic).real(), 1e-12);
  EXPECT_TRUE(recorder.impacts.empty());
}

TEST(SwitchedMotion, harmonicAndFinelySampledDriveAgree)
{
  const auto model = makeModel(limitingCase(1000.0, AttachmentBasis{3}));
  const double omega = 1.6 * model->scales().frequency;
  SwitchedMotion harmonic(model, true);
  harmonic.setHarmonicDrive(omega, 10.0);
  Recorder expected;
  const int cycles = 12;
  for (int i = 0; i < cycles; ++i)
  {
    harmonic.advanceHarmonic(expected);
  }
  // linear interpolation errs by (Omega h)^2/8: 1/4000 of a cycle gives 3e-7
  const int per_cycle = 4000;
  const double period = 2.0 * pi / omega / per_cycle;
  std::vector<double> samples(static_cast<std::size_t>(cycles * per_cycle) + 1);
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    samples[i] = -10.0 * std::cos(2.0 * pi * static_cast<double>(i) / per_cycle);
  }
  const SampledRun run = simulate(model, samples, period);
  ASSERT_EQ(run.impacts.size(), expected.impacts.size());
  ASSERT_GT(run.impacts.size(), 5u);
  for (std::size_t i = 0; i < run.impacts.size(); ++i)
  {
    EXPECT_NEAR(run.impacts[i].impulse, expected.impacts[i].impulse, 1e-5 * expected.impacts[i].impulse + 1e-14);
    EXPECT_NEAR(run.impacts[i].energy_lost, expected.impacts[i].energy_lost,
                1e-4 * std::abs(expected.impacts[i].energy_lost) + 1e-16);
    EXPECT_NEAR(run.impacts[i].peak_force, expected.impacts[i].peak_force,
                1e-5 * expected.impacts[i].peak_force + 1e-12);
  }
}

// Energy -------------------------------------------------------------------------------------------------------------

TEST(SwitchedMotion, energyIsConstantOverAThousandImpactsInTheAttachmentBasis)
{
  for (const double relative_stiffness : {10.0, 1000.0, 73223.0})
  {
    SystemParameters parameters = limitingCase(relative_stiffness, AttachmentBasis{3});
    parameters.damping = {0.0, 0.0};
    SwitchedMotion motion(makeModel(parameters), false);
    motion.setInterval(1e-4);
    Eigen::VectorXd velocity = Eigen::VectorXd::Zero(motion.model().free().size());
    velocity(0) = -1e-3;
    velocity(1) = 4e-4;
    motion.setFreeCoordinates(Eigen::VectorXd::Zero(velocity.size()), velocity);
    const double energy = motion.energy();
    Recorder recorder;
    double worst = 0.0;
    while (recorder.impacts.size() < 1000)
    {
      motion.advanceLinear(0.0, 0.0, recorder);
      worst = std::max(worst, std::abs(motion.energy() - energy) / energy);
    }
    EXPECT_LT(worst, 1e-10) << "k* = " << relative_stiffness;
  }
}

TEST(SwitchedMotion, conjoinedBasisLosesWhatItsMappingSays)
{
  SystemParameters parameters = limitingCase(1000.0, ConjoinedBasis{2, 2});
  parameters.damping = {0.0, 0.0};
  SwitchedMotion motion(makeModel(parameters), false);
  motion.setInterval(1e-5);
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(2);
  velocity(0) = -1.0;
  motion.setFreeCoordinates(Eigen::VectorXd::Zero(2), velocity);
  Recorder recorder;
  while (recorder.impacts.empty())
  {
    motion.advanceLinear(0.0, 0.0, recorder);
  }
  // T^2 of the kinetic energy is left at the onset and T^2 of that at the release: both at zero gap
  const double kept = 1.0 - motion.model().mappingLoss()(0);
  EXPECT_NEAR(recorder.impacts[0].energy_lost, 0.5 * (1.0 - kept * kept), 1e-9);
}

// Switches -----------------------------------------------------------------------------------------------------------

TEST(SwitchedMotion, grazingIsNoSwitch)
{
  // Released at rest at the distance A above equilibrium, the mass comes to -A with zero velocity: exactly to the stop.
  const double amplitude = 0.01;
  for (const double interval : {1e-4, pi / 10.0, pi / 20.0, 0.9})
  {
    SwitchedMotion motion(oneMass(1e6, amplitude), false);
    motion.setInterval(interval);
    setMass(motion, amplitude, 0.0);
    Recorder recorder;
    runWithoutDrive(motion, static_cast<int>(30.0 / interval), recorder);
    EXPECT_EQ(motion.switches(), 0u) << "interval " << interval;
    EXPECT_LT(motion.steps(), 100000u) << "interval " << interval;
  }
}

TEST(SwitchedMotion, justDeeperThanGrazingIsAnImpactAndJustLessIsNone)
{
  const double amplitude = 0.01;
  const double depth = 1e-12 * amplitude;
  SwitchedMotion deeper(oneMass(1e6, amplitude - depth), false);
  SwitchedMotion less(oneMass(1e6, amplitude + depth), false);
  Recorder impacts;
  Recorder none;
  for (SwitchedMotion* motion : {&deeper, &less})
  {
    motion->setInterval(0.05);
    setMass(*motion, amplitude, 0.0);
    runWithoutDrive(*motion, 10, motion == &deeper ? impacts : none);
  }
  EXPECT_EQ(impacts.impacts.size(), 1u);
  EXPECT_TRUE(none.impacts.empty());
}

TEST(SwitchedMotion, crossingsBetweenTwoSamplesAreAllFound)
{
  // Eleven free periods of the undamped mass in each sample interval.
  const double period = pi / 10.0 + pi / std::sqrt(1.01e4);
  const double interval = 11.3 * period;
  SwitchedMotion motion(oneMass(1e6, 0.0), false);
  motion.setInterval(interval);
  setMass(motion, 0.0, -1.0);
  Recorder recorder;
  runWithoutDrive(motion, 100, recorder);
  EXPECT_EQ(recorder.impacts.size(), 1130u);
  EXPECT_EQ(motion.switchLimitReached(), 0u);
}

TEST(SwitchedMotion, aBriefDipBetweenTwoSamplesIsFound)
{
  // Of the period of 0.63 s the mass spends 2 sqrt(2 depth/A)/omega = 2.8e-4 s below the stop.
  const double amplitude = 0.01;
  SwitchedMotion motion(oneMass(1e-3, amplitude * (1.0 - 1e-6)), false);
  motion.setInterval(0.4);
  setMass(motion, amplitude, 0.0);
  Recorder recorder;
  runWithoutDrive(motion, 100, recorder);
  EXPECT_EQ(recorder.impacts.size(), 64u);  // 40 s/0.628 s, the first after half a period
  EXPECT_NEAR(recorder.impacts[0].duration, 2.0 * std::acos(1.0 - 1e-6) / 10.0, 1e-9);
}

TEST(SwitchedMotion, onsetExactlyOnASample)
{
  const double interval = pi / 20.0 / 8.0;  // a quarter period holds eight intervals
  SwitchedMotion motion(oneMass(1e6, 0.0), false);
  motion.setInterval(interval);
  setMass(motion, 0.01, 0.0);
  Recorder recorder;
  runWithoutDrive(motion, 20, recorder);
  ASSERT_EQ(recorder.impacts.size(), 1u);
  EXPECT_NEAR(onsetTime(recorder.impacts[0], interval), pi / 20.0, 1e-12);
  EXPECT_NEAR(recorder.impacts[0].impulse, 0.1 * 198.0198, 1e-4);
}

TEST(SwitchedMotion, identicalBeamsNeverMoveAgainstEachOther)
{
  for (const BasisParameters& basis : {BasisParameters(ConjoinedBasis{6, 6}), BasisParameters(AttachmentBasis{4})})
  {
    SystemParameters parameters = limitingCase(1000.0, basis);
    parameters.beam2 = parameters.beam1;
    for (const double clearance : {0.0, 1e-4, -1e-6})
    {
      parameters.contact.clearance = clearance;
      const auto model = makeModel(parameters);
      const SampledRun run = simulate(model, noise(5000, 50.0), 2e-5);
      EXPECT_TRUE(run.impacts.empty());
      for (const double gap : run.gap)
      {
        ASSERT_EQ(gap, run.gap.front());
      }
      if (clearance >= 0.0)
      {
        EXPECT_EQ(run.gap.front(), clearance);
      }
    }
  }
}

TEST(SwitchedMotion, beamsThatMoveAlikeNeverMoveAgainstEachOther)
{
  SystemParameters parameters = limitingCase(1000.0, ConjoinedBasis{6, 6});
  beamOf(parameters.beam1).contact_location = 0.31 * beamOf(parameters.beam1).length;
  BeamParameters wider = beamOf(parameters.beam1);
  std::get<Rectangle>(wider.cross_section).width *= 3.0;
  BeamParameters denser = beamOf(parameters.beam1);
  denser.youngs_modulus *= 7.0;
  denser.density *= 7.0;
  BeamParameters mirrored = wider;
  mirrored.contact_location = mirrored.length - mirrored.contact_location;
  for (const BeamParameters& beam2 : {wider, denser, mirrored})
  {
    parameters.beam2 = beam2;
    for (const BasisParameters& basis : {BasisParameters(ConjoinedBasis{6, 6}), BasisParameters(AttachmentBasis{3}),
                                         BasisParameters(AttachmentBasis{20}), BasisParameters(AttachmentBasis{100})})
    {
      parameters.basis = basis;
      const auto model = makeModel(parameters);
      const SampledRun run = simulate(model, noise(500, 50.0), 2e-5);
      EXPECT_TRUE(run.impacts.empty());
      for (const double gap : run.gap)
      {
        ASSERT_EQ(gap, 0.0);
      }
    }
  }
}

TEST(SwitchedMotion, startFromRestAtZeroClearanceMakesNoNoise)
{
  // Gap, velocity and acceleration are zero at the start, and for two beams so are further derivatives.
  for (const int modes : {1, 3, 10})
  {
    const auto model = makeModel(limitingCase(1000.0, AttachmentBasis{modes}));
    for (const double sign : {1.0, -1.0})
    {
      const SampledRun run = simulate(model, sine(500, sign * 10.0, 1.6 * model->scales().frequency, 2e-5), 2e-5);
      ASSERT_FALSE(run.impacts.empty());
      EXPECT_LE(run.impacts.size(), 8u);  // 4.3 drive cycles
      for (const Impact& impact : run.impacts)
      {
        EXPECT_GE(impact.impulse, 0.0);
        EXPECT_GE(impact.peak_force, 0.0);
      }
    }
  }
}

TEST(SwitchedMotion, startFromRestNeedsNoEndlessSearch)
{
  // The terms of gap and acceleration cancel all but completely at first, and between beams much alike for ever.
  for (const double ratio : {1000.0, 10.0, 1.01, 1.0001})
  {
    SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{5});
    BeamParameters beam2 = beamOf(parameters.beam1);
    beam2.youngs_modulus *= ratio;
    beamOf(parameters.beam1).contact_location = beam2.contact_location = 0.31 * beam2.length;
    parameters.beam2 = beam2;
    SwitchedMotion motion(makeModel(parameters), false);
    motion.setInterval(2e-5);
    const std::vector<double> drive = sine(400, 50.0, 2500.0, 2e-5);
    Recorder recorder;
    for (std::size_t i = 1; i < drive.size(); ++i)
    {
      motion.advanceLinear(drive[i - 1], drive[i], recorder);
    }
    EXPECT_FALSE(recorder.impacts.empty());
    EXPECT_LT(motion.steps(), 50000u) << ratio;
    EXPECT_LT(motion.peakEvaluations(), 20000u) << ratio;
  }
}

TEST(SwitchedMotion, restStaysRest)
{
  const auto model = makeModel(limitingCase(1000.0, AttachmentBasis{5}));
  const SampledRun run = simulate(model, std::vector<double>(10000, 0.0), 2e-5);
  EXPECT_TRUE(run.impacts.empty());
  for (const double gap : run.gap)
  {
    ASSERT_EQ(gap, 0.0);
  }
}

TEST(SwitchedMotion, aStiffChatteringConjoinedBasisEnds)
{
  const auto model = makeModel(limitingCase(73223.0, ConjoinedBasis{6, 6}));
  std::vector<double> gap(50000);
  std::vector<double> force(50000);
  Recorder recorder;
  SampledSimulation simulation(model, 2e-5);
  const std::vector<double> drive = sine(50000, 10.0, 1.2 * model->scales().frequency, 2e-5);
  simulation.advance(drive.data(), drive.size(), gap.data(), force.data(), recorder);
  EXPECT_GT(recorder.impacts.size(), 100u);
  for (const double value : gap)
  {
    ASSERT_TRUE(std::isfinite(value));
  }
}

TEST(SwitchedMotion, aTruncatedBasisSwitchesAtTheSameTimesHoweverTheDriveIsSampled)
{
  // A jump of the gap leaves it on the wrong side, where the next switch is due as soon as it turns round.
  SystemParameters parameters = limitingCase(1000.0, ConjoinedBasis{2, 2});
  parameters.contact.clearance = 3.0e-7;
  const auto model = makeModel(parameters);
  const double coarse = 1.0e-4;
  const double fine = coarse / 7.7;
  const SampledRun expected = simulate(model, std::vector<double>(201, 1.0), coarse);
  const SampledRun found = simulate(model, std::vector<double>(1541, 1.0), fine);
  ASSERT_EQ(found.impacts.size(), expected.impacts.size());
  ASSERT_GT(found.impacts.size(), 10u);
  for (std::size_t i = 0; i < found.impacts.size(); ++i)
  {
    EXPECT_NEAR(onsetTime(found.impacts[i], fine), onsetTime(expected.impacts[i], coarse), 1e-10) << "impact " << i;
    EXPECT_NEAR(found.impacts[i].duration, expected.impacts[i].duration, 1e-10) << "impact " << i;
    EXPECT_NEAR(found.impacts[i].impulse, expected.impacts[i].impulse, 1e-12) << "impact " << i;
  }
}

TEST(SwitchedMotion, switchesOfAnIntervalHaveABound)
{
  // A very light drop onto a stop with strong contact damping: ever smaller jumps cannot go on for ever inside one
  // interval.
  const auto model = oneMass(1e8, 0.0, {0.0, 0.9});
  SwitchedMotion motion(model, false);
  motion.setInterval(50.0);
  setMass(motion, 0.0, -1.0);
  Recorder recorder;
  for (int i = 0; i < 20; ++i)
  {
    motion.advanceLinear(-1.0, -1.0, recorder);
  }
  EXPECT_TRUE(std::isfinite(motion.gap()));
}

// Clearance ----------------------------------------------------------------------------------------------------------

TEST(SwitchedMotion, interferenceFitRestsInStaticEquilibrium)
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{4});
  parameters.contact.clearance = -2e-5;
  const auto model = makeModel(parameters);
  const SampledRun run = simulate(model, std::vector<double>(100, 0.0), 2e-5);
  // the spring and both beams in series: g = clearance/(1 + k (alpha_1 + alpha_2))
  const double receptance = Beam(std::get<BeamParameters>(parameters.beam1)).staticReceptance(0) +
                            Beam(std::get<BeamParameters>(parameters.beam2)).staticReceptance(0);
  const double expected = -2e-5 / (1.0 + parameters.contact.stiffness * receptance);
  for (std::size_t i = 0; i < run.gap.size(); ++i)
  {
    EXPECT_NEAR(run.gap[i], expected, 1e-13 * 2e-5);
    EXPECT_NEAR(run.force[i], -parameters.contact.stiffness * expected, 1e-9);
  }
  EXPECT_TRUE(run.impacts.empty());
}

TEST(SwitchedMotion, contactThatNeverOpensIsLinear)
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{4});
  parameters.contact.clearance = -2e-5;
  const auto model = makeModel(parameters);
  const double omega = 0.7 * model->scales().frequency;
  const SampledRun once = simulate(model, sine(20000, 1.0, omega, 2e-5), 2e-5);
  const SampledRun twice = simulate(model, sine(20000, 2.0, omega, 2e-5), 2e-5);
  EXPECT_TRUE(once.impacts.empty());
  const double rest = once.gap.front();
  double amplitude = 0.0;
  for (std::size_t i = 0; i < once.gap.size(); ++i)
  {
    EXPECT_NEAR(twice.gap[i] - rest, 2.0 * (once.gap[i] - rest), 1e-13 * std::abs(rest));
    EXPECT_GT(once.force[i], 0.0);
    amplitude = std::max(amplitude, std::abs(once.gap[i] - rest));
  }
  EXPECT_GT(amplitude, 1e-3 * std::abs(rest));
}

TEST(SwitchedMotion, interferenceFitOpensUnderAStrongDrive)
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{4});
  parameters.contact.clearance = -1e-7;
  const auto model = makeModel(parameters);
  const SampledRun run = simulate(model, sine(20000, 20.0, 1.6 * model->scales().frequency, 2e-5), 2e-5);
  ASSERT_GT(run.impacts.size(), 50u);
  EXPECT_TRUE(run.impacts.front().cut_short) << "the first episode has no onset";
  EXPECT_EQ(run.impacts.front().approach_speed, 0.0);
  EXPECT_FALSE(run.impacts[1].cut_short);
  double integral = 0.0;
  for (const double force : run.force)
  {
    EXPECT_GE(force, 0.0);
    integral += 2e-5 * force;
  }
  double sum = 0.0;
  for (const Impact& impact : run.impacts)
  {
    sum += impact.impulse;
  }
  EXPECT_NEAR(integral, sum, 2e-3 * sum);
}

TEST(SwitchedMotion, contactNeverReachedHasNoImpacts)
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{4});
  parameters.contact.clearance = 1e-3;
  const SampledRun run = simulate(makeModel(parameters), sine(20000, 1.0, 1700.0, 2e-5), 2e-5);
  EXPECT_TRUE(run.impacts.empty());
  for (const double force : run.force)
  {
    ASSERT_EQ(force, 0.0);
  }
}

TEST(SwitchedMotion, atZeroClearanceTheResponseIsProportionalToTheDrive)
{
  const auto model = makeModel(limitingCase(1000.0, AttachmentBasis{4}));
  const SampledRun once = simulate(model, sine(5000, 5.0, 1.2 * model->scales().frequency, 2e-5), 2e-5);
  const SampledRun twice = simulate(model, sine(5000, 10.0, 1.2 * model->scales().frequency, 2e-5), 2e-5);
  ASSERT_EQ(once.impacts.size(), twice.impacts.size());
  ASSERT_GT(once.impacts.size(), 20u);
  for (std::size_t i = 0; i < once.impacts.size(); ++i)
  {
    EXPECT_NEAR(twice.impacts[i].impulse, 2.0 * once.impacts[i].impulse, 1e-9 * twice.impacts[i].impulse);
    EXPECT_NEAR(twice.impacts[i].duration, once.impacts[i].duration, 1e-9 * once.impacts[i].duration + 1e-13);
  }
  for (std::size_t i = 0; i < once.gap.size(); ++i)
  {
    ASSERT_NEAR(twice.gap[i], 2.0 * once.gap[i], 1e-15);
  }
}

// The stream ---------------------------------------------------------------------------------------------------------

TEST(SampledSimulation, isTheSameBitForBitHoweverTheSamplesAreCut)
{
  const auto model = makeModel(limitingCase(73223.0, AttachmentBasis{5}));
  std::vector<double> drive = sine(20000, 10.0, 1.6 * model->scales().frequency, 2e-5);
  const std::vector<double> disturbance = noise(drive.size(), 1.0);
  for (std::size_t i = 0; i < drive.size(); ++i)
  {
    drive[i] += disturbance[i];
  }
  const SampledRun whole = simulate(model, drive, 2e-5);
  SampledRun cut;
  cut.gap.resize(drive.size());
  cut.force.resize(drive.size());
  Recorder recorder;
  SampledSimulation simulation(model, 2e-5);
  for (std::size_t i = 0, block = 1; i < drive.size(); i += block, block = block * 5 % 257 + 1)
  {
    block = std::min(block, drive.size() - i);
    simulation.advance(drive.data() + i, block, cut.gap.data() + i, cut.force.data() + i, recorder);
  }
  EXPECT_EQ(cut.gap, whole.gap);
  EXPECT_EQ(cut.force, whole.force);
  ASSERT_EQ(recorder.impacts.size(), whole.impacts.size());
  ASSERT_GT(whole.impacts.size(), 200u);
  for (std::size_t i = 0; i < whole.impacts.size(); ++i)
  {
    EXPECT_EQ(recorder.impacts[i].interval, whole.impacts[i].interval);
    EXPECT_EQ(recorder.impacts[i].offset, whole.impacts[i].offset);
    EXPECT_EQ(recorder.impacts[i].impulse, whole.impacts[i].impulse);
    EXPECT_EQ(recorder.impacts[i].energy_lost, whole.impacts[i].energy_lost);
  }
}

TEST(SampledSimulation, resetReportsTheOpenEpisodeAndStartsAnew)
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{3});
  const auto model = makeModel(parameters);
  const std::vector<double> drive = sine(3000, 10.0, 1.6 * model->scales().frequency, 2e-5);
  std::vector<double> gap(drive.size());
  std::vector<double> force(drive.size());
  Recorder recorder;
  SampledSimulation simulation(model, 2e-5);
  std::size_t taken = 0;
  while (taken < 1000 || !simulation.inContact())
  {
    simulation.advance(&drive[taken], 1, &gap[taken], &force[taken], recorder);
    ++taken;
  }
  const std::size_t before = recorder.impacts.size();
  simulation.reset(recorder);
  ASSERT_EQ(recorder.impacts.size(), before + 1);
  EXPECT_TRUE(recorder.impacts.back().cut_short);
  EXPECT_GT(recorder.impacts.back().duration, 0.0);
  EXPECT_FALSE(simulation.inContact());
  EXPECT_EQ(simulation.samples(), 0u);

  Recorder again;
  std::vector<double> second_gap(drive.size());
  simulation.advance(drive.data(), taken, second_gap.data(), force.data(), again);
  for (std::size_t i = 0; i < taken; ++i)
  {
    ASSERT_EQ(second_gap[i], gap[i]);
  }
  EXPECT_EQ(again.impacts.size(), before);
}

TEST(SampledSimulation, refusesAPeriodThatIsNotPositive)
{
  const auto model = makeModel(limitingCase(1000.0, AttachmentBasis{3}));
  for (const double period :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
  {
    EXPECT_THROW(SampledSimulation(model, period), std::invalid_argument);
  }
}

TEST(HarmonicSimulation, refusesADriveOutOfRange)
{
  HarmonicSimulation simulation(makeModel(limitingCase(1000.0, AttachmentBasis{3})));
  EXPECT_THROW(simulation.setDrive(0.0, 1.0), std::invalid_argument);
  EXPECT_THROW(simulation.setDrive(-3.0, 1.0), std::invalid_argument);
  EXPECT_THROW(simulation.setDrive(1.0, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  HarmonicSimulation undamped(oneMass(1e6, 0.0));
  EXPECT_THROW(undamped.setDrive(10.0, 1.0), std::invalid_argument);
  EXPECT_NO_THROW(undamped.setDrive(10.1, 1.0));
}

TEST(HarmonicSimulation, keepsItsStateFromOneFrequencyToTheNext)
{
  // Two halves of the same drive are one drive.
  const auto model = makeModel(limitingCase(1000.0, AttachmentBasis{3}));
  const double omega = 1.2 * model->scales().frequency;
  HarmonicSimulation once(model);
  HarmonicSimulation halves(model);
  once.setDrive(omega, 10.0);
  halves.setDrive(omega, 10.0);
  Recorder expected;
  Recorder found;
  once.advance(40, expected);
  halves.advance(20, found);
  halves.setDrive(omega, 10.0);
  halves.advance(20, found);
  ASSERT_EQ(found.impacts.size(), expected.impacts.size());
  for (std::size_t i = 0; i < found.impacts.size(); ++i)
  {
    EXPECT_NEAR(found.impacts[i].impulse, expected.impacts[i].impulse, 1e-9 * expected.impacts[i].impulse);
    EXPECT_NEAR(found.impacts[i].energy_lost, expected.impacts[i].energy_lost,
                1e-8 * expected.impacts[i].energy_lost + 1e-18);
  }
}
