#include <cstdlib>
#include <exception>

#include <ros/ros.h>

#include "vibro_impact/ros/monitor.h"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "monitor");
  const ros::NodeHandle node;
  try
  {
    const vibro_impact::graph::Monitor monitor(node, ros::NodeHandle("~"));
    ros::spin();
  }
  catch (const std::exception& error)
  {
    ROS_FATAL_STREAM(error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
