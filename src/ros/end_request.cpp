#include "vibro_impact/ros/end_request.h"

#include <csignal>
#include <string>

#include <ros/console.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpcValue.h>

namespace vibro_impact::graph
{
namespace
{
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch nothing else");
std::atomic<bool> requested{false};

void onSignal(int /*signal*/)
{
  requested = true;
}

// The slave API's shutdown(caller, reason).
void onShutdown(XmlRpc::XmlRpcValue& parameters, XmlRpc::XmlRpcValue& result)
{
  const bool explained = parameters.getType() == XmlRpc::XmlRpcValue::TypeArray && parameters.size() > 1 &&
                         parameters[1].getType() == XmlRpc::XmlRpcValue::TypeString;
  ROS_WARN("asked to end: %s", explained ? static_cast<std::string&>(parameters[1]).c_str() : "no reason given");
  requested = true;
  result = ros::xmlrpc::responseInt(1, "", 0);
}

}  // namespace

const std::atomic<bool>& catchEndRequests()
{
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  // What is bound already stays when roscpp starts and binds its own.
  ros::XMLRPCManager::instance()->bind("shutdown", onShutdown);
  return requested;
}

}  // namespace vibro_impact::graph
