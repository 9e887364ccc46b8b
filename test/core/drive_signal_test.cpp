#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "common.h"
#include "signal_samples.h"
#include "vibro_impact/core/drive_signal.h"
#include "vibro_impact/core/quotient.h"

namespace
{
using namespace vibro_impact::core;

SineParameters sine(double frequency, double cycles)
{
  SineParameters parameters;
  parameters.acceleration = 10.0;
  parameters.frequency = frequency;
  parameters.cycles = cycles;
  return parameters;
}

SteppedSineParameters steps(double start, double stop, double step, std::int64_t cycles)
{
  SteppedSineParameters parameters;
  parameters.acceleration = 10.0;
  parameters.start_frequency = start;
  parameters.stop_frequency = stop;
  parameters.frequency_step = step;
  parameters.cycles_per_step = cycles;
  return parameters;
}

SweptSineParameters sweep(SweepLaw law, double start, double stop, double duration)
{
  SweptSineParameters parameters;
  parameters.law = law;
  parameters.acceleration = 10.0;
  parameters.start_frequency = start;
  parameters.stop_frequency = stop;
  parameters.duration = duration;
  return parameters;
}

TEST(Quotient, keepsTheFractionBesideALargeWholePart)
{
  const Quotient small = divide(7.0, 2.0);
  EXPECT_EQ(small.whole, 3u);
  EXPECT_EQ(small.fraction, 0.5);

  // 3e15 + 1 over 3: one third is left, of which a plain quotient keeps one digit.
  const Quotient large = divide(3.0e15 + 1.0, 3.0);
  EXPECT_EQ(large.whole, 1000000000000000u);
  EXPECT_DOUBLE_EQ(large.fraction, 1.0 / 3.0);

  const Quotient zero = divide(0.0, 3.0);
  EXPECT_EQ(zero.whole, 0u);
  EXPECT_EQ(zero.fraction, 0.0);
}

TEST(Sine, startsAtZeroRisingAndHasItsCyclesAndItsAmplitude)
{
  const auto signal = makeDriveSignal(sine(100.0, 10.0), 50000.0);
  ASSERT_EQ(signal->samples(), 5000u);
  const std::vector<double> samples = generate(*signal);
  EXPECT_EQ(samples[0], 0.0);
  EXPECT_GT(samples[1], 0.0);
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    ASSERT_NEAR(samples[i], 10.0 * std::sin(2.0 * pi * 100.0 * static_cast<double>(i) / 50000.0), 1.0e-11) << i;
  }
  EXPECT_DOUBLE_EQ(samples[125], 10.0);
  EXPECT_EQ(signal->frequency(4999), 100.0);
  EXPECT_EQ(signal->frequency(5000), 0.0);
}

TEST(Sine, endsWhereItsCyclesDoBetweenTwoSamples)
{
  // 3 cycles of 7 Hz at 10 Hz: 30/7 samples.
  EXPECT_EQ(makeDriveSignal(sine(3.5, 1.5), 10.0)->samples(), 5u);
}

TEST(Sine, keepsItsPhaseOverADay)
{
  // 271.25 Hz at 50 kHz: 217 cycles take 40000 samples, so that the phase of any sample is a quotient of whole numbers.
  const auto signal = makeDriveSignal(sine(271.25, 271.25 * 86400.0), 50000.0);
  ASSERT_EQ(signal->samples(), 4320000000u);
  for (std::uint64_t first : {std::uint64_t{0}, std::uint64_t{180000000}, std::uint64_t{4319990000}})
  {
    const std::vector<double> samples = generate(*signal, first, 10000);
    for (std::size_t i = 0; i < samples.size(); ++i)
    {
      const double phase = static_cast<double>((first + i) * 217 % 40000) / 40000.0;
      ASSERT_NEAR(samples[i], 10.0 * std::sin(2.0 * pi * phase), 1.0e-11) << first + i;
    }
  }
}

TEST(Sine, keepsAnAwkwardPhaseOverADay)
{
  // Against extended precision, where it has more digits than a double.
  if (std::numeric_limits<long double>::digits < 64)
  {
    GTEST_SKIP();
  }
  const double frequency = 1705.6163712642947 / (2.0 * pi);
  const auto signal = makeDriveSignal(sine(frequency, 1.0e8), 51200.0);
  const std::uint64_t first = 51200ull * 86400ull;
  const std::vector<double> samples = generate(*signal, first, 1000);
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const long double cycles = static_cast<long double>(first + i) * static_cast<long double>(frequency) / 51200.0L;
    const double phase = static_cast<double>(cycles - std::floor(cycles));
    // 2e7 cycles leave 2e-12 of a cycle to extended precision.
    ASSERT_NEAR(samples[i], 10.0 * std::sin(2.0 * pi * phase), 10.0 * 2.0 * pi * 4.0e-12) << i;
  }
}

