#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "common.h"
#include "signal_samples.h"
#include "vibro_impact/core/drive_signal.h"

namespace
{
using namespace vibro_impact::core;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double sample_rate = 10000.0;

ShockParameters shock(ShockShape shape)
{
  ShockParameters parameters;
  parameters.shape = shape;
  parameters.peak = 150.0;
  parameters.duration = 0.011;
  parameters.before = 0.1;
  parameters.after = 0.5;
  parameters.repetitions = 3;
  parameters.interval = 1.0;
  return parameters;
}

// The velocity that the samples leave, straight lines between them.
double velocity(const std::vector<double>& samples, std::size_t from, std::size_t to)
{
  double sum = 0.0;
  for (std::size_t i = from + 1; i <= to; ++i)
  {
    sum += 0.5 * (samples[i] + samples[i - 1]) / sample_rate;
  }
  return sum;
}

TEST(Shock, isAHalfSineAtItsTimes)
{
  const auto signal = makeDriveSignal(shock(ShockShape::half_sine), sample_rate);
  ASSERT_EQ(signal->samples(), 26110u);  // 0.1 + 2 + 0.011 + 0.5 s
  const std::vector<double> samples = generate(*signal);
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const double since = std::fmod(static_cast<double>(i) / sample_rate - 0.1 + 1.0, 1.0);
    const bool inside = i >= 1000 && i <= 21110 && since < 0.011;
    ASSERT_NEAR(samples[i], inside ? 150.0 * std::sin(pi * since / 0.011) : 0.0, 1.0e-8) << i;
  }
  EXPECT_NEAR(samples[1055], 150.0, 1.0e-9);
  EXPECT_TRUE(std::isnan(signal->frequency(1055)));
  EXPECT_EQ(signal->frequency(26110), 0.0);
  expectTheSameInAnyBlocks(*signal);
}

TEST(Shock, isASawtoothThatFallsFromItsPeak)
{
  const std::vector<double> samples =
      generate(*makeDriveSignal(shock(ShockShape::terminal_peak_sawtooth), sample_rate));
  for (const std::size_t start : {1000u, 11000u, 21000u})
  {
    for (std::size_t i = 0; i <= 110; ++i)
    {
      ASSERT_NEAR(samples[start + i], 150.0 * static_cast<double>(i) / 110.0, 1.0e-8) << start + i;
    }
    EXPECT_EQ(samples[start + 111], 0.0);
    EXPECT_EQ(samples[start - 1], 0.0);
  }
}

TEST(Shock, hasNoPulseBeforeTheFirst)
{
  // Waits for longer than from pulse to pulse.
  ShockParameters parameters = shock(ShockShape::half_sine);
  parameters.before = 2.5;
  const std::vector<double> samples = generate(*makeDriveSignal(parameters, sample_rate));
  std::vector<double> crests;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    if (samples[i] > 149.999)
    {
      crests.push_back(static_cast<double>(i));
    }
  }
  EXPECT_EQ(crests, (std::vector<double>{25055.0, 35055.0, 45055.0}));
  for (std::size_t i = 0; i <= 25000; ++i)
  {
    ASSERT_EQ(samples[i], 0.0) << i;
  }
}

TEST(Shock, leavesTheVelocityThatItSays)
{
  const ShockParameters half_sine = shock(ShockShape::half_sine);
  EXPECT_NEAR(velocityChange(half_sine), 2.0 * 150.0 * 0.011 / pi, 1.0e-12);
  EXPECT_NEAR(velocity(generate(*makeDriveSignal(half_sine, sample_rate)), 0, 6000), velocityChange(half_sine), 1.0e-3);
  // The fall takes a sample, and brings half of one more.
  const ShockParameters sawtooth = shock(ShockShape::terminal_peak_sawtooth);
  EXPECT_NEAR(velocityChange(sawtooth), 0.825, 1.0e-12);
  EXPECT_NEAR(velocity(generate(*makeDriveSignal(sawtooth, sample_rate)), 0, 6000),
              velocityChange(sawtooth) + 0.5 * 150.0 / sample_rate, 1.0e-9);
  // The sums over the samples have closed forms, also where the end of the pulse lies between two of them.
  for (const double duration : {0.011, 0.01104, 0.0011})
  {
    for (ShockParameters parameters : {half_sine, sawtooth})
    {
      parameters.duration = duration;
      EXPECT_NEAR(velocity(generate(*makeDriveSignal(parameters, sample_rate)), 0, 6000),
                  velocityChange(parameters, sample_rate), 1.0e-9)
          << duration;
    }
  }
  EXPECT_NEAR(velocityChange(sawtooth, sample_rate), 0.5 * 150.0 * (0.011 + 1.0 / sample_rate), 1.0e-12);
}

