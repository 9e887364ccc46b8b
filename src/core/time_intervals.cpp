#include "vibro_impact/core/time_intervals.h"

#include <algorithm>

namespace vibro_impact::core
{
void TimeIntervals::add(StreamTime from, StreamTime to)
{
  if (!intervals_.empty())
  {
    from = std::max(from, intervals_.back().to);
  }
  if (from >= to)
  {
    return;
  }
  if (!intervals_.empty() && from == intervals_.back().to)
  {
    intervals_.back().to = to;
    return;
  }
  intervals_.push_back({from, to});
}

StreamTime TimeIntervals::covered(StreamTime from, StreamTime to) const
{
  StreamTime sum = 0;
  // The last ones are asked for most.
  for (auto interval = intervals_.rbegin(); interval != intervals_.rend() && interval->to > from; ++interval)
  {
    sum += std::max<StreamTime>(0, std::min(interval->to, to) - std::max(interval->from, from));
  }
  return sum;
}

void TimeIntervals::forget(StreamTime time)
{
  while (!intervals_.empty() && intervals_.front().to <= time)
  {
    intervals_.pop_front();
  }
}

}  // namespace vibro_impact::core