TEST(Sine, startsSoftly)
{
  SineParameters parameters = sine(100.0, 10.0);
  parameters.soft_start_cycles = 4.0;
  const std::vector<double> samples = generate(*makeDriveSignal(parameters, 50000.0));
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const double cycles = static_cast<double>(i) / 500.0;
    const double amplitude = cycles < 4.0 ? 5.0 * (1.0 - std::cos(pi * cycles / 4.0)) : 10.0;
    ASSERT_NEAR(samples[i], amplitude * std::sin(2.0 * pi * cycles), 1.0e-11) << i;
  }
}

TEST(SteppedSine, countsItsStepsExactly)
{
  const std::vector<double> up = stepFrequencies(steps(0.5, 4.0, 0.005, 200));
  ASSERT_EQ(up.size(), 701u);
  EXPECT_EQ(up.front(), 0.5);
  EXPECT_DOUBLE_EQ(up[220], 1.6);
  EXPECT_DOUBLE_EQ(up.back(), 4.0);

  const std::vector<double> down = stepFrequencies(steps(0.3, 0.1, 0.1, 1));
  ASSERT_EQ(down.size(), 3u);
  EXPECT_DOUBLE_EQ(down[1], 0.2);
  EXPECT_DOUBLE_EQ(down[2], 0.1);

  EXPECT_EQ(stepFrequencies(steps(1.0, 2.0, 0.3, 1)).size(), 4u);
  EXPECT_EQ(stepFrequencies(steps(2.0, 2.0, 0.3, 1)).size(), 1u);
  EXPECT_EQ(stepFrequencies(steps(1.0, 2.0, 5.0, 1)).size(), 1u);

  SteppedSineParameters relative = steps(0.5, 4.0, 0.005, 200);
  relative.reference_frequency = 271.45727650517387;
  EXPECT_DOUBLE_EQ(stepFrequencies(relative)[220], 1.6 * 271.45727650517387);
}

// The instantaneous phase of stepped sine and all its steps, from their begins in extended precision.
class SteppedSineSamples : public testing::TestWithParam<SteppedSineParameters>
{
};

TEST_P(SteppedSineSamples, areThoseOfWholeCyclesWithContinuousPhase)
{
  const SteppedSineParameters& parameters = GetParam();
  const double rate = 50000.0;
  const auto signal = makeDriveSignal(parameters, rate);
  const std::vector<double> samples = generate(*signal);

  const auto cycles = static_cast<long double>(parameters.cycles_per_step);
  const std::vector<double> frequencies = stepFrequencies(parameters);
  long double begin = 0.0L;
  std::size_t sample = 0;
  double jump = 0.0;
  for (std::size_t i = 0; i < frequencies.size(); ++i)
  {
    const bool soft = i == 0 || parameters.rest > 0.0;
    const long double end = begin + cycles / static_cast<long double>(frequencies[i]);
    for (; static_cast<long double>(sample) < end * rate - 1.0e-6L; ++sample)
    {
      const auto phase = static_cast<double>((static_cast<long double>(sample) / rate - begin) *
                                             static_cast<long double>(frequencies[i]));
      const double ramp = soft && phase < parameters.soft_start_cycles
                              ? 0.5 - 0.5 * std::cos(pi * phase / parameters.soft_start_cycles)
                              : 1.0;
      const double expected = parameters.acceleration * ramp * std::sin(2.0 * pi * phase);
      ASSERT_NEAR(samples[sample], expected, 1.0e-8) << "step " << i << ", sample " << sample;
      ASSERT_EQ(signal->frequency(sample), frequencies[i]) << "step " << i << ", sample " << sample;
      jump = std::max(jump, sample == 0 ? 0.0 : std::abs(samples[sample] - samples[sample - 1]));
    }
    begin = end;
    if (i + 1 < frequencies.size() && parameters.rest > 0.0)
    {
      begin += static_cast<long double>(parameters.rest);
      for (; static_cast<long double>(sample) < begin * rate - 1.0e-6L; ++sample)
      {
        ASSERT_EQ(samples[sample], 0.0) << "rest after step " << i << ", sample " << sample;
        ASSERT_EQ(signal->frequency(sample), 0.0) << "rest after step " << i << ", sample " << sample;
      }
    }
  }
  EXPECT_EQ(sample, samples.size());
  // No two neighbours lie further apart than the steepest slope of the fastest step allows.
  const double fastest = std::max(frequencies.front(), frequencies.back());
  EXPECT_LE(jump, parameters.acceleration * 2.0 * pi * fastest / rate);
}

