#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include "vibro_impact/core/alarm.h"
#include "vibro_impact/core/response_monitor.h"
#include "vibro_impact/core/wear_feedback.h"

namespace vibro_impact::graph
{
/// One alarm, as its entry in the parameter `alarms` says.
struct AlarmParameters
{
  std::string name;
  const core::Quantity* quantity = nullptr;
  core::AlarmLimits limits;
  std::uint8_t severity = 1;  ///< of Alarm.msg
};

/// Wear that goes back into a simulator.
struct WearFeedbackParameters
{
  std::string simulator;  ///< name of its node
  core::WearFeedbackLimits limits;
};

/// What the private parameters of a monitor say.
struct MonitorParameters
{
  core::MonitorOptions options;
  std::string wear_source;              ///< where the wear coefficient comes from
  std::vector<AlarmParameters> alarms;  ///< by name
  std::optional<WearFeedbackParameters> wear_feedback;
  double silence = 1.0;            ///< after which nothing more is waited for, s of wall time
  double diagnostic_period = 1.0;  ///< s of wall time
  std::uint32_t queue_size = 1000;
};

/// Reads and checks all of them. Throws config::Error with every fault; `name` is how it calls the node.
MonitorParameters parseMonitorParameters(const XmlRpc::XmlRpcValue& tree, const std::string& name);

/// The same for what stands on the parameter server below the node's name.
MonitorParameters readMonitorParameters(const ros::NodeHandle& private_node);

}  // namespace vibro_impact::graph
