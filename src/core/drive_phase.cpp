#include "drive_phase.h"

#include <cmath>

namespace vibro_impact::core
{
namespace
{
// An end that is missed by no more than rounding is met, in samples.
constexpr double sample_tolerance = 1.0e-9;

}  // namespace

double softStart(double progress, double length)
{
  return progress < length ? 0.5 - 0.5 * std::cos(0.5 * two_pi * progress / length) : 1.0;
}

double sineOfCycles(double cycles)
{
  return std::sin(two_pi * (cycles - std::floor(cycles)));
}

void SamplePosition::advance(const Quotient& samples)
{
  whole_ += samples.whole;
  fraction_ += samples.fraction;
  if (fraction_ >= 1.0)
  {
    ++whole_;
    fraction_ -= 1.0;
  }
}

std::uint64_t SamplePosition::firstSample() const
{
  return fraction_ > sample_tolerance ? whole_ + 1 : whole_;
}

double SamplePosition::lead() const
{
  return fraction_ > sample_tolerance ? 1.0 - fraction_ : -fraction_;
}

std::uint64_t samplesBefore(double seconds, double sample_rate)
{
  SamplePosition end;
  end.advance(divide(seconds * sample_rate, 1.0));
  return end.firstSample();
}

}  // namespace vibro_impact::core