SteppedSineParameters withReference(SteppedSineParameters parameters, double reference)
{
  parameters.reference_frequency = reference;
  return parameters;
}

SteppedSineParameters withSoftStartAndRest(SteppedSineParameters parameters, double cycles, double rest)
{
  parameters.soft_start_cycles = cycles;
  parameters.rest = rest;
  return parameters;
}

INSTANTIATE_TEST_SUITE_P(
    Steps, SteppedSineSamples,
    testing::Values(steps(100.0, 500.0, 100.0, 10),                                      // all ends on samples
                    withReference(steps(0.5, 4.0, 0.125, 7), 271.45727650517387),        // none
                    withReference(steps(4.0, 0.5, 0.125, 7), 271.45727650517387),        // downwards
                    steps(3000.0, 7000.0, 37.0, 1),                                      // a few samples a step
                    withSoftStartAndRest(steps(130.0, 190.0, 20.0, 30), 12.0, 0.0),      // soft at the start only
                    withSoftStartAndRest(steps(130.0, 190.0, 20.0, 30), 12.0, 0.0123),   // soft after each rest
                    withSoftStartAndRest(steps(130.0, 190.0, 20.0, 30), 0.0, 1.7e-5)));  // rests shorter than a sample

TEST(SteppedSine, startsEveryStepOnTimeAfterHours)
{
  // 1000 cycles of 0.7 Hz ... over 400 steps: 2e5 s. The last step begins after the sum of the lengths of all before.
  const SteppedSineParameters parameters = steps(0.7, 4.69, 0.01, 1000);
  const auto signal = makeDriveSignal(parameters, 51200.0);
  const std::vector<double> frequencies = stepFrequencies(parameters);
  ASSERT_EQ(frequencies.size(), 400u);
  long double begin = 0.0L;
  for (std::size_t i = 0; i + 1 < frequencies.size(); ++i)
  {
    begin += 1000.0L / static_cast<long double>(frequencies[i]);
  }
  const auto first = static_cast<std::uint64_t>(std::ceil(begin * 51200.0L));
  EXPECT_EQ(signal->frequency(first - 1), frequencies[398]);
  EXPECT_EQ(signal->frequency(first), frequencies[399]);
  const auto cycles = static_cast<double>((static_cast<long double>(first) / 51200.0L - begin) *
                                          static_cast<long double>(frequencies[399]));
  EXPECT_NEAR(generate(*signal, first, 1)[0], 10.0 * std::sin(2.0 * pi * cycles), 1.0e-10);
}

class Sweep : public testing::TestWithParam<SweptSineParameters>
{
};

TEST_P(Sweep, hasThePhaseThatIsTheIntegralOfItsFrequency)
{
  const SweptSineParameters& parameters = GetParam();
  const double rate = 50000.0;
  const auto signal = makeDriveSignal(parameters, rate);
  EXPECT_EQ(signal->samples(), static_cast<std::uint64_t>(std::llround(parameters.duration * rate)));
  const std::vector<double> samples = generate(*signal);
  EXPECT_EQ(samples[0], 0.0);
  EXPECT_GT(samples[1], 0.0);

  double cycles = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const double ramp =
        cycles < parameters.soft_start_cycles ? 0.5 - 0.5 * std::cos(pi * cycles / parameters.soft_start_cycles) : 1.0;
    ASSERT_NEAR(samples[i], 10.0 * ramp * std::sin(2.0 * pi * cycles), 1.0e-6) << i;
    // Simpson's rule over one sample, with the frequency of the law itself.
    const auto frequency = [&parameters](double time)
    {
      const double share = time / parameters.duration;
      return parameters.law == SweepLaw::linear
                 ? parameters.start_frequency + (parameters.stop_frequency - parameters.start_frequency) * share
                 : parameters.start_frequency * std::pow(parameters.stop_frequency / parameters.start_frequency, share);
    };
    const double time = static_cast<double>(i) / rate;
    ASSERT_NEAR(signal->frequency(i), frequency(time), 1.0e-9 * frequency(time)) << i;
    cycles += (frequency(time) + 4.0 * frequency(time + 0.5 / rate) + frequency(time + 1.0 / rate)) / (6.0 * rate);
  }
}

