#include <exception>
#include <memory>

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include "vibro_impact/ros/simulator.h"

namespace vibro_impact::nodelets
{
/// The simulator inside a nodelet manager.
class Simulator : public nodelet::Nodelet
{
public:
  ~Simulator() override
  {
    if (simulator_)
    {
      simulator_->finish();
    }
  }

private:
  void onInit() override
  {
    try
    {
      simulator_ = std::make_unique<graph::Simulator>(getNodeHandle(), getPrivateNodeHandle());
    }
    catch (const std::exception& error)
    {
      // The loader swallows what it catches: it only answers that this nodelet could not be loaded.
      NODELET_FATAL_STREAM(error.what());
      throw;
    }
  }

  std::unique_ptr<graph::Simulator> simulator_;
};

}  // namespace vibro_impact::nodelets

PLUGINLIB_EXPORT_CLASS(vibro_impact::nodelets::Simulator, nodelet::Nodelet)
