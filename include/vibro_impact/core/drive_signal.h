#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/random_parameters.h"
#include "vibro_impact/core/sampled_parameters.h"
#include "vibro_impact/core/shock_parameters.h"
#include "vibro_impact/core/sine_parameters.h"
#include "vibro_impact/core/sweep_parameters.h"

namespace vibro_impact::core
{
using DriveParameters = std::variant<SineParameters, SteppedSineParameters, SineDwellParameters, SweptSineParameters,
                                     BandedSweepParameters, RandomParameters, ShockParameters, SampledParameters>;

/// What the frequencies of a signal are given in, Hz; 1 where that is no parameter of it.
double referenceFrequency(const DriveParameters& parameters);

/// Every value that is out of range for a signal of `sample_rate` (Hz), with the members' names as keys, such as
/// "bands[1].to"; the value of an amplitude is called by its quantity. All frequencies must lie below half the sample
/// rate. Empty if a signal can be made.
std::vector<ParameterFault> findFaults(const DriveParameters& parameters, double sample_rate);

/// A base acceleration of finite length, sampled at constant rate. Immutable.
///
/// Any sample is had at any time: the samples do not depend on how they are asked for. Every signal but a sampled one
/// starts at zero. One of sines starts rising, with continuous phase from its first sample to its last (except that it
/// stands still at phase zero during a rest); the phase of constant frequencies is exact to 1e-12 cycles after any
/// number of them, that of a sweep to a few 1e-16 of its cycles; a step lasts its whole number of cycles exactly,
/// wherever its end falls between two samples.
class DriveSignal
{
public:
  virtual ~DriveSignal() = default;

  /// Samples per second.
  double sampleRate() const
  {
    return sample_rate_;
  }

  /// s: one over the sample rate, or what sampled parameters say.
  double samplePeriod() const
  {
    return sample_period_;
  }

  /// Number of samples: those at times from zero up to, but without, the end of the signal.
  std::uint64_t samples() const
  {
    return samples_;
  }

  /// Writes the acceleration (m/s^2) of `count` samples from `first` on. Throws std::out_of_range beyond the last
  /// sample.
  void generate(std::uint64_t first, std::size_t count, double* acceleration) const;

  /// Instantaneous frequency at a sample, Hz; 0 during a rest and beyond the end, NaN where the signal has none.
  virtual double frequency(std::uint64_t sample) const = 0;

protected:
  DriveSignal(double sample_rate, std::uint64_t samples)
      : sample_rate_(sample_rate), sample_period_(1.0 / sample_rate), samples_(samples)
  {
  }
  DriveSignal(double sample_rate, double sample_period, std::uint64_t samples)
      : sample_rate_(sample_rate), sample_period_(sample_period), samples_(samples)
  {
  }

private:
  virtual void fill(std::uint64_t first, std::size_t count, double* acceleration) const = 0;

  double sample_rate_;
  double sample_period_;
  std::uint64_t samples_;
};

/// Throws std::invalid_argument if findFaults() finds any; the message names each parameter, its value and what is
/// allowed.
std::unique_ptr<const DriveSignal> makeDriveSignal(const DriveParameters& parameters, double sample_rate);

}  // namespace vibro_impact::core
