#pragma once

#include <memory>
#include <vector>

namespace vibro_impact::core
{
/// Samples that are there already, from a measurement or another program: played as they are.
struct SampledParameters
{
  std::shared_ptr<const std::vector<double>> acceleration;  ///< m/s^2, finite, at least one
  double sample_period = 0.0;                               ///< s, > 0; one over the sample rate
};

}  // namespace vibro_impact::core
