#include <atomic>
#include <exception>
#include <memory>
#include <thread>

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include "vibro_impact/ros/shaker.h"

namespace vibro_impact::nodelets
{
/// The shaker inside a nodelet manager. It plays on a thread of its own: waiting for its time, it would keep the
/// manager's from the others.
class Shaker : public nodelet::Nodelet
{
public:
  ~Shaker() override
  {
    stop_ = true;
    if (thread_.joinable())
    {
      thread_.join();
    }
  }

private:
  void onInit() override
  {
    try
    {
      shaker_ = std::make_unique<graph::Shaker>(getNodeHandle(), getPrivateNodeHandle(), stop_);
    }
    catch (const std::exception& error)
    {
      NODELET_FATAL_STREAM(error.what());
      throw;
    }
    thread_ = std::thread([this] { play(); });
  }

  void play()
  {
    try
    {
      shaker_->run();
    }
    catch (const std::exception& error)
    {
      NODELET_FATAL_STREAM(error.what());
    }
  }

  std::atomic<bool> stop_{false};
  std::unique_ptr<graph::Shaker> shaker_;
  std::thread thread_;
};

}  // namespace vibro_impact::nodelets

PLUGINLIB_EXPORT_CLASS(vibro_impact::nodelets::Shaker, nodelet::Nodelet)
