#include <atomic>
#include <cstdlib>
#include <exception>

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "vibro_impact/ros/end_request.h"
#include "vibro_impact/ros/simulator.h"

namespace
{
/// What is waiting when the end comes is still simulated, for at most this long, s.
constexpr double longest_drain = 5.0;
}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "simulator", ros::init_options::NoSigintHandler);
  const std::atomic<bool>& stop = vibro_impact::graph::catchEndRequests();
  // Lives as long as there may be something to log: roscpp and its log end with the last handle.
  const ros::NodeHandle node;
  try
  {
    vibro_impact::graph::Simulator simulator(node, ros::NodeHandle("~"));
    ros::CallbackQueue& queue = *ros::getGlobalCallbackQueue();
    while (!stop && ros::ok())
    {
      queue.callAvailable(ros::WallDuration(0.1));
    }
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(longest_drain);
    while (ros::ok() && !queue.isEmpty() && ros::WallTime::now() < end)
    {
      queue.callOne();
    }
    simulator.finish();
  }
  catch (const std::exception& error)
  {
    ROS_FATAL_STREAM(error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
