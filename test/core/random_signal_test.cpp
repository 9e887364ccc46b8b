#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "common.h"
#include "signal_samples.h"
#include "vibro_impact/core/drive_signal.h"

namespace
{
using namespace vibro_impact::core;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double sample_rate = 1000.0;

RandomParameters shipNoise(double duration, std::int64_t seed = 1)
{
  RandomParameters parameters;
  parameters.spectrum = {{2.0, 0.02}, {5.0, 0.1}, {50.0, 0.1}, {100.0, 0.03}};
  parameters.duration = duration;
  parameters.seed = seed;
  return parameters;
}

// The density of the table, by logarithms to base ten.
double tableAt(double frequency)
{
  const double x = std::log10(frequency);
  const auto line = [x](double f0, double s0, double f1, double s1)
  {
    const double part = (x - std::log10(f0)) / (std::log10(f1) - std::log10(f0));
    return std::pow(10.0, (1.0 - part) * std::log10(s0) + part * std::log10(s1));
  };
  return frequency < 5.0 ? line(2.0, 0.02, 5.0, 0.1) : frequency < 50.0 ? 0.1 : line(50.0, 0.1, 100.0, 0.03);
}

// P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967): one-sided density at a frequency from half overlapping
// segments of `length` samples under Hann's window, whose transforms are summed term by term.
double welch(const std::vector<double>& samples, std::size_t length, double frequency, double rate = sample_rate)
{
  std::vector<std::complex<double>> kernel(length);
  double power = 0.0;
  for (std::size_t i = 0; i < length; ++i)
  {
    const double window = 0.5 - 0.5 * std::cos(2.0 * pi * static_cast<double>(i) / static_cast<double>(length));
    kernel[i] = window * std::polar(1.0, -2.0 * pi * frequency * static_cast<double>(i) / rate);
    power += window * window;
  }
  double sum = 0.0;
  std::size_t segments = 0;
  for (std::size_t start = 0; start + length <= samples.size(); start += length / 2)
  {
    std::complex<double> transform = 0.0;
    for (std::size_t i = 0; i < length; ++i)
    {
      transform += samples[start + i] * kernel[i];
    }
    sum += std::norm(transform);
    ++segments;
  }
  return 2.0 * sum / (static_cast<double>(segments) * power * rate);
}

TEST(Spectrum, isStraightInLogLogScales)
{
  const std::vector<SpectrumPoint> spectrum = shipNoise(1.0).spectrum;
  for (const double frequency : {2.0, 3.0, 4.99, 5.0, 20.0, 50.0, 70.0, 100.0})
  {
    EXPECT_NEAR(spectralDensity(spectrum, frequency) / tableAt(frequency), 1.0, 1.0e-12) << frequency;
  }
  EXPECT_EQ(spectralDensity(spectrum, 1.999), 0.0);
  EXPECT_EQ(spectralDensity(spectrum, 100.001), 0.0);
}

TEST(Spectrum, hasTheRootMeanSquareOfItsIntegral)
{
  double square = 0.0;
  const double step = 1.0e-3;
  for (double frequency = 2.0 + 0.5 * step; frequency < 100.0; frequency += step)
  {
    square += step * tableAt(frequency);
  }
  EXPECT_NEAR(rootMeanSquare(shipNoise(1.0).spectrum), std::sqrt(square), 1.0e-6);
  // A density that falls by 3 dB per octave: the power law that has a logarithm for an integral.
  EXPECT_NEAR(rootMeanSquare({{10.0, 1.0}, {100.0, 0.1}}), std::sqrt(10.0 * std::log(10.0)), 1.0e-9);
}

TEST(RandomSignal, hasItsSpectrumWithinADecibel)
{
  // 800 s, resolved by 0.5 Hz: some 800 averages, of a standard error of 0.16 dB.
  const std::vector<double> samples = generate(*makeDriveSignal(shipNoise(800.0), sample_rate));
  for (const double frequency :
       {2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 11.0, 15.0, 20.0, 27.0, 35.0, 45.0, 50.0, 55.0, 65.0, 75.0, 85.0, 95.0, 99.0})
  {
    const double decibels = 10.0 * std::log10(welch(samples, 2000, frequency) / tableAt(frequency));
    EXPECT_LT(std::abs(decibels), 1.0) << frequency << " Hz";
  }
  // Beyond its ends there is nothing.
  for (const double frequency : {0.5, 1.0, 103.0, 150.0, 400.0})
  {
    EXPECT_LT(welch(samples, 2000, frequency), 1.0e-3 * 0.1) << frequency << " Hz";
  }
}

TEST(RandomSignal, hasItsSpectrumWithinADecibelWhereItIsSteep)
{
  // A fall and a rise of 30 dB in 1 Hz, resolved by 0.012 Hz: some 1600 averages, of a standard error of 0.11 dB.
  constexpr double rate = 100.0;
  constexpr std::size_t length = 8192;
  RandomParameters parameters = shipNoise(65536.0);
  parameters.spectrum = {{5.0, 1.0}, {10.0, 1.0}, {11.0, 1.0e-3}, {20.0, 1.0e-3}, {21.0, 1.0}, {30.0, 1.0}};
  const std::vector<double> samples = generate(*makeDriveSignal(parameters, rate));
  for (const double frequency : {6.0,  9.0,  9.9,  10.0,  10.05, 10.2, 10.5, 10.8,  10.95, 11.0, 11.1, 13.0,
                                 17.0, 19.9, 20.0, 20.05, 20.2,  20.5, 20.8, 20.95, 21.0,  21.1, 25.0, 29.0})
  {
    const double decibels =
        10.0 * std::log10(welch(samples, length, frequency, rate) / spectralDensity(parameters.spectrum, frequency));
    EXPECT_LT(std::abs(decibels), 1.0) << frequency << " Hz";
  }
}

TEST(RandomSignal, isGaussian)
{
  const RandomParameters parameters = shipNoise(2000.0);
  std::vector<double> samples = generate(*makeDriveSignal(parameters, sample_rate));
  samples.erase(samples.begin(), samples.begin() + 1000);  // the soft start
  const auto count = static_cast<double>(samples.size());
  double mean = 0.0;
  for (const double sample : samples)
  {
    mean += sample / count;
  }
  double m2 = 0.0;
  double m3 = 0.0;
  double m4 = 0.0;
  for (const double sample : samples)
  {
    const double deviation = sample - mean;
    m2 += deviation * deviation / count;
    m3 += std::pow(deviation, 3) / count;
    m4 += std::pow(deviation, 4) / count;
  }
  const double deviation = std::sqrt(m2);
  // About 2 * 50 Hz * 2000 s independent values: standard errors 0.002 of the deviation, 0.01 of kurtosis, 0.006 of
  // skewness.
  EXPECT_NEAR(mean, 0.0, 0.01 * deviation);
  EXPECT_NEAR(deviation / rootMeanSquare(parameters.spectrum), 1.0, 0.01);
  EXPECT_NEAR(m3 / std::pow(m2, 1.5), 0.0, 0.03);
  EXPECT_NEAR(m4 / (m2 * m2), 3.0, 0.06);

  // The distribution: the largest distance to the normal one.
  std::sort(samples.begin(), samples.end());
  double distance = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const double normal = 0.5 * std::erfc(-(samples[i] - mean) / deviation / std::sqrt(2.0));
    distance = std::max(distance, std::abs(normal - static_cast<double>(i) / count));
  }
  EXPECT_LT(distance, 0.005);
  // Nothing is clipped: among so many there are some beyond 4.2 deviations.
  EXPECT_GT(std::max(-samples.front(), samples.back()), 4.2 * deviation);
}

