#include "vibro_impact/core/drive_steps.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "played_signal.h"

namespace vibro_impact::core
{
namespace
{
struct Expected
{
  double frequency_hz;
  double amplitude;
  double first;  // in samples, not rounded
  double last;
};

// A stepped sine with noise, distortion and offset, and what is to be found in it.
struct Staircase
{
  explicit Staircase(double sample_rate) : signal(sample_rate)
  {
  }

  void step(double frequency_hz, double amplitude, double cycles, double soft_start = 0.0)
  {
    const double first = signal.position();
    signal.step(frequency_hz, amplitude, cycles, soft_start);
    expected.push_back(
        {frequency_hz, amplitude, first + soft_start / frequency_hz / signal.samplePeriod(), signal.position()});
  }

  std::vector<MeasuredStep> find(const StepSearchOptions& options = {})
  {
    return findDriveSteps(signal.samples().data(), signal.samples().size(), signal.samplePeriod(), options);
  }

  // Frequency and amplitude to so many parts of one, boundaries to so many cycles.
  void expect(const std::vector<MeasuredStep>& found, double frequency, double amplitude, double boundary) const
  {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
    {
      SCOPED_TRACE("step " + std::to_string(i) + " at " + std::to_string(expected[i].frequency_hz) + " Hz");
      const double cycle = 1.0 / (expected[i].frequency_hz * signal.samplePeriod());
      EXPECT_NEAR(found[i].fit.frequency / two_pi / expected[i].frequency_hz, 1.0, frequency);
      EXPECT_NEAR(found[i].fit.amplitude / expected[i].amplitude, 1.0, amplitude);
      EXPECT_NEAR(static_cast<double>(found[i].first), expected[i].first, boundary * cycle);
      EXPECT_NEAR(static_cast<double>(found[i].last), expected[i].last, boundary * cycle);
    }
  }

