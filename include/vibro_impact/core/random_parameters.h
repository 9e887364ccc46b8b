#pragma once

#include <cstdint>
#include <vector>

namespace vibro_impact::core
{
/// A break point of a power spectral density.
struct SpectrumPoint
{
  double frequency = 0.0;  ///< Hz, > 0
  double density = 0.0;    ///< one-sided, of the acceleration, (m/s^2)^2/Hz, > 0
};

/// Stationary Gaussian noise of a power spectral density that is a straight line in log-log scales from one break point
/// to the next, and nothing beyond the first and the last.
///
/// White noise goes through a filter whose response has the root of the spectrum, at a resolution that is at least
/// sixteen times finer than the lowest frequency and four times finer than the distance of two break points, and so
/// fine that the density changes by at most 2 dB from line to line. From the first break point to the last the spectrum
/// is met within 1 dB; within three lines of the resolution beyond them it falls to nothing. No value is clipped.
struct RandomParameters
{
  std::vector<SpectrumPoint> spectrum;  ///< by ascending frequency, at least two
  double duration = 0.0;                ///< s, > 0
  std::int64_t seed = 1;                ///< each whole number >= 0 gives another noise
  double soft_start = 1.0;              ///< cosine ramp from the signal's start, s, > 0 and <= duration
};

/// The density at a frequency (Hz), (m/s^2)^2/Hz; 0 outside of the break points. Needs good parameters.
double spectralDensity(const std::vector<SpectrumPoint>& spectrum, double frequency);

/// Root mean square of the acceleration, m/s^2: the root of the integral of the density.
double rootMeanSquare(const std::vector<SpectrumPoint>& spectrum);

}  // namespace vibro_impact::core