TEST(RandomSignal, isTheSameHoweverItIsAskedFor)
{
  const auto signal = makeDriveSignal(shipNoise(60.0), sample_rate);
  expectTheSameInAnyBlocks(*signal);
  const auto again = makeDriveSignal(shipNoise(60.0), sample_rate);
  EXPECT_EQ(generate(*again, 40000, 20000), generate(*signal, 40000, 20000));
  // A longer one begins with it.
  EXPECT_EQ(generate(*makeDriveSignal(shipNoise(100.0), sample_rate), 0, 60000), generate(*signal));
}

TEST(RandomSignal, isAnotherForAnotherSeed)
{
  const std::vector<double> one = generate(*makeDriveSignal(shipNoise(200.0, 1), sample_rate));
  const std::vector<double> other = generate(*makeDriveSignal(shipNoise(200.0, 2), sample_rate));
  double both = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i)
  {
    both += one[i] * other[i];
    square += one[i] * one[i];
  }
  EXPECT_LT(std::abs(both / square), 0.05);
}

TEST(RandomSignal, keepsItsFirstValues)
{
  // Written down from the first build: the noise of a seed is not to change from version to version. Another
  // compiler's logarithm and cosine may differ in the last digits.
  const auto signal = makeDriveSignal(shipNoise(60.0), sample_rate);
  const std::vector<double> samples = generate(*signal, 30000, 3);
  EXPECT_NEAR(samples[0], -4.08727626054, 1.0e-9);
  EXPECT_NEAR(samples[1], -4.67001194477, 1.0e-9);
  EXPECT_NEAR(samples[2], -4.36874308194, 1.0e-9);
}

