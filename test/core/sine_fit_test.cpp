#include "vibro_impact/core/sine_fit.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/QR>

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

// The same least squares by Householder's reflections of all columns, without normal equations.
SineFit orthogonalFit(const std::vector<double>& samples, double step, int harmonics)
{
  const auto count = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd columns(count, 1 + 2 * harmonics);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    const double n = static_cast<double>(i) - 0.5 * static_cast<double>(count - 1);
    columns(i, 0) = 1.0;
    for (int h = 1; h <= harmonics; ++h)
    {
      columns(i, 2 * h - 1) = std::cos(h * step * n);
      columns(i, 2 * h) = std::sin(h * step * n);
    }
  }
  const Eigen::Map<const Eigen::VectorXd> y(samples.data(), count);
  const Eigen::VectorXd solution = columns.colPivHouseholderQr().solve(y);
  SineFit fit;
  fit.offset = solution(0);
  fit.amplitude = std::hypot(solution(1), solution(2));
  fit.phase = std::atan2(-solution(2), solution(1));
  fit.residual = (y - columns * solution).norm() / std::sqrt(static_cast<double>(count - columns.cols()));
  return fit;
}

TEST(SineFit, agreesWithAnOrthogonalDecomposition)
{
  Signal signal;
  signal.second = 0.4;
  signal.third = -0.2;
  signal.noise = 0.3;
  for (const int harmonics : {1, 2, 3})
  {
    // From less than a cycle to many, odd and even, and of few samples a cycle: 184, 7.3, 2.9 (which one harmonic can
    // follow).
    for (const std::size_t count : {12u, 13u, 100u, 369u, 4001u, 20000u})
    {
      for (const double step : {0.034, 0.86, 2.2})
      {
        const bool determined = step * harmonics < 3.0 && step * static_cast<double>(count) > 3.0;
        if (!determined)
        {
          continue;
        }
        SCOPED_TRACE(::testing::Message() << harmonics << " harmonics, " << count << " samples, step " << step);
        signal.frequency = step / signal.sample_period;
        const auto samples = signal.samples(count);
        SineFitter fitter(1.003 * signal.frequency, signal.sample_period, count, harmonics);
        fitter.add(samples.data(), count);
        const SineFit fit = fitter.knownFrequency();
        const SineFit expected = orthogonalFit(samples, 1.003 * step, harmonics);
        EXPECT_NEAR(fit.amplitude, expected.amplitude, 1e-9 * expected.amplitude);
        EXPECT_NEAR(std::remainder(fit.phase - expected.phase, 2.0 * pi), 0.0, 1e-9);
        EXPECT_NEAR(fit.offset, expected.offset, 1e-9 * expected.amplitude);
        EXPECT_NEAR(fit.residual, expected.residual, 1e-9 * expected.residual);
      }
    }
  }
}

TEST(SineFit, theStepOfTheFrequencyIsThatOfGaussAndNewton)
{
  Signal signal;
  signal.second = 0.4;
  signal.noise = 0.3;
  for (const std::size_t count : {100u, 369u, 4001u})
  {
    SCOPED_TRACE(count);
    const auto samples = signal.samples(count);
    const double frequency = signal.frequency * (1.0 + 2.0 / static_cast<double>(count));
    SineFitter fitter(frequency, signal.sample_period, count, 3);
    fitter.add(samples.data(), count);
    // The derivative of the samples with respect to the frequency beside the columns of the known one.
    const SineFit known = fitter.knownFrequency();
    Eigen::MatrixXd columns(count, 8);
    for (std::size_t i = 0; i < count; ++i)
    {
      const auto row = static_cast<Eigen::Index>(i);
      const double t = (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1)) * signal.sample_period;
      columns.row(row) << 1.0, std::cos(frequency * t), std::sin(frequency * t), std::cos(2.0 * frequency * t),
          std::sin(2.0 * frequency * t), std::cos(3.0 * frequency * t), std::sin(3.0 * frequency * t),
          -t * known.amplitude * std::sin(frequency * t + known.phase);
    }
    const Eigen::Map<const Eigen::VectorXd> y(samples.data(), static_cast<Eigen::Index>(count));
    const double change = columns.colPivHouseholderQr().solve(y)(7);
    EXPECT_NEAR(fitter.unknownFrequency().frequency, frequency + change, 1e-9 * std::abs(change));
  }
}

TEST(SineFit, isNotToldBeforeAllSamplesAreThere)
{
  const std::vector<double> samples(20, 1.0);
  SineFitter fitter(2000.0, 1.0e-4, samples.size() + 1);
  fitter.add(samples.data(), samples.size());
  EXPECT_THROW(fitter.knownFrequency(), std::logic_error);
  EXPECT_THROW(fitter.unknownFrequency(), std::logic_error);
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
