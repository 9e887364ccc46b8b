#pragma once

#include <cstddef>
#include <cstdint>

#include "vibro_impact/core/stream_time.h"

namespace vibro_impact::core
{
/// Stamps resolve a nanosecond, so that a shorter period cannot be dated, s.
constexpr double min_sample_period = 1.0e-9;
/// s
constexpr double max_sample_period = 1.0e3;
/// Where the stamps of a stream end, s: 2^32 - 1.
constexpr double end_of_time = 4294967295.0;

/// Equally spaced samples that somebody else holds.
struct SampleBlock
{
  std::uint64_t seq = 0;           ///< number of the first sample since the stream began
  StreamTime stamp = 0;            ///< time of the first sample
  double sample_period = 0.0;      ///< s
  const double* values = nullptr;  ///< SI units of the quantity
  std::size_t count = 0;
};

}  // namespace vibro_impact::core
