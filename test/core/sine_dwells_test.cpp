#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common.h"
#include "signal_samples.h"
#include "vibro_impact/core/drive_signal.h"
#include "vibro_impact/core/drive_steps.h"

namespace
{
using namespace vibro_impact::core;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inch = 0.0254;

SineBand band(double from, double to, MotionQuantity quantity, double value)
{
  return {from, to, {quantity, value}};
}

/// The variable frequency test of MIL-STD-167-1A, shortened.
SineDwellParameters variableFrequency()
{
  SineDwellParameters parameters;
  parameters.bands = {band(4.0, 15.0, MotionQuantity::displacement, 0.030 * inch),
                      band(16.0, 25.0, MotionQuantity::displacement, 0.020 * inch),
                      band(26.0, 33.0, MotionQuantity::displacement, 0.010 * inch)};
  parameters.dwell = 2.0;
  return parameters;
}

TEST(MotionAmplitude, becomesThatOfTheAcceleration)
{
  // 1 mm at 13.2 Hz are 6.88 m/s^2: by hand, (2 pi 13.2)^2 = 6878.6.
  EXPECT_NEAR(accelerationAmplitude({MotionQuantity::displacement, 1.0e-3}, 13.2), 6.8787, 1.0e-4);
  EXPECT_NEAR(accelerationAmplitude({MotionQuantity::velocity, 0.1}, 10.0), 2.0 * pi, 1.0e-12);
  EXPECT_EQ(accelerationAmplitude({MotionQuantity::acceleration, 7.0}, 10.0), 7.0);
}

TEST(SineDwells, goThroughTheirBandsInWholeCycles)
{
  const std::vector<SineDwell> dwells = sineDwells(variableFrequency());
  ASSERT_EQ(dwells.size(), 30u);
  for (std::size_t i = 0; i < dwells.size(); ++i)
  {
    const double frequency = 4.0 + static_cast<double>(i);
    const double amplitude = frequency < 15.5 ? 7.62e-4 : frequency < 25.5 ? 5.08e-4 : 2.54e-4;
    EXPECT_EQ(dwells[i].frequency, frequency);
    EXPECT_NEAR(dwells[i].acceleration, std::pow(2.0 * pi * frequency, 2) * amplitude, 1.0e-12);
    EXPECT_EQ(dwells[i].cycles, 2.0 * frequency);
  }
}

TEST(SineDwells, goDownwardsAndRoundUpToWholeCycles)
{
  SineDwellParameters parameters;
  parameters.bands = {band(10.0, 9.0, MotionQuantity::acceleration, 1.0)};
  parameters.frequency_step = 0.4;
  parameters.dwell = 0.25;
  const std::vector<SineDwell> dwells = sineDwells(parameters);
  ASSERT_EQ(dwells.size(), 3u);
  EXPECT_DOUBLE_EQ(dwells[1].frequency, 9.6);
  EXPECT_DOUBLE_EQ(dwells[2].frequency, 9.2);
  EXPECT_EQ(dwells[0].cycles, 3.0);  // of 2.5
  EXPECT_EQ(dwells[2].cycles, 3.0);  // of 2.3
}

TEST(SineDwells, areSinesOfTheirAmplitudeFromPhaseZero)
{
  const auto signal = makeDriveSignal(variableFrequency(), 2000.0);
  ASSERT_EQ(signal->samples(), 120000u);
  EXPECT_EQ(generate(*signal, 0, 1)[0], 0.0);
  for (const std::uint64_t sample : {1u, 4000u, 47999u, 48000u, 48100u, 90000u, 119999u})
  {
    const double time = static_cast<double>(sample) / 2000.0;
    const double frequency = 4.0 + std::floor(time / 2.0);
    const double amplitude = frequency < 15.5 ? 7.62e-4 : frequency < 25.5 ? 5.08e-4 : 2.54e-4;
    const double omega = 2.0 * pi * frequency;
    EXPECT_NEAR(generate(*signal, sample, 1)[0], omega * omega * amplitude * std::sin(omega * std::fmod(time, 2.0)),
                1.0e-9)
        << sample;
    EXPECT_EQ(signal->frequency(sample), frequency);
  }
  expectTheSameInAnyBlocks(*signal);
}

TEST(SineDwells, rampFromTheAmplitudeOfTheOneBefore)
{
  SineDwellParameters parameters;
  parameters.bands = {band(10.0, 10.0, MotionQuantity::acceleration, 2.0),
                      band(20.0, 20.0, MotionQuantity::acceleration, 6.0)};
  parameters.dwell = 1.0;
  parameters.ramp_cycles = 4.0;
  const auto signal = makeDriveSignal(parameters, 2000.0);
  // Peaks a quarter of a cycle after the middle of each ramp: 2.25 of 4 cycles.
  const double share = 0.5 - 0.5 * std::cos(pi * 2.25 / 4.0);
  EXPECT_NEAR(generate(*signal, 450, 1)[0], 2.0 * share, 1.0e-12);
  EXPECT_NEAR(generate(*signal, 1050, 1)[0], 2.0, 1.0e-12);
  EXPECT_NEAR(generate(*signal, 2000 + 225, 1)[0], 2.0 + 4.0 * share, 1.0e-12);
  EXPECT_NEAR(generate(*signal, 2000 + 525, 1)[0], 6.0, 1.0e-12);

  // No step of the acceleration where the amplitudes change: none is larger than the steepest sine allows.
  const std::vector<double> samples = generate(*signal);
  for (std::size_t i = 1; i < samples.size(); ++i)
  {
    ASSERT_LE(std::abs(samples[i] - samples[i - 1]), 1.001 * 6.0 * 2.0 * pi * 20.0 / 2000.0) << i;
  }
}

TEST(SineDwells, areFoundAsStepsOfTheirOwnAmplitudes)
{
  SineDwellParameters parameters = variableFrequency();
  parameters.dwell = 15.0;
  parameters.ramp_cycles = 4.0;
  const std::vector<double> samples = generate(*makeDriveSignal(parameters, 2000.0));
  const std::vector<MeasuredStep> steps = findDriveSteps(samples.data(), samples.size(), 1.0 / 2000.0);
  const std::vector<SineDwell> dwells = sineDwells(parameters);
  ASSERT_EQ(steps.size(), dwells.size());
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    const DriveStep step = driveStep(steps[i], 1.0 / 2000.0);
    EXPECT_NEAR(step.frequency / (2.0 * pi), dwells[i].frequency, 1.0e-4);
    EXPECT_NEAR(step.acceleration / dwells[i].acceleration, 1.0, 1.0e-2);
    EXPECT_GE(static_cast<double>(steps[i].last - steps[i].first) / 2000.0 * dwells[i].frequency,
              dwells[i].cycles - 6.0);
  }
}

