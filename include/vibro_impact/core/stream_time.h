#pragma once

#include <cmath>
#include <cstdint>

namespace vibro_impact::core
{
/// Nanoseconds on the axis of a stream's stamps. A double could not tell the samples of an epoch apart.
using StreamTime = std::int64_t;

/// `seconds` to the nearest nanosecond.
inline StreamTime nanoseconds(double seconds)
{
  return std::llround(seconds * 1.0e9);
}

inline double seconds(StreamTime nanoseconds)
{
  return 1.0e-9 * static_cast<double>(nanoseconds);
}

}  // namespace vibro_impact::core
