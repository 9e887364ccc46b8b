#include "vibro_impact/ros/sample_clock.h"

#include <algorithm>
#include <cmath>

namespace vibro_impact::graph
{
void SampleClock::start(std::uint64_t seq, Stamp stamp, double sample_period)
{
  sample_period_ = sample_period;
  present_ = {seq, stamp};
  earlier_ = present_;
}

void SampleClock::follow(std::uint64_t seq, Stamp stamp, bool keep_anchor)
{
  if (!keep_anchor)
  {
    earlier_ = present_;
  }
  if (std::abs(deviation(seq, stamp)) > 0.5 * sample_period_)
  {
    present_ = {seq, stamp};
  }
}

Stamp SampleClock::at(std::uint64_t seq) const
{
  return date(seq >= present_.seq ? present_ : earlier_, seq);
}

double SampleClock::deviation(std::uint64_t seq, Stamp stamp) const
{
  // A double counts the samples between any two numbers to well below a sample for longer than a stream lasts, and an
  // absurd number stays absurd.
  const double samples =
      seq >= present_.seq ? static_cast<double>(seq - present_.seq) : -static_cast<double>(present_.seq - seq);
  return 1.0e-9 * static_cast<double>(stamp - present_.stamp) - samples * sample_period_;
}

Stamp SampleClock::date(const Anchor& anchor, std::uint64_t seq) const
{
  const double samples =
      seq >= anchor.seq ? static_cast<double>(seq - anchor.seq) : -static_cast<double>(anchor.seq - seq);
  return std::max<Stamp>(0, anchor.stamp + std::llround(samples * sample_period_ * 1.0e9));
}

}  // namespace vibro_impact::graph
