// Pulses of acceleration.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "drive_phase.h"
#include "drive_signals.h"

namespace vibro_impact::core
{
namespace
{
constexpr std::int64_t most_repetitions = 1'000'000;

// With fewer a pulse has lost its shape.
constexpr double fewest_samples = 10.0;

// A sample that is beyond the end of a pulse by no more than rounding is its last one, in samples.
constexpr double end_tolerance = 1.0e-6;

double wholeDuration(const ShockParameters& parameters)
{
  return parameters.before + static_cast<double>(parameters.repetitions - 1) * parameters.interval +
         parameters.duration + parameters.after;
}

// The last sample of a pulse that begins with sample zero: at its end, or before it.
double lastSample(const ShockParameters& parameters, double sample_rate)
{
  return std::floor(parameters.duration * sample_rate + end_tolerance);
}

// What comes after the last pulse may be nothing; but the acceleration comes back to zero in any case.
std::uint64_t sampleCount(const ShockParameters& parameters, double sample_rate)
{
  ShockParameters pulses = parameters;
  pulses.after = 0.0;
  const double end = wholeDuration(pulses);
  const std::uint64_t first_not_before = samplesBefore(end, sample_rate);
  const bool at_peak = parameters.shape == ShockShape::terminal_peak_sawtooth &&
                       static_cast<double>(first_not_before) <= end * sample_rate + end_tolerance;
  return std::max(samplesBefore(wholeDuration(parameters), sample_rate), first_not_before + (at_peak ? 2 : 1));
}

class Shock : public DriveSignal
{
public:
  Shock(const ShockParameters& parameters, double sample_rate, std::uint64_t samples)
      : DriveSignal(sample_rate, samples), parameters_(parameters)
  {
  }

  double frequency(std::uint64_t sample) const override
  {
    return sample < samples() ? std::numeric_limits<double>::quiet_NaN() : 0.0;
  }

private:
  void fill(std::uint64_t first, std::size_t count, double* acceleration) const override
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      acceleration[i] = at(static_cast<double>(first + i) / sampleRate());
    }
  }

  double at(double time) const
  {
    const double tolerance = end_tolerance / sampleRate();
    double since = time - parameters_.before;
    if (parameters_.repetitions > 1)
    {
      const double pulse = std::floor((since + tolerance) / parameters_.interval);
      // None before the first, however long that is waited for, and none after the last.
      since -= parameters_.interval * std::clamp(pulse, 0.0, static_cast<double>(parameters_.repetitions - 1));
    }
    if (since <= 0.0 || since > parameters_.duration + tolerance)
    {
      return 0.0;
    }
    const double share = std::fmin(since / parameters_.duration, 1.0);
    return parameters_.peak * (parameters_.shape == ShockShape::half_sine ? std::sin(0.5 * two_pi * share) : share);
  }

  ShockParameters parameters_;
};

}  // namespace

double velocityChange(const ShockParameters& parameters)
{
  const double area = parameters.peak * parameters.duration;
  return parameters.shape == ShockShape::half_sine ? 4.0 / two_pi * area : 0.5 * area;
}

double velocityChange(const ShockParameters& parameters, double sample_rate)
{
  // The sum over the samples of a pulse that begins with one, since all beyond it are zero.
  const double samples = parameters.duration * sample_rate;
  const double last = lastSample(parameters, sample_rate);
  if (parameters.shape == ShockShape::terminal_peak_sawtooth)
  {
    return parameters.peak * 0.5 * last * (last + 1.0) / (samples * sample_rate);
  }
  const double half_step = 0.25 * two_pi / samples;
  return parameters.peak * std::sin(last * half_step) * std::sin((last + 1.0) * half_step) /
         (std::sin(half_step) * sample_rate);
}

void findFaults(const ShockParameters& parameters, DriveFaults& faults)
{
  faults.check(std::isfinite(parameters.peak) && parameters.peak != 0.0, "peak", parameters.peak,
               "a finite number other than 0 (m/s^2)");
  const double shortest = fewest_samples / faults.sampleRate();
  bool good = faults.check(
      std::isfinite(parameters.duration) && parameters.duration * faults.sampleRate() >= fewest_samples - end_tolerance,
      "duration", parameters.duration, "a finite number of at least " + text(shortest) + ", ten samples (s)");
  good &= faults.checkAmplitude("before", parameters.before, " (s)");
  good &= faults.checkAmplitude("after", parameters.after, " (s)");
  good &= faults.check(parameters.repetitions >= 1 && parameters.repetitions <= most_repetitions, "repetitions",
                       static_cast<double>(parameters.repetitions),
                       "a whole number from 1 to " + std::to_string(most_repetitions));
  if (good && parameters.repetitions > 1)
  {
    good = faults.check(std::isfinite(parameters.interval) && parameters.interval > parameters.duration, "interval",
                        parameters.interval,
                        "a finite number > " + text(parameters.duration) + ", the duration of a pulse (s)");
  }
  if (good)
  {
    faults.checkDuration(wholeDuration(parameters));
  }
}

std::unique_ptr<const DriveSignal> makeSignal(const ShockParameters& parameters, double sample_rate)
{
  return std::make_unique<Shock>(parameters, sample_rate, sampleCount(parameters, sample_rate));
}

}  // namespace vibro_impact::core