TEST(SineDwells, rejectWhatIsOutOfRange)
{
  const auto faultsOf = [](const SineDwellParameters& parameters) { return keysOf(findFaults(parameters, 2000.0)); };
  EXPECT_EQ(faultsOf(variableFrequency()), "");

  SineDwellParameters parameters = variableFrequency();
  parameters.bands.clear();
  EXPECT_EQ(faultsOf(parameters), "bands");

  parameters = variableFrequency();
  parameters.bands[1].from = 0.0;
  parameters.bands[1].to = 1000.0;  // half the sample rate
  parameters.bands[2].amplitude.value = -1.0;
  EXPECT_EQ(faultsOf(parameters), "bands[1].from bands[1].to bands[2].displacement");
  parameters.bands[1] = band(nan, 20.0, MotionQuantity::velocity, nan);
  parameters.bands[2] = band(20.0, 21.0, MotionQuantity::acceleration, std::numeric_limits<double>::infinity());
  EXPECT_EQ(faultsOf(parameters), "bands[1].from bands[1].velocity bands[2].acceleration");

  parameters = variableFrequency();
  parameters.frequency_step = 0.0;
  parameters.dwell = -1.0;
  parameters.ramp_cycles = nan;
  EXPECT_EQ(faultsOf(parameters), "frequency_step dwell ramp_cycles");
  parameters = variableFrequency();
  parameters.frequency_step = 1.0e-7;  // too many dwells
  EXPECT_EQ(faultsOf(parameters), "frequency_step");
  parameters = variableFrequency();
  parameters.ramp_cycles = 8.5;  // 8 cycles at 4 Hz
  EXPECT_EQ(faultsOf(parameters), "ramp_cycles");
  parameters = variableFrequency();
  parameters.dwell = 1.0e15;
  EXPECT_EQ(faultsOf(parameters), "duration");
  EXPECT_THROW(makeDriveSignal(parameters, 2000.0), std::invalid_argument);
}

}  // namespace
