#pragma once

#include <functional>

#include <ros/ros.h>

namespace vibro_impact
{
/// Longer than anything takes on a busy machine, s.
constexpr double patience = 30.0;

/// Serves callbacks until the condition holds; false if it does not in time.
inline bool spinUntil(const std::function<bool()>& condition)
{
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(patience);
  while (!condition())
  {
    if (!ros::ok() || ros::WallTime::now() > end)
    {
      return false;
    }
    ros::spinOnce();
    ros::WallDuration(0.001).sleep();
  }
  return true;
}

}  // namespace vibro_impact