  PlayedSignal signal;
  std::vector<Expected> expected;
};

// Steps of a sweep: relative step size, cycles per step, noise and distortion relative to the amplitude.
class Sweep : public testing::TestWithParam<std::tuple<double, double, double, double>>
{
};

TEST_P(Sweep, isCutIntoItsSteps)
{
  const auto [size, cycles, noise, distortion] = GetParam();
  Staircase staircase(50000.0);
  staircase.signal.distort(distortion);
  for (double frequency = 137.3; frequency <= 1100.0 && staircase.expected.size() < 60; frequency *= 1.0 + size)
  {
    staircase.step(frequency, 3.0, cycles);
  }
  staircase.signal.addNoise(noise * 3.0, 5).addOffset(0.4);
  // Cramer and Rao again, for the shortest step; of a few cycles, one step of the fit leaves a little more.
  const double shortest = (cycles - 1.0) * 50000.0 / 1100.0;
  const double bound = std::sqrt(24.0 / shortest) * noise / (two_pi * (cycles - 1.0));
  staircase.expect(staircase.find(), (cycles < 10.0 ? 5.0e-6 : 1.0e-6) + 5.0 * bound,
                   1.0e-4 + 5.0 * noise * std::sqrt(2.0 / shortest), 2.5);
}

INSTANTIATE_TEST_SUITE_P(NoiseFree, Sweep,
                         testing::Combine(testing::Values(0.003, 0.02, 0.2), testing::Values(6.0, 8.3, 25.0, 150.0),
                                          testing::Values(0.0), testing::Values(0.0, 0.05)));
INSTANTIATE_TEST_SUITE_P(Measured, Sweep,
                         testing::Combine(testing::Values(0.02, 0.2), testing::Values(8.3, 25.0, 150.0),
                                          testing::Values(0.01, 0.05), testing::Values(0.05)));
INSTANTIATE_TEST_SUITE_P(MeasuredTinySteps, Sweep,
                         testing::Combine(testing::Values(0.003), testing::Values(20.0, 150.0),
                                          testing::Values(0.01, 0.05), testing::Values(0.05)));

TEST(DriveSteps, frequencyIsExactToOneInAMillionWithNoise)
{
  Staircase staircase(50000.0);
  for (int i = 0; i < 10; ++i)
  {
    staircase.step(400.0 * (1.0 + 0.003 * i), 5.0, 400.0);
  }
  staircase.signal.addNoise(0.05, 3);
  staircase.expect(staircase.find(), 1.0e-6, 1.0e-3, 1.5);
}

TEST(DriveSteps, boundariesOfACleanSweepAreExactToASample)
{
  Staircase staircase(50000.0);
  staircase.step(300.0, 3.0, 50.5);
  staircase.step(303.0, 3.0, 50.27);
  staircase.step(310.0, 3.0, 50.9);
  const auto found = staircase.find();
  ASSERT_EQ(found.size(), 3u);
  for (std::size_t i = 0; i + 1 < found.size(); ++i)
  {
    EXPECT_NEAR(static_cast<double>(found[i].last), staircase.expected[i].last, 1.5);
    EXPECT_NEAR(static_cast<double>(found[i + 1].first), staircase.expected[i + 1].first, 1.5);
  }
}

TEST(DriveSteps, drivesNearATenthOfTheSampleRate)
{
  for (const double noise : {0.0, 0.01, 0.05})
  {
    SCOPED_TRACE(noise);
    Staircase staircase(10007.0);  // a slow beat between samples and cycles
    staircase.signal.distort(0.05);
    staircase.step(1000.0, 3.0, 2000.0);
    staircase.step(1003.0, 3.0, 2000.0);
    staircase.step(999.8, 3.0, 2000.0);
    staircase.signal.addNoise(noise * 3.0, 8);
    staircase.expect(staircase.find(), 1.0e-6 + 1.0e-5 * noise, 1.0e-3 + 0.05 * noise, 10.0);
  }
}

TEST(DriveSteps, slowDrivesBetweenRestsWithSoftStarts)
{
  for (const double noise : {0.0, 0.01, 0.05})
  {
    SCOPED_TRACE(noise);
    Staircase staircase(50000.0);
    staircase.signal.rest(3.0);
    for (const double frequency : {3.0, 3.1, 3.2})
    {
      staircase.step(frequency, 2.0, 20.0, 5.0);
      staircase.signal.rest(3.0);
    }
    staircase.signal.addNoise(noise * 2.0, 9).addOffset(0.3);
    staircase.expect(staircase.find(), 1.0e-4, 1.0e-3, 3.5);
  }
}

TEST(DriveSteps, restsAndSoftStartsAreNoSteps)
{
  for (const double noise : {0.0, 0.01, 0.05})
  {
    SCOPED_TRACE(noise);
    Staircase staircase(50000.0);
    staircase.signal.rest(0.3);
    for (const double frequency : {100.0, 110.0, 121.0})
    {
      staircase.step(frequency, 3.0, 60.0, 20.0);
      staircase.signal.rest(0.2);
    }
    staircase.signal.addNoise(noise * 3.0, 3);
    staircase.expect(staircase.find(), 2.0e-5, 5.0e-3, 3.0);
  }
}

TEST(DriveSteps, levelsOfOneFrequencyAreSteps)
{
  Staircase staircase(50000.0);
  for (const double level : {1.0, 2.0, 3.0, 2.0, 1.0, 0.85, 0.6})
  {
    staircase.step(300.0, level, level == 2.0 ? 40.0 : 200.0);
  }
  staircase.signal.addNoise(0.01, 3);
  staircase.expect(staircase.find(), 1.0e-5, 3.0e-3, 2.5);
}

TEST(DriveSteps, amplitudeNeedNotBeQuiteConstant)
{
  Staircase staircase(50000.0);
  for (int i = 0; i < 40; ++i)
  {
    staircase.step(300.0 * std::pow(1.01, i), 3.0, 30.0);
  }
  for (std::size_t i = 0; i < staircase.signal.samples().size(); ++i)
  {
    staircase.signal.samples()[i] *= 1.0 + 0.04 * std::sin(0.0013 * static_cast<double>(i));
  }
  staircase.signal.addNoise(0.03, 4);
  staircase.expect(staircase.find(), 1.0e-4, 0.05, 3.5);
}

TEST(DriveSteps, stepsNeedNotBeCoherentInPhase)
{
  Staircase staircase(50000.0);
  staircase.step(300.0, 3.0, 50.0);
  staircase.signal.jumpInPhase(2.0);
  staircase.step(310.0, 3.0, 50.0);
  staircase.signal.jumpInPhase(3.0);
  staircase.step(305.0, 3.0, 50.0);
  staircase.signal.addNoise(0.03, 4);
  staircase.expect(staircase.find(), 1.0e-5, 1.0e-3, 5.0);
}

TEST(DriveSteps, spikesDoNotEndAStep)
{
  Staircase staircase(50000.0);
  staircase.step(300.0, 3.0, 200.0);
  staircase.step(303.0, 3.0, 200.0);
  staircase.signal.addNoise(0.15, 4);
  staircase.signal.samples()[11000] += 20.0;
  staircase.signal.samples()[52000] -= 20.0;
  staircase.expect(staircase.find(), 1.0e-5, 5.0e-3, 2.5);
}

TEST(DriveSteps, aSweptSineHasNone)
{
  for (const double noise : {0.0, 0.01, 0.05})
  {
    for (const double seconds : {1.0, 10.0, 60.0})
    {
      for (const bool logarithmic : {false, true})
      {
        PlayedSignal signal(20000.0);
        signal.sweep(100.0, 800.0, 3.0, seconds, logarithmic).addNoise(noise * 3.0, 6);
        const auto found = findDriveSteps(signal.samples().data(), signal.samples().size(), signal.samplePeriod());
        EXPECT_TRUE(found.empty()) << found.size() << " steps, noise " << noise << ", " << seconds << " s, "
                                   << (logarithmic ? "logarithmic" : "linear");
      }
    }
  }
}

TEST(DriveSteps, dwellsBeforeAndAfterASweepAreSteps)
{
  Staircase staircase(50000.0);
  staircase.step(300.0, 3.0, 200.0);
  staircase.step(303.0, 3.0, 200.0);
  staircase.signal.sweep(303.0, 900.0, 3.0, 5.0, true);
  staircase.step(900.0, 3.0, 100.0);
  staircase.step(910.0, 3.0, 100.0);
  staircase.signal.addNoise(0.03, 6);
  staircase.expect(staircase.find(), 1.0e-5, 1.0e-3, 6.0);
}

TEST(DriveSteps, noiseSilenceAndAConstantHaveNone)
{
  PlayedSignal noise(50000.0);
  noise.rest(5.0).addNoise(1.0, 2);
  EXPECT_TRUE(findDriveSteps(noise.samples().data(), noise.samples().size(), noise.samplePeriod()).empty());
  const std::vector<double> silence(100000, 0.0);
  EXPECT_TRUE(findDriveSteps(silence.data(), silence.size(), 2e-5).empty());
  const std::vector<double> constant(100000, 9.81);
  EXPECT_TRUE(findDriveSteps(constant.data(), constant.size(), 2e-5).empty());
  EXPECT_TRUE(findDriveSteps(nullptr, 0, 2e-5).empty());
}

TEST(DriveSteps, resultDoesNotDependOnTheBlocks)
{
  Staircase staircase(20000.0);
  staircase.step(300.0, 3.0, 40.0);
  staircase.step(310.0, 3.0, 40.0);
  staircase.signal.addNoise(0.1, 6);
  const auto& samples = staircase.signal.samples();
  const auto whole = staircase.find();

  DriveStepFinder finder(staircase.signal.samplePeriod());
  const std::uint64_t origin = 1000000;  // a recording may begin anywhere in the stream
  const auto inBlocks = [&](auto& consumer)
  {
    for (std::size_t i = 0; i < samples.size(); i += 37)
    {
      consumer.add(origin + i, samples.data() + i, std::min<std::size_t>(37, samples.size() - i));
    }
  };
  inBlocks(finder);
  DriveStepMeter meter(finder.finish(), staircase.signal.samplePeriod());
  inBlocks(meter);
  const auto found = meter.finish();
  ASSERT_EQ(found.size(), whole.size());
  for (std::size_t i = 0; i < found.size(); ++i)
  {
    EXPECT_EQ(found[i].first, origin + whole[i].first);
    EXPECT_EQ(found[i].last, origin + whole[i].last);
    EXPECT_NEAR(found[i].fit.frequency, whole[i].fit.frequency, 1.0e-8);
  }
}

TEST(DriveSteps, missingAndNonFiniteSamplesInterrupt)
{
  Staircase staircase(20000.0);
  staircase.step(300.0, 3.0, 100.0);
  auto& samples = staircase.signal.samples();
  samples[2000] = std::numeric_limits<double>::quiet_NaN();
  DriveStepFinder finder(staircase.signal.samplePeriod());
  finder.add(0, samples.data(), 4000);
  finder.add(4100, samples.data() + 4100, samples.size() - 4100);
  const auto found = finder.finish();
  ASSERT_EQ(found.size(), 3u);
  EXPECT_LE(found[0].last, 2000u);
  EXPECT_GT(found[1].first, 2000u);
  EXPECT_LE(found[1].last, 4000u);
  EXPECT_GE(found[2].first, 4100u);
}

TEST(DriveSteps, meterRefusesMissingSamples)
{
  Staircase staircase(20000.0);
  staircase.step(300.0, 3.0, 100.0);
  const auto& samples = staircase.signal.samples();
  DriveStepFinder finder(staircase.signal.samplePeriod());
  finder.add(0, samples.data(), samples.size());
  DriveStepMeter meter(finder.finish(), staircase.signal.samplePeriod());
  meter.add(0, samples.data(), 2000);
  EXPECT_THROW(meter.finish(), std::logic_error);
}

TEST(DriveSteps, refusesOptionsOutOfRange)
{
  EXPECT_THROW(DriveStepFinder(0.0), std::invalid_argument);
  EXPECT_THROW(DriveStepFinder{std::numeric_limits<double>::infinity()}, std::invalid_argument);
  StepSearchOptions options;
  options.shortest_step = 3;
  EXPECT_THROW(DriveStepFinder(1e-4, options), std::invalid_argument);
  options = {};
  options.amplitude_tolerance = 1.0;
  EXPECT_THROW(DriveStepFinder(1e-4, options), std::invalid_argument);
  options = {};
  options.lowest_frequency = 1000.0;
  EXPECT_THROW(DriveStepFinder(1e-4, options), std::invalid_argument);
  options = {};
  options.largest_residual = -1.0;
  EXPECT_THROW(DriveStepFinder(1e-4, options), std::invalid_argument);
}
}  // namespace
}  // namespace vibro_impact::core
