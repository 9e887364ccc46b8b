#pragma once

#include <cstdint>

#include "vibro_impact/core/quotient.h"

namespace vibro_impact::core
{
constexpr double two_pi = 6.28318530717958647692;

/// Amplitude, from 0 to 1, after `progress` of a ramp of `length` in the same unit: half a cosine.
double softStart(double progress, double length);

/// The sine of a phase in cycles.
double sineOfCycles(double cycles);

/// A point on the time axis in samples: whole + fraction.
class SamplePosition
{
public:
  void advance(const Quotient& samples);

  /// The first sample that is not before it.
  std::uint64_t firstSample() const;

  /// How long before that sample it lies, in samples.
  double lead() const;

private:
  std::uint64_t whole_ = 0;
  double fraction_ = 0.0;
};

/// The number of samples at times from zero up to, but without, `seconds`.
std::uint64_t samplesBefore(double seconds, double sample_rate);

}  // namespace vibro_impact::core
