// Gaussian noise of a given power spectral density.

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <mutex>
#include <string>
#include <utility>

#include <unsupported/Eigen/FFT>

#include "drive_phase.h"
#include "drive_signals.h"
#include "gaussian_noise.h"

namespace vibro_impact::core
{
namespace
{
// Lines of the filter's resolution below the lowest frequency, and between two break points.
constexpr double lines_to_lowest = 16.0;
constexpr double lines_between_points = 4.0;

// How much the density may change from line to line: Hann's window, a weighted mean of three lines, then takes half a
// decibel off a corner.
constexpr double decibels_per_line = 2.0;

// Taps of the longest filter, a power of two: a second of it takes a tenth of one to compute.
constexpr std::size_t most_taps = std::size_t{1} << 20;

// The exponent of the density's power law between two break points.
double slope(const SpectrumPoint& from, const SpectrumPoint& to)
{
  return std::log(to.density / from.density) / std::log(to.frequency / from.frequency);
}

// Lines so far apart, in Hz, that the density changes by decibels_per_line from one to the next; at the lower break
// point, where a power law is steepest. Infinite for a density that is constant.
double lineDistance(const SpectrumPoint& from, const SpectrumPoint& to)
{
  return 0.1 * std::log(10.0) * decibels_per_line * from.frequency / std::abs(slope(from, to));
}

std::size_t tapCount(const std::vector<SpectrumPoint>& spectrum, double sample_rate)
{
  double resolution = spectrum.front().frequency / lines_to_lowest;
  for (std::size_t i = 1; i < spectrum.size(); ++i)
  {
    resolution = std::min(resolution, (spectrum[i].frequency - spectrum[i - 1].frequency) / lines_between_points);
    resolution = std::min(resolution, lineDistance(spectrum[i - 1], spectrum[i]));
  }
  std::size_t count = 2;
  while (static_cast<double>(count) * resolution < sample_rate && count < 2 * most_taps)
  {
    count *= 2;
  }
  return count;
}

// Filters white noise block by block, the blocks at fixed places of the time axis, by the overlap-save method: a block
// follows from the noise of its own and of the block before.
class FilteredNoise
{
public:
  FilteredNoise(const std::vector<SpectrumPoint>& spectrum, double sample_rate, std::uint64_t seed)
      : noise_(seed), length_(tapCount(spectrum, sample_rate)), input_(2 * length_), output_(2 * length_)
  {
    fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
    std::vector<double> taps = design(spectrum, sample_rate);
    taps.resize(2 * length_, 0.0);
    fft_.fwd(response_, taps);
  }

  void generate(std::uint64_t first, std::size_t count, double* values)
  {
    while (count > 0)
    {
      compute(first / length_);
      const auto offset = static_cast<std::size_t>(first % length_);
      const std::size_t here = std::min(count, length_ - offset);
      values = std::copy_n(output_.begin() + static_cast<std::ptrdiff_t>(length_ + offset), here, values);
      first += here;
      count -= here;
    }
  }

private:
  // By sampling of the frequency response: unit white noise has the density 2/rate, so that the filter's gain is
  // sqrt(S rate/2). The window in time (Hann's) takes a weighted mean of three neighbouring lines; that the first and
  // last density go on for two lines beyond their break points makes it exact there.
  std::vector<double> design(const std::vector<SpectrumPoint>& spectrum, double sample_rate)
  {
    const double resolution = sample_rate / static_cast<double>(length_);
    const double lowest = spectrum.front().frequency;
    const double highest = spectrum.back().frequency;
    std::vector<std::complex<double>> gain(length_ / 2 + 1);
    for (std::size_t i = 0; i < gain.size(); ++i)
    {
      const double frequency = resolution * static_cast<double>(i);
      if (frequency > lowest - 2.0 * resolution && frequency < highest + 2.0 * resolution)
      {
        gain[i] = std::sqrt(0.5 * sample_rate * spectralDensity(spectrum, std::clamp(frequency, lowest, highest)));
      }
    }
    std::vector<double> circular;
    fft_.inv(circular, gain, static_cast<Eigen::Index>(length_));
    std::vector<double> taps(length_);
    for (std::size_t i = 0; i < length_; ++i)
    {
      const double share = static_cast<double>(i) / static_cast<double>(length_);
      taps[i] = softStart(std::min(share, 1.0 - share), 0.5) * circular[(i + length_ / 2) % length_];
    }
    return taps;
  }

  void compute(std::uint64_t block)
  {
    if (block_ == block)
    {
      return;
    }
    // Numbers of the noise count from the block before the first one.
    noise_.generate(block * length_, input_.size(), input_.data());
    fft_.fwd(spectrum_, input_);
    for (std::size_t i = 0; i < spectrum_.size(); ++i)
    {
      spectrum_[i] *= response_[i];
    }
    fft_.inv(output_, spectrum_, static_cast<Eigen::Index>(output_.size()));
    block_ = block;
  }

  GaussianNoise noise_;
  std::size_t length_;  // of a block, and taps of the filter
  Eigen::FFT<double> fft_;
  std::vector<std::complex<double>> response_;
  std::vector<std::complex<double>> spectrum_;
  std::vector<double> input_;
  std::vector<double> output_;
  std::uint64_t block_ = std::numeric_limits<std::uint64_t>::max();  // that is in output_
};

class RandomSignal : public DriveSignal
{
public:
  RandomSignal(const RandomParameters& parameters, double sample_rate)
      : DriveSignal(sample_rate, samplesBefore(parameters.duration, sample_rate)),
        soft_start_(parameters.soft_start),
        noise_(parameters.spectrum, sample_rate, static_cast<std::uint64_t>(parameters.seed))
  {
  }

