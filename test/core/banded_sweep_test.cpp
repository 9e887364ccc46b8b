#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common.h"
#include "signal_samples.h"
#include "vibro_impact/core/drive_signal.h"

namespace
{
using namespace vibro_impact::core;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double sample_rate = 5000.0;

/// The sweep of IEC 60945, quicker.
BandedSweepParameters marineSweep()
{
  BandedSweepParameters parameters;
  parameters.bands = {{2.0, 13.2, {MotionQuantity::displacement, 1.0e-3}},
                      {13.2, 100.0, {MotionQuantity::acceleration, 7.0}}};
  parameters.rate = 20.0;
  return parameters;
}

// Cycles of an upward sweep from its start, by Simpson's rule.
double integrated(double from, double octaves_per_minute, double time)
{
  const int steps = 2000;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i)
  {
    const double frequency = from * std::exp2(octaves_per_minute / 60.0 * time * i / steps);
    sum += frequency * (i == 0 || i == steps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0);
  }
  return sum * time / steps / 3.0;
}

TEST(BandedSweep, takesTheTimeThatItsRateSays)
{
  const auto signal = makeDriveSignal(marineSweep(), sample_rate);
  const double seconds = 60.0 * std::log2(50.0) / 20.0;
  EXPECT_EQ(signal->samples(), static_cast<std::uint64_t>(std::ceil(seconds * sample_rate)));
  EXPECT_DOUBLE_EQ(signal->frequency(0), 2.0);
  EXPECT_NEAR(signal->frequency(15000), 4.0, 1.0e-12);  // 3 s are an octave
  EXPECT_NEAR(signal->frequency(signal->samples() - 1), 100.0, 0.01);
  EXPECT_EQ(signal->frequency(signal->samples()), 0.0);
}

TEST(BandedSweep, hasThePhaseAndTheAmplitudeOfItsFrequency)
{
  const auto signal = makeDriveSignal(marineSweep(), sample_rate);
  for (const std::uint64_t sample : {0u, 1u, 777u, 20000u, 40000u, 44000u, 80000u})
  {
    const double time = static_cast<double>(sample) / sample_rate;
    const double frequency = 2.0 * std::exp2(time / 3.0);
    ASSERT_GT(std::abs(std::log2(frequency / 13.2)), 0.5 * crossover_octaves);
    const double amplitude = frequency < 13.2 ? std::pow(2.0 * pi * frequency, 2) * 1.0e-3 : 7.0;
    EXPECT_NEAR(generate(*signal, sample, 1)[0], amplitude * std::sin(2.0 * pi * integrated(2.0, 20.0, time)), 1.0e-8)
        << sample;
  }
  expectTheSameInAnyBlocks(*signal);
}

TEST(BandedSweep, passesFromOneBandToTheNextWithoutAJump)
{
  const BandedSweepParameters parameters = marineSweep();
  const double displacement_law = std::pow(2.0 * pi * 13.2, 2) * 1.0e-3;
  EXPECT_NEAR(accelerationAmplitude(parameters.bands, 13.2), 0.5 * (displacement_law + 7.0), 1.0e-12);
  const double half = std::exp2(0.5 * crossover_octaves);
  EXPECT_NEAR(accelerationAmplitude(parameters.bands, 13.2 / half * 0.999999), displacement_law / half / half, 1.0e-4);
  EXPECT_NEAR(accelerationAmplitude(parameters.bands, 13.2 * half * 1.000001), 7.0, 1.0e-9);
  double last = accelerationAmplitude(parameters.bands, 12.0);
  for (double frequency = 12.0; frequency < 14.5; frequency += 1.0e-3)
  {
    const double here = accelerationAmplitude(parameters.bands, frequency);
    ASSERT_LT(std::abs(here - last), 0.003) << frequency;
    last = here;
  }
}

TEST(BandedSweep, goesDownwardsAndToAndFro)
{
  BandedSweepParameters parameters = marineSweep();
  parameters.upwards = false;
  parameters.sweeps = 3;
  const auto signal = makeDriveSignal(parameters, sample_rate);
  const double once = 3.0 * std::log2(50.0);
  const auto at = [once](double sweeps)
  { return static_cast<std::uint64_t>(std::llround(once * sweeps * sample_rate)); };
  EXPECT_DOUBLE_EQ(signal->frequency(0), 100.0);
  EXPECT_NEAR(signal->frequency(at(0.5)), std::sqrt(200.0), 1.0e-2);
  EXPECT_NEAR(signal->frequency(at(1.0)), 2.0, 1.0e-3);
  EXPECT_NEAR(signal->frequency(at(1.5)), std::sqrt(200.0), 1.0e-2);
  EXPECT_NEAR(signal->frequency(at(2.0)), 100.0, 1.0e-2);
  EXPECT_NEAR(signal->frequency(signal->samples() - 1), 2.0, 1.0e-3);

  // Continuous through every turn: no step of the acceleration is larger than the steepest sine allows.
  const std::vector<double> samples = generate(*signal);
  for (std::size_t i = 1; i < samples.size(); ++i)
  {
    ASSERT_LE(std::abs(samples[i] - samples[i - 1]), 7.0 * 2.0 * pi * 101.0 / sample_rate) << i;
  }
  expectTheSameInAnyBlocks(*signal);
}

TEST(BandedSweep, startsSoftly)
{
  BandedSweepParameters parameters = marineSweep();
  parameters.soft_start_cycles = 2.0;
  const auto soft = generate(*makeDriveSignal(parameters, sample_rate));
  const auto hard = generate(*makeDriveSignal(marineSweep(), sample_rate));
  EXPECT_EQ(soft[0], 0.0);
  EXPECT_LT(std::abs(soft[600]), 0.1 * std::abs(hard[600]));
  EXPECT_EQ(soft[10000], hard[10000]);
}

TEST(BandedSweep, rejectsWhatIsOutOfRange)
{
  const auto faultsOf = [](const BandedSweepParameters& parameters)
  { return keysOf(findFaults(parameters, sample_rate)); };
  EXPECT_EQ(faultsOf(marineSweep()), "");

  BandedSweepParameters parameters = marineSweep();
  parameters.bands.clear();
  EXPECT_EQ(faultsOf(parameters), "bands");
  parameters = marineSweep();
  parameters.bands[1].from = 13.3;  // a hole
  EXPECT_EQ(faultsOf(parameters), "bands[1].from");
  parameters = marineSweep();
  parameters.bands[0].to = parameters.bands[1].from = 2.05;  // less than a sixteenth of an octave
  EXPECT_EQ(faultsOf(parameters), "bands[0].to");
  parameters = marineSweep();
  parameters.bands[1].to = 10.0;  // downwards
  EXPECT_EQ(faultsOf(parameters), "bands[1].to");
  parameters = marineSweep();
  parameters.bands[1].to = 2500.0;  // half the sample rate
  parameters.bands[0].amplitude.value = nan;
  EXPECT_EQ(faultsOf(parameters), "bands[0].displacement bands[1].to");
  parameters = marineSweep();
  parameters.rate = 0.0;
  parameters.sweeps = 0;
  parameters.soft_start_cycles = -1.0;
  EXPECT_EQ(faultsOf(parameters), "rate sweeps soft_start_cycles");
  parameters = marineSweep();
  parameters.rate = 1.0e-12;
  EXPECT_EQ(faultsOf(parameters), "duration");
  EXPECT_THROW(makeDriveSignal(parameters, sample_rate), std::invalid_argument);
}

}  // namespace
