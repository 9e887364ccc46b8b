// A sine of gliding frequency and constant acceleration.

#include <cmath>

#include "drive_phase.h"
#include "drive_signals.h"

namespace vibro_impact::core
{
namespace
{
// Linear:      f = f0 + r t,         cycles = f0 t + r t^2/2,            r = (f1 - f0)/T
// Logarithmic: f = f0 exp(r t),      cycles = f0 (exp(r t) - 1)/r,       r = ln(f1/f0)/T
class SweptSine : public DriveSignal
{
public:
  SweptSine(const SweptSineParameters& parameters, double sample_rate, std::uint64_t samples)
      : DriveSignal(sample_rate, samples),
        law_(parameters.law),
        acceleration_(parameters.acceleration),
        start_(parameters.reference_frequency * parameters.start_frequency),
        rate_(law_ == SweepLaw::linear
                  ? parameters.reference_frequency * (parameters.stop_frequency - parameters.start_frequency) /
                        parameters.duration
                  : std::log(parameters.stop_frequency / parameters.start_frequency) / parameters.duration),
        soft_start_cycles_(parameters.soft_start_cycles)
  {
  }

  double frequency(std::uint64_t sample) const override
  {
    if (sample >= samples())
    {
      return 0.0;
    }
    const double time = static_cast<double>(sample) / sampleRate();
    return law_ == SweepLaw::linear ? start_ + rate_ * time : start_ * std::exp(rate_ * time);
  }

private:
  void fill(std::uint64_t first, std::size_t count, double* acceleration) const override
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      const double time = static_cast<double>(first + i) / sampleRate();
      const double cycles =
          law_ == SweepLaw::linear ? time * (start_ + 0.5 * rate_ * time) : start_ * std::expm1(rate_ * time) / rate_;
      acceleration[i] = acceleration_ * softStart(cycles, soft_start_cycles_) * sineOfCycles(cycles);
    }
  }

  SweepLaw law_;
  double acceleration_;
  double start_;
  double rate_;
  double soft_start_cycles_;
};

}  // namespace

void findFaults(const SweptSineParameters& parameters, DriveFaults& faults)
{
  faults.checkAmplitude("acceleration", parameters.acceleration, " (m/s^2)");
  faults.checkReference(parameters.reference_frequency);
  faults.checkFrequency("start_frequency", parameters.start_frequency, parameters.reference_frequency);
  if (faults.checkFrequency("stop_frequency", parameters.stop_frequency, parameters.reference_frequency))
  {
    faults.check(parameters.stop_frequency != parameters.start_frequency, "stop_frequency", parameters.stop_frequency,
                 "another one than start_frequency");
  }
  if (faults.check(DriveFaults::isPositive(parameters.duration), "duration", parameters.duration,
                   "a finite number > 0 (s)"))
  {
    faults.checkDuration(parameters.duration);
  }
  faults.checkSoftStart(parameters.soft_start_cycles, DriveFaults::infinity, "");
}

std::unique_ptr<const DriveSignal> makeSignal(const SweptSineParameters& parameters, double sample_rate)
{
  return std::make_unique<SweptSine>(parameters, sample_rate, samplesBefore(parameters.duration, sample_rate));
}

}  // namespace vibro_impact::core