  double frequency(std::uint64_t sample) const override
  {
    return sample < samples() ? std::numeric_limits<double>::quiet_NaN() : 0.0;
  }

private:
  void fill(std::uint64_t first, std::size_t count, double* acceleration) const override
  {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      noise_.generate(first, count, acceleration);
    }
    for (std::size_t i = 0; i < count; ++i)
    {
      acceleration[i] *= softStart(static_cast<double>(first + i) / sampleRate(), soft_start_);
    }
  }

  double soft_start_;
  // Keeps the block that it computed last, which the next samples are likely to come from.
  mutable std::mutex mutex_;
  mutable FilteredNoise noise_;
};

bool checkSpectrum(const std::vector<SpectrumPoint>& spectrum, DriveFaults& faults)
{
  bool good = faults.check(spectrum.size() >= 2, "spectrum", static_cast<double>(spectrum.size()),
                           "a list of at least 2 break points");
  for (std::size_t i = 0; i < spectrum.size(); ++i)
  {
    const std::string path = "spectrum[" + std::to_string(i) + "].";
    const bool positive = faults.checkFrequency(path + "frequency", spectrum[i].frequency, 1.0);
    good &= positive;
    if (positive && i > 0)
    {
      good &= faults.check(spectrum[i].frequency > spectrum[i - 1].frequency, path + "frequency", spectrum[i].frequency,
                           "above " + text(spectrum[i - 1].frequency) + ", that of the break point before it (Hz)");
    }
    good &= faults.checkPositive(path + "density", spectrum[i].density, " ((m/s^2)^2/Hz)");
  }
  if (!good || tapCount(spectrum, faults.sampleRate()) <= most_taps)
  {
    return good;
  }
  const double finest = faults.sampleRate() / static_cast<double>(most_taps);
  faults.check(spectrum.front().frequency >= lines_to_lowest * finest, "spectrum[0].frequency",
               spectrum.front().frequency,
               "at least " + text(lines_to_lowest * finest, 6) + " at this sample rate (Hz)");
  for (std::size_t i = 1; i < spectrum.size(); ++i)
  {
    const double least = spectrum[i - 1].frequency + lines_between_points * finest;
    faults.check(spectrum[i].frequency >= least, "spectrum[" + std::to_string(i) + "].frequency", spectrum[i].frequency,
                 "at least " + text(least, 9) + " at this sample rate (Hz)");
    const SpectrumPoint& from = spectrum[i - 1];
    const double distance = lineDistance(from, spectrum[i]);
    if (distance < finest)
    {
      const double most = std::exp(distance / finest * std::abs(std::log(spectrum[i].density / from.density)));
      faults.check(false, "spectrum[" + std::to_string(i) + "].density", spectrum[i].density,
                   "from " + text(from.density / most, 6) + " to " + text(from.density * most, 6) +
                       " at this sample rate ((m/s^2)^2/Hz)");
    }
  }
  return false;
}

}  // namespace

double spectralDensity(const std::vector<SpectrumPoint>& spectrum, double frequency)
{
  const auto above = std::find_if(spectrum.begin(), spectrum.end(),
                                  [frequency](const SpectrumPoint& point) { return point.frequency >= frequency; });
  if (above == spectrum.end() || (above == spectrum.begin() && above->frequency > frequency))
  {
    return 0.0;
  }
  if (above == spectrum.begin())
  {
    return above->density;
  }
  const auto below = above - 1;
  return below->density * std::pow(frequency / below->frequency, slope(*below, *above));
}

double rootMeanSquare(const std::vector<SpectrumPoint>& spectrum)
{
  double square = 0.0;
  for (std::size_t i = 1; i < spectrum.size(); ++i)
  {
    const SpectrumPoint& from = spectrum[i - 1];
    const SpectrumPoint& to = spectrum[i];
    // The integral of S0 (f/f0)^m, written so that m = -1 is no special case: S0 f0 L (e^x - 1)/x with x = (m + 1) L.
    const double octave = std::log(to.frequency / from.frequency);
    const double x = (slope(from, to) + 1.0) * octave;
    square += from.density * from.frequency * octave * (std::abs(x) > 1.0e-12 ? std::expm1(x) / x : 1.0);
  }
  return std::sqrt(square);
}

void findFaults(const RandomParameters& parameters, DriveFaults& faults)
{
  checkSpectrum(parameters.spectrum, faults);
  faults.check(parameters.seed >= 0, "seed", static_cast<double>(parameters.seed), "a whole number >= 0");
  if (faults.checkPositive("duration", parameters.duration, " (s)"))
  {
    faults.checkDuration(parameters.duration);
    faults.check(parameters.soft_start > 0.0 && parameters.soft_start <= parameters.duration, "soft_start",
                 parameters.soft_start, "a number > 0 and <= " + text(parameters.duration) + ", the duration (s)");
  }
}

std::unique_ptr<const DriveSignal> makeSignal(const RandomParameters& parameters, double sample_rate)
{
  return std::make_unique<RandomSignal>(parameters, sample_rate);
}

}  // namespace vibro_impact::core
