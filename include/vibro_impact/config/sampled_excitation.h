#pragma once

#include <istream>
#include <string>
#include <vector>

namespace vibro_impact::config
{
/// A base acceleration in equally spaced samples.
struct SampledExcitation
{
  double start = 0.0;                ///< time of the first sample, s
  double sample_period = 0.0;        ///< s
  std::vector<double> acceleration;  ///< m/s^2
};

/// Reads comma-separated text with the columns `time` (s) and `acceleration` (m/s^2); further ones are ignored. Times
/// may be rounded: each step, and each time, may be off the equal one by a twentieth of a step. The period is the
/// shortest decimal number that leads from the first time to the last. Throws Error, with file, line and column, for
/// what is not such a table, a number that is not finite, unequal steps, and less than two samples.
SampledExcitation readExcitation(const std::string& path);
/// The same of an open file that messages call `path`.
SampledExcitation readExcitation(std::istream& file, const std::string& path);

}  // namespace vibro_impact::config
