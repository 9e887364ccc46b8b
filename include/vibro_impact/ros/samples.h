#pragma once

#include <cstdint>
#include <vector>

namespace vibro_impact::graph
{
/// Nanoseconds since the epoch of ros::Time, whose whole range fits.
using Stamp = std::int64_t;

/// Equally spaced samples of one quantity: a block of a stream, as every block message carries it.
struct Samples
{
  Stamp stamp = 0;             ///< time of the first sample, ns
  std::uint64_t seq = 0;       ///< number of the first sample since the stream began
  double sample_period = 0.0;  ///< s
  std::vector<double> values;  ///< SI units of the quantity
};

}  // namespace vibro_impact::graph
