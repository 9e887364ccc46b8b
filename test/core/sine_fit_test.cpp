#include "vibro_impact/core/sine_fit.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"

namespace vibro_impact::core
{
namespace
{
struct Signal
{
  double frequency = 2.0 * pi * 271.3;
  double sample_period = 2.0e-5;
  double amplitude = 4.2;
  double phase = 0.7;  // half way
  double offset = -0.3;
  double second = 0.0;
  double third = 0.0;
  double noise = 0.0;

  std::vector<double> samples(std::size_t count) const
  {
    std::mt19937 generator(11);
    std::normal_distribution<double> normal;
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
    {
      const double t = (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1)) * sample_period;
      values.push_back(offset + amplitude * std::cos(frequency * t + phase) +
                       second * std::cos(2.0 * frequency * t + 1.0) + third * std::sin(3.0 * frequency * t) +
                       noise * normal(generator));
    }
    return values;
  }
};

TEST(SineFit, findsAllFourParameters)
{
  const Signal signal;
  const auto samples = signal.samples(3001);  // not a whole number of cycles
  const SineFit fit = fitSine(samples.data(), samples.size(), signal.sample_period, signal.frequency * 1.004);
  EXPECT_NEAR(fit.frequency, signal.frequency, 1e-11 * signal.frequency);
  EXPECT_NEAR(fit.amplitude, signal.amplitude, 1e-10);
  EXPECT_NEAR(fit.phase, signal.phase, 1e-10);
  EXPECT_NEAR(fit.offset, signal.offset, 1e-10);
  EXPECT_NEAR(fit.residual, 0.0, 1e-6);
}

TEST(SineFit, isAsExactAsTheNoiseAllows)
{
  Signal signal;
  signal.noise = 0.05 * signal.amplitude;
  const std::size_t count = 20000;
  const auto samples = signal.samples(count);
  const SineFit fit = fitSine(samples.data(), count, signal.sample_period, signal.frequency * 1.0003);
  // The bound of Cramer and Rao for the frequency.
  const double duration = static_cast<double>(count) * signal.sample_period;
  const double bound = std::sqrt(24.0 / static_cast<double>(count)) * 0.05 / duration;
  EXPECT_NEAR(fit.frequency, signal.frequency, 4.0 * bound);
  EXPECT_NEAR(fit.residual, signal.noise, 0.02 * signal.noise);
  EXPECT_NEAR(fit.amplitude, signal.amplitude, 4.0 * signal.noise * std::sqrt(2.0 / static_cast<double>(count)));
}

TEST(SineFit, harmonicsFittedAlongDoNotLeakIntoTheFundamental)
{
  Signal signal;
  signal.second = 0.05 * signal.amplitude;
  signal.third = 0.03 * signal.amplitude;
  const auto samples = signal.samples(900);  // 4.9 cycles
  const SineFit alone = fitSine(samples.data(), samples.size(), signal.sample_period, signal.frequency, 1);
  EXPECT_GT(std::abs(alone.frequency / signal.frequency - 1.0), 1e-6);
  const SineFit fit = fitSine(samples.data(), samples.size(), signal.sample_period, signal.frequency * 1.01, 3);
  EXPECT_NEAR(fit.frequency, signal.frequency, 1e-10 * signal.frequency);
  EXPECT_NEAR(fit.amplitude, signal.amplitude, 1e-9);
}

TEST(SineFit, oneStepFromAGoodFrequencyIsEnough)
{
  const Signal signal;
  const auto samples = signal.samples(50000);
  const double off = 0.01 / (50000.0 * signal.sample_period);  // a hundredth of a cycle over all samples
  SineFitter fitter(signal.frequency + 2.0 * pi * off, signal.sample_period, samples.size());
  fitter.add(samples.data(), samples.size());
  EXPECT_NEAR(fitter.unknownFrequency().frequency, signal.frequency, 1e-3 * 2.0 * pi * off);
}

TEST(SineFit, knownFrequencyGivesAmplitudePhaseAndOffset)
{
  const Signal signal;
  const auto samples = signal.samples(77);
  SineFitter fitter(signal.frequency, signal.sample_period, samples.size());
  fitter.add(samples.data(), samples.size());
  const SineFit fit = fitter.knownFrequency();
  EXPECT_EQ(fit.frequency, signal.frequency);
  EXPECT_NEAR(fit.amplitude, signal.amplitude, 1e-8);
  EXPECT_NEAR(fit.phase, signal.phase, 1e-8);
  EXPECT_NEAR(fit.offset, signal.offset, 1e-8);
}

TEST(SineFit, samplesMayComeInPieces)
{
  const Signal signal;
  const auto samples = signal.samples(5000);
  SineFitter whole(signal.frequency, signal.sample_period, samples.size(), 3);
  EXPECT_EQ(whole.add(samples.data(), samples.size()), samples.size());
  SineFitter pieces(signal.frequency, signal.sample_period, samples.size(), 3);
  EXPECT_EQ(pieces.add(samples.data(), 700), 700u);
  EXPECT_FALSE(pieces.complete());
  EXPECT_EQ(pieces.add(samples.data() + 700, 1), 1u);
  std::vector<double> rest(samples.begin() + 701, samples.end());
  rest.push_back(1e9);  // one too many is left
  EXPECT_EQ(pieces.add(rest.data(), rest.size()), samples.size() - 701);
  EXPECT_TRUE(pieces.complete());
  EXPECT_NEAR(pieces.unknownFrequency().frequency, whole.unknownFrequency().frequency, 1e-10 * signal.frequency);
}

TEST(SineFit, constantSamplesHaveNoAmplitude)
{
  const std::vector<double> samples(500, 2.5);
  SineFitter fitter(2000.0, 1.0e-4, samples.size());
  fitter.add(samples.data(), samples.size());
  EXPECT_NEAR(fitter.knownFrequency().amplitude, 0.0, 1e-12);
  EXPECT_NEAR(fitter.knownFrequency().offset, 2.5, 1e-12);
}

TEST(SineFit, refusesWhatIsOutOfRange)
{
  EXPECT_THROW(SineFitter(0.0, 1e-3, 10), std::invalid_argument);
  EXPECT_THROW(SineFitter(std::nan(""), 1e-3, 10), std::invalid_argument);
  EXPECT_THROW(SineFitter(10.0, 0.0, 10), std::invalid_argument);
  EXPECT_THROW(SineFitter(10.0, 1e-3, 0), std::invalid_argument);
  EXPECT_THROW(SineFitter(10.0, 1e-3, 10, 0), std::invalid_argument);
  EXPECT_THROW(SineFitter(10.0, 1e-3, 10, 4), std::invalid_argument);
  const std::vector<double> samples(4, 0.0);
  EXPECT_THROW(fitSine(samples.data(), samples.size(), 1e-3, 10.0), std::invalid_argument);
}
}  // namespace
}  // namespace vibro_impact::core