TEST(RandomSignal, startsSoftlyFromZero)
{
  RandomParameters parameters = shipNoise(60.0);
  parameters.soft_start = 10.0;
  const auto soft = generate(*makeDriveSignal(parameters, sample_rate));
  const auto hard = generate(*makeDriveSignal(shipNoise(60.0), sample_rate));
  EXPECT_EQ(soft[0], 0.0);
  EXPECT_NEAR(soft[5000], 0.5 * hard[5000], 1.0e-12);
  EXPECT_EQ(soft[10000], hard[10000]);
}

TEST(RandomSignal, rejectsWhatIsOutOfRange)
{
  const auto faultsOf = [](const RandomParameters& parameters, double rate = sample_rate)
  { return keysOf(findFaults(parameters, rate)); };
  EXPECT_EQ(faultsOf(shipNoise(60.0)), "");

  RandomParameters parameters = shipNoise(60.0);
  parameters.spectrum.resize(1);
  EXPECT_EQ(faultsOf(parameters), "spectrum");
  parameters = shipNoise(60.0);
  parameters.spectrum[1] = {2.0, 0.0};  // not above the one before
  parameters.spectrum[3] = {500.0, nan};
  EXPECT_EQ(faultsOf(parameters),
            "spectrum[1].frequency spectrum[1].density spectrum[3].frequency spectrum[3].density");
  parameters = shipNoise(60.0, -1);
  parameters.soft_start = 0.0;
  EXPECT_EQ(faultsOf(parameters), "seed soft_start");
  parameters.soft_start = 61.0;
  parameters.duration = 0.0;
  EXPECT_EQ(faultsOf(parameters), "seed duration");
  parameters = shipNoise(1.0e15);
  EXPECT_EQ(faultsOf(parameters), "duration");

  // What only a filter longer than the longest could resolve.
  parameters = shipNoise(60.0);
  EXPECT_EQ(faultsOf(parameters, 200000.0), "spectrum[0].frequency");
  parameters.spectrum[2] = {5.0001, 0.1};
  EXPECT_EQ(faultsOf(parameters), "spectrum[2].frequency");
  parameters = shipNoise(60.0);
  parameters.spectrum[2] = {5.01, 0.1e5};  // far enough, but 50 dB within 0.01 Hz
  EXPECT_EQ(faultsOf(parameters), "spectrum[2].density");
  parameters.spectrum[2].density = 0.1e2;  // 20 dB
  EXPECT_EQ(faultsOf(parameters), "");
}

}  // namespace
