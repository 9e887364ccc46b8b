#include "vibro_impact/core/alarm.h"

namespace vibro_impact::core
{
bool Alarm::update(StreamTime time, double value)
{
  if (!beyond(value))
  {
    beyond_since_.reset();
    return false;
  }
  if (!beyond_since_ || time < *beyond_since_)
  {
    beyond_since_ = time;
  }
  if (time - *beyond_since_ < (active_ ? limits_.off_delay : limits_.on_delay))
  {
    return false;
  }
  active_ = !active_;
  beyond_since_.reset();
  return true;
}

bool Alarm::beyond(double value) const
{
  const double limit = active_ ? limits_.clear_at : limits_.raise_at;
  const bool upwards = (limits_.raise_at > limits_.clear_at) != active_;
  return upwards ? value > limit : value < limit;
}

}  // namespace vibro_impact::core
