#pragma once

#include <limits>
#include <string>
#include <vector>

#include "parameter_faults.h"
#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/sine_band.h"

namespace vibro_impact::core
{
/// Gathers what is wrong with the parameters of a drive signal. Every check says whether the value was good.
class DriveFaults
{
public:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  static bool isPositive(double value);

  explicit DriveFaults(double sample_rate);

  double sampleRate() const
  {
    return sample_rate_;
  }

  bool check(bool good, const std::string& key, double value, const std::string& allowed);
  bool checkPositive(const std::string& key, double value, const std::string& unit);
  bool checkAmplitude(const std::string& key, double value, const std::string& unit);
  bool checkReference(double value);
  /// `value` in units of `reference` (Hz), below half the sample rate.
  bool checkFrequency(const std::string& key, double value, double reference);
  /// `most`, if it is finite, is what `name_of_most` says.
  bool checkSoftStart(double value, double most, const std::string& name_of_most);
  /// Ends and amplitude of each, at least one; not how they lie to one another.
  bool checkBands(const std::vector<SineBand>& bands);
  /// Of the whole signal.
  bool checkDuration(double seconds);

  std::vector<ParameterFault> take();

private:
  double sample_rate_;
  std::vector<ParameterFault> faults_;
};

}  // namespace vibro_impact::core
