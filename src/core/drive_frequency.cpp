#include "vibro_impact/core/drive_frequency.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace vibro_impact::core
{
namespace
{
constexpr std::ptrdiff_t fewest_cycles = 3;
/// Statistics are asked for an instant that may lie some blocks back.
constexpr std::size_t kept = 4096;
}  // namespace

void DriveFrequency::add(const SampleBlock& acceleration)
{
  if (acceleration.seq != next_seq_)
  {
    crossings_.clear();
    last_ = 0.0;  // the first sample is no crossing
  }
  next_seq_ = acceleration.seq + acceleration.count;
  for (std::size_t i = 0; i < acceleration.count; ++i)
  {
    const double value = acceleration.values[i];
    if (last_ < 0.0 && value >= 0.0)
    {
      const double samples = static_cast<double>(i) - value / (value - last_);
      crossings_.push_back(acceleration.stamp + nanoseconds(samples * acceleration.sample_period));
    }
    last_ = value;
  }
  while (crossings_.size() > kept)
  {
    crossings_.pop_front();
  }
}

double DriveFrequency::at(StreamTime time) const
{
  const auto end = std::upper_bound(crossings_.begin(), crossings_.end(), time);
  const auto all = std::distance(crossings_.begin(), end) - 1;
  const auto taken = std::min(all, static_cast<std::ptrdiff_t>(cycles));
  if (taken < fewest_cycles)
  {
    return 0.0;
  }
  const auto first = end - 1 - taken;
  const double mean = seconds(*(end - 1) - *first) / static_cast<double>(taken);
  for (auto crossing = first; crossing != end - 1; ++crossing)
  {
    if (std::abs(seconds(*(crossing + 1) - *crossing) - mean) > steadiness * mean)
    {
      return 0.0;
    }
  }
  return 1.0 / mean;
}

}  // namespace vibro_impact::core
