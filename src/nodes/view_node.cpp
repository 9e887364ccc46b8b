#include <cstdlib>
#include <exception>

#include <ros/ros.h>

#include "vibro_impact/ros/view.h"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "view");
  const ros::NodeHandle node;
  try
  {
    const vibro_impact::graph::View view(node, ros::NodeHandle("~"));
    ros::spin();
  }
  catch (const std::exception& error)
  {
    ROS_FATAL_STREAM(error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