TEST(Shock, goesOnUntilItIsAtZeroAgain)
{
  // Nothing is asked for after the pulse, which ends at a sample or between two.
  for (const double duration : {0.011, 0.01104})
  {
    ShockParameters parameters = shock(ShockShape::half_sine);
    parameters.duration = duration;
    parameters.repetitions = 2;
    parameters.after = 0.0;
    std::vector<double> samples = generate(*makeDriveSignal(parameters, sample_rate));
    ASSERT_EQ(samples.size(), duration == 0.011 ? 11111u : 11112u);
    EXPECT_NEAR(samples.back(), 0.0, 1.0e-9);
    EXPECT_GT(*(samples.end() - 2), 1.0);
    EXPECT_NEAR(velocity(samples, 0, samples.size() - 1), 2.0 * velocityChange(parameters, sample_rate), 1.0e-9);

    parameters.shape = ShockShape::terminal_peak_sawtooth;
    samples = generate(*makeDriveSignal(parameters, sample_rate));
    ASSERT_EQ(samples.size(), 11112u);
    EXPECT_EQ(samples.back(), 0.0);
    EXPECT_NEAR(*(samples.end() - 2), 150.0 * 0.011 / duration, 1.0e-9) << "the peak, where it falls on a sample";
    EXPECT_NEAR(velocity(samples, 0, samples.size() - 1), 2.0 * velocityChange(parameters, sample_rate), 1.0e-9);
  }
}

TEST(Shock, mayGoTheOtherWay)
{
  ShockParameters parameters = shock(ShockShape::half_sine);
  parameters.peak = -20.0;
  parameters.repetitions = 1;
  parameters.interval = 0.0;
  EXPECT_NEAR(generate(*makeDriveSignal(parameters, sample_rate))[1055], -20.0, 1.0e-9);
}

TEST(Shock, rejectsWhatIsOutOfRange)
{
  const auto faultsOf = [](const ShockParameters& parameters) { return keysOf(findFaults(parameters, sample_rate)); };
  ShockParameters parameters = shock(ShockShape::half_sine);
  EXPECT_EQ(faultsOf(parameters), "");
  parameters.peak = 0.0;
  parameters.duration = 9.0e-4;  // nine samples
  parameters.before = -1.0;
  parameters.after = nan;
  parameters.repetitions = 0;
  EXPECT_EQ(faultsOf(parameters), "peak duration before after repetitions");
  parameters = shock(ShockShape::half_sine);
  parameters.interval = 0.011;
  EXPECT_EQ(faultsOf(parameters), "interval");
  parameters = shock(ShockShape::half_sine);
  parameters.after = 1.0e15;
  EXPECT_EQ(faultsOf(parameters), "duration");
  parameters.peak = nan;
  parameters.after = 0.0;
  EXPECT_EQ(faultsOf(parameters), "peak");
}

TEST(SampledSignal, givesItsSamplesBack)
{
  SampledParameters parameters;
  parameters.acceleration = std::make_shared<const std::vector<double>>(std::vector<double>{1.0, -2.0, 0.5});
  parameters.sample_period = 2.5e-3;
  const auto signal = makeDriveSignal(parameters, 400.0);
  EXPECT_EQ(signal->samplePeriod(), 2.5e-3);
  EXPECT_EQ(generate(*signal), *parameters.acceleration);
  EXPECT_EQ(generate(*signal, 1, 2), (std::vector<double>{-2.0, 0.5}));
  EXPECT_TRUE(std::isnan(signal->frequency(2)));
  EXPECT_EQ(signal->frequency(3), 0.0);
  EXPECT_THROW(generate(*signal, 2, 2), std::out_of_range);
  EXPECT_EQ(referenceFrequency(parameters), 1.0);
}

TEST(SampledSignal, rejectsWhatIsOutOfRange)
{
  SampledParameters parameters;
  EXPECT_EQ(keysOf(findFaults(parameters, 400.0)), "sample_period acceleration");
  parameters.acceleration = std::make_shared<const std::vector<double>>(std::vector<double>{1.0, nan});
  parameters.sample_period = 1.0e-3;
  EXPECT_EQ(keysOf(findFaults(parameters, 400.0)), "sample_rate acceleration");
}

}  // namespace
