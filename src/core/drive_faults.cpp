#include "drive_faults.h"

#include <cmath>
#include <utility>

namespace vibro_impact::core
{
namespace
{
// Longer signals are mistakes: 2^52 samples (three thousand years at 50 kHz).
constexpr double most_samples = 4503599627370496.0;

}  // namespace

bool DriveFaults::isPositive(double value)
{
  return std::isfinite(value) && value > 0.0;
}

DriveFaults::DriveFaults(double sample_rate) : sample_rate_(sample_rate)
{
  checkPositive("sample_rate", sample_rate, " (Hz)");
}

bool DriveFaults::check(bool good, const std::string& key, double value, const std::string& allowed)
{
  if (!good)
  {
    faults_.push_back({key, text(value), allowed});
  }
  return good;
}

bool DriveFaults::checkPositive(const std::string& key, double value, const std::string& unit)
{
  return check(isPositive(value), key, value, "a finite number > 0" + unit);
}

bool DriveFaults::checkAmplitude(const std::string& key, double value, const std::string& unit)
{
  return check(std::isfinite(value) && value >= 0.0, key, value, "a finite number >= 0" + unit);
}

bool DriveFaults::checkReference(double value)
{
  return checkPositive("reference_frequency", value, " (Hz)");
}

bool DriveFaults::checkFrequency(const std::string& key, double value, double reference)
{
  std::string allowed = "a number > 0";
  double highest = infinity;
  if (isPositive(sample_rate_) && isPositive(reference))
  {
    highest = 0.5 * sample_rate_ / reference;
    allowed += " and < " + text(highest) + ", half the sample rate";
  }
  allowed += reference == 1.0 ? " (Hz)" : " (times reference_frequency)";
  return check(value > 0.0 && value < highest, key, value, allowed);
}

bool DriveFaults::checkSoftStart(double value, double most, const std::string& name_of_most)
{
  const std::string allowed = std::isfinite(most) ? "a number from 0 to " + text(most) + ", " + name_of_most
                                                  : std::string("a finite number >= 0 (cycles)");
  return check(std::isfinite(value) && value >= 0.0 && value <= most, "soft_start_cycles", value, allowed);
}

bool DriveFaults::checkBands(const std::vector<SineBand>& bands)
{
  bool good = check(!bands.empty(), "bands", 0.0, "a list of at least one band");
  for (std::size_t i = 0; i < bands.size(); ++i)
  {
    const SineBand& band = bands[i];
    const std::string path = "bands[" + std::to_string(i) + "].";
    good &= checkFrequency(path + "from", band.from, 1.0);
    good &= checkFrequency(path + "to", band.to, 1.0);
    switch (band.amplitude.quantity)
    {
      case MotionQuantity::displacement:
        good &= checkAmplitude(path + "displacement", band.amplitude.value, " (m)");
        break;
      case MotionQuantity::velocity:
        good &= checkAmplitude(path + "velocity", band.amplitude.value, " (m/s)");
        break;
      case MotionQuantity::acceleration:
        good &= checkAmplitude(path + "acceleration", band.amplitude.value, " (m/s^2)");
        break;
    }
  }
  return good;
}

bool DriveFaults::checkDuration(double seconds)
{
  return !isPositive(sample_rate_) || check(seconds * sample_rate_ <= most_samples, "duration", seconds,
                                            "at most " + text(most_samples / sample_rate_) + " (s)");
}

std::vector<ParameterFault> DriveFaults::take()
{
  return std::move(faults_);
}

}  // namespace vibro_impact::core