SweptSineParameters soft(SweptSineParameters parameters, double cycles)
{
  parameters.soft_start_cycles = cycles;
  return parameters;
}

INSTANTIATE_TEST_SUITE_P(Laws, Sweep,
                         testing::Values(sweep(SweepLaw::linear, 20.0, 2000.0, 2.0),
                                         sweep(SweepLaw::linear, 2000.0, 20.0, 2.0),
                                         sweep(SweepLaw::logarithmic, 20.0, 2000.0, 2.0),
                                         soft(sweep(SweepLaw::logarithmic, 2000.0, 20.0, 2.0), 25.0)));

TEST(DriveSignal, hasTheSameSamplesHoweverTheyAreAskedFor)
{
  const std::vector<DriveParameters> all = {
      sine(271.45727650517387, 300.0),
      withSoftStartAndRest(withReference(steps(0.5, 4.0, 0.25, 20), 271.45727650517387), 3.0, 0.001),
      sweep(SweepLaw::linear, 20.0, 2000.0, 1.0), sweep(SweepLaw::logarithmic, 20.0, 2000.0, 1.0)};
  for (const DriveParameters& parameters : all)
  {
    const auto signal = makeDriveSignal(parameters, 50000.0);
    const std::vector<double> whole = generate(*signal);
    std::uint64_t first = 0;
    for (std::size_t count = 1; first < whole.size(); count = count * 7 % 3001 + 1)
    {
      const std::size_t here = std::min<std::size_t>(count, whole.size() - first);
      const std::vector<double> part = generate(*signal, first, here);
      for (std::size_t i = 0; i < here; ++i)
      {
        ASSERT_EQ(part[i], whole[first + i]) << "kind " << parameters.index() << ", sample " << first + i;
      }
      first += here;
    }
  }
}

TEST(DriveSignal, endsAtItsLastSample)
{
  const auto signal = makeDriveSignal(sine(100.0, 1.0), 1000.0);
  double value = 0.0;
  EXPECT_NO_THROW(signal->generate(10, 0, &value));
  EXPECT_NO_THROW(signal->generate(9, 1, &value));
  EXPECT_THROW(signal->generate(9, 2, &value), std::out_of_range);
  EXPECT_THROW(signal->generate(11, 0, &value), std::out_of_range);
  EXPECT_THROW(signal->generate(std::numeric_limits<std::uint64_t>::max(), 1, &value), std::out_of_range);
}

TEST(DriveSignal, namesEveryParameterOutOfRange)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(findFaults(sine(100.0, 1.0), 50000.0).empty());
  EXPECT_EQ(keysOf(findFaults(sine(0.0, -1.0), 50000.0)), "frequency cycles");
  EXPECT_EQ(keysOf(findFaults(sine(100.0, 1.0), 200.0)), "frequency");
  EXPECT_EQ(keysOf(findFaults(sine(nan, nan), nan)), "sample_rate frequency cycles");
  EXPECT_EQ(keysOf(findFaults(sine(1.0, 1.0e300), 50000.0)), "duration");

  SteppedSineParameters stepped = steps(-1.0, 30000.0, 0.0, 0);
  stepped.acceleration = -1.0;
  stepped.rest = -1.0;
  stepped.soft_start_cycles = -1.0;
  EXPECT_EQ(keysOf(findFaults(stepped, 50000.0)),
            "acceleration start_frequency stop_frequency frequency_step cycles_per_step soft_start_cycles rest");
  EXPECT_EQ(keysOf(findFaults(steps(1.0, 2.0, 1.0e-9, 1), 50000.0)), "frequency_step");
  EXPECT_EQ(keysOf(findFaults(withSoftStartAndRest(steps(1.0, 2.0, 0.1, 5), 6.0, 0.0), 50000.0)), "soft_start_cycles");
  EXPECT_EQ(keysOf(findFaults(withReference(steps(1.0, 2.0, 0.1, 5), 0.0), 50000.0)), "reference_frequency");
  EXPECT_EQ(keysOf(findFaults(withReference(steps(1.0, 2.0, 0.1, 5), 20000.0), 50000.0)), "stop_frequency");

  EXPECT_EQ(keysOf(findFaults(sweep(SweepLaw::linear, 100.0, 100.0, 0.0), 50000.0)), "stop_frequency duration");

  try
  {
    makeDriveSignal(sine(0.0, -1.0), 50000.0);
    FAIL() << "made a signal";
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_STREQ(error.what(),
                 "frequency = 0: must be a number > 0 and < 25000, half the sample rate (Hz); "
                 "cycles = -1: must be a finite number > 0");
  }
}

}  // namespace
