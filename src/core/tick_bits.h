#pragma once

#include <algorithm>
#include <cstdint>

namespace vibro_impact::core
{
/// The tabulated factors are powers of two ticks, and a step costs a product a mode for every bit of its ticks.
inline int bitLength(std::int64_t ticks)
{
  return ticks == 0 ? 0 : 64 - __builtin_clzll(static_cast<unsigned long long>(ticks));
}

inline std::int64_t highestBits(std::int64_t ticks, int bits)
{
  if (ticks < 0)
  {
    return -highestBits(-ticks, bits);
  }
  const int shift = std::max(0, bitLength(ticks) - bits);
  return (ticks >> shift) << shift;
}

}  // namespace vibro_impact::core
