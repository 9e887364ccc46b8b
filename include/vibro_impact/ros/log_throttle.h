#pragma once

#include <optional>

#include <ros/time.h>

namespace vibro_impact::graph
{
/// Lets a line through at most once a second. By the wall clock: roscpp's own throttle follows ros::Time, which stands
/// still while a bag that gives the time is paused, and at its beginning lets nothing through at all.
class LogThrottle
{
public:
  /// Whether a line may be written now; then it counts as written.
  bool due()
  {
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (last_ && now - *last_ < ros::WallDuration(1.0))
    {
      return false;
    }
    last_ = now;
    return true;
  }

private:
  std::optional<ros::SteadyTime> last_;
};

}  // namespace vibro_impact::graph
