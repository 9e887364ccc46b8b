// Samples that are there already.

#include <algorithm>
#include <cmath>
#include <limits>

#include "drive_signals.h"

namespace vibro_impact::core
{
namespace
{
// How far a sample rate may be off one over the period, relative: rounding.
constexpr double rate_tolerance = 1.0e-12;

class SampledSignal : public DriveSignal
{
public:
  SampledSignal(const SampledParameters& parameters, double sample_rate)
      : DriveSignal(sample_rate, parameters.sample_period, parameters.acceleration->size()),
        acceleration_(parameters.acceleration)
  {
  }

  double frequency(std::uint64_t sample) const override
  {
    return sample < samples() ? std::numeric_limits<double>::quiet_NaN() : 0.0;
  }

private:
  void fill(std::uint64_t first, std::size_t count, double* acceleration) const override
  {
    std::copy_n(acceleration_->begin() + static_cast<std::ptrdiff_t>(first), count, acceleration);
  }

  std::shared_ptr<const std::vector<double>> acceleration_;
};

}  // namespace

void findFaults(const SampledParameters& parameters, DriveFaults& faults)
{
  if (faults.checkPositive("sample_period", parameters.sample_period, " (s)"))
  {
    faults.check(std::abs(faults.sampleRate() * parameters.sample_period - 1.0) <= rate_tolerance, "sample_rate",
                 faults.sampleRate(), text(1.0 / parameters.sample_period) + ", one over the sample period (Hz)");
  }
  if (faults.check(parameters.acceleration && !parameters.acceleration->empty(), "acceleration", 0.0,
                   "a list of at least one sample (m/s^2)"))
  {
    const auto bad = std::find_if(parameters.acceleration->begin(), parameters.acceleration->end(),
                                  [](double value) { return !std::isfinite(value); });
    faults.check(bad == parameters.acceleration->end(), "acceleration",
                 bad == parameters.acceleration->end() ? 0.0 : *bad, "of finite samples (m/s^2)");
  }
}

std::unique_ptr<const DriveSignal> makeSignal(const SampledParameters& parameters, double sample_rate)
{
  return std::make_unique<SampledSignal>(parameters, sample_rate);
}

}  // namespace vibro_impact::core
