#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include <ros/ros.h>

#include "vibro_impact/ros/end_request.h"
#include "vibro_impact/ros/shaker.h"

int main(int argc, char** argv)
{
  // Progress is for now, also where the output goes through a pipe.
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  ros::init(argc, argv, "shaker", ros::init_options::NoSigintHandler);
  const std::atomic<bool>& stop = vibro_impact::graph::catchEndRequests();
  // With the last handle goes the console, which is still to say why.
  const ros::NodeHandle node;
  try
  {
    vibro_impact::graph::Shaker shaker(node, ros::NodeHandle("~"), stop);
    shaker.run();
  }
  catch (const std::exception& error)
  {
    ROS_FATAL_STREAM(error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
