#include "vibro_impact/ros/extremes.h"

#include <cmath>

namespace vibro_impact::graph
{
ExtremesHold::ExtremesHold(double rate) : rate_(rate)
{
}

const std::vector<Extremes>& ExtremesHold::take(const Samples& gap, const Samples& force)
{
  ended_.clear();
  const double stretch = std::round(1.0 / (rate_ * gap.sample_period));
  for (std::size_t i = 0; i < gap.values.size(); ++i)
  {
    if (taken_ == 0 || force.values[i] > open_.force)
    {
      open_.force = force.values[i];
      open_.stamp = force.stamp + std::llround(static_cast<double>(i) * force.sample_period * 1.0e9);
    }
    if (taken_ == 0 || gap.values[i] < open_.gap)
    {
      open_.gap = gap.values[i];
    }
    ++taken_;
    if (static_cast<double>(taken_) >= stretch)
    {
      ended_.push_back(open_);
      taken_ = 0;
    }
  }
  return ended_;
}

}  // namespace vibro_impact::graph
