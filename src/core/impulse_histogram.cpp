#include "vibro_impact/core/impulse_histogram.h"

#include <algorithm>
#include <cmath>

namespace vibro_impact::core
{
ImpulseHistogram::ImpulseHistogram(double from, double to, std::size_t classes) : counts_(classes + 2, 0)
{
  edges_.reserve(classes + 1);
  for (std::size_t i = 0; i <= classes; ++i)
  {
    const double share = static_cast<double>(i) / static_cast<double>(classes);
    edges_.push_back(from * std::pow(to / from, share));
  }
  edges_.back() = to;
}

void ImpulseHistogram::clear()
{
  std::fill(counts_.begin(), counts_.end(), 0);
}

void ImpulseHistogram::add(double impulse)
{
  ++counts_[static_cast<std::size_t>(std::upper_bound(edges_.begin(), edges_.end(), impulse) - edges_.begin())];
}

}  // namespace vibro_impact::core
