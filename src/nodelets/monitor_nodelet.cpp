#include <exception>
#include <memory>

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include "vibro_impact/ros/monitor.h"

namespace vibro_impact::nodelets
{
/// The monitor inside a nodelet manager.
class Monitor : public nodelet::Nodelet
{
private:
  void onInit() override
  {
    try
    {
      monitor_ = std::make_unique<graph::Monitor>(getNodeHandle(), getPrivateNodeHandle());
    }
    catch (const std::exception& error)
    {
      NODELET_FATAL_STREAM(error.what());
      throw;
    }
  }

  std::unique_ptr<graph::Monitor> monitor_;
};

}  // namespace vibro_impact::nodelets

PLUGINLIB_EXPORT_CLASS(vibro_impact::nodelets::Monitor, nodelet::Nodelet)
