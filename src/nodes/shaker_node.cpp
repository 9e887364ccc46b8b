#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include <ros/ros.h>

#include "vibro_impact/ros/shaker.h"

namespace
{
volatile std::sig_atomic_t stop = 0;

void onSignal(int /*signal*/)
{
  stop = 1;
}
}  // namespace

int main(int argc, char** argv)
{
  // Progress is for now, also where the output goes through a pipe.
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  ros::init(argc, argv, "shaker", ros::init_options::NoSigintHandler);
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
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
