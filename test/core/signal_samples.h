#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "vibro_impact/core/drive_signal.h"

namespace vibro_impact::core
{
inline std::vector<double> generate(const DriveSignal& signal, std::uint64_t first, std::size_t count)
{
  std::vector<double> samples(count);
  signal.generate(first, count, samples.data());
  return samples;
}

inline std::vector<double> generate(const DriveSignal& signal)
{
  return generate(signal, 0, signal.samples());
}

inline std::string keysOf(const std::vector<ParameterFault>& faults)
{
  std::string keys;
  for (const ParameterFault& fault : faults)
  {
    keys += (keys.empty() ? "" : " ") + fault.key;
  }
  return keys;
}

/// Expects the same samples, bit for bit, however they are asked for: in blocks of any size, in any order.
inline void expectTheSameInAnyBlocks(const DriveSignal& signal)
{
  const std::vector<double> whole = generate(signal);
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i)
  {
    const auto first = random() % whole.size();
    const auto count = std::min<std::size_t>(1 + random() % 3000, whole.size() - first);
    const std::vector<double> part = generate(signal, first, count);
    for (std::size_t j = 0; j < count; ++j)
    {
      ASSERT_EQ(part[j], whole[first + j]) << first << " " << count << " " << j;
    }
  }
}

}  // namespace vibro_impact::core
