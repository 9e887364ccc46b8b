#include "vibro_impact/ros/monitor.h"

#include <cstdint>
#include <string>

#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/parameter_reader.h"

namespace vibro_impact::graph
{
namespace
{
constexpr double longest_wait = 3600.0;
constexpr std::uint32_t longest_queue = 1000000;
/// An impact is small and must not be lost.
constexpr std::uint32_t impact_queue = 100000;
}  // namespace

Monitor::Monitor(ros::NodeHandle node, const ros::NodeHandle& private_node)
    : diagnostics_(node, private_node, private_node.getNamespace())
{
  XmlRpc::XmlRpcValue tree;
  private_node.getParam(private_node.getNamespace(), tree);
  ParameterReader reader(tree, "");
  const double period = reader.positive("diagnostic_period", 1.0, longest_wait, " (s)");
  const std::uint32_t queue_size = reader.count("queue_size", 1000, longest_queue);
  reader.rejectUnknown();
  if (!reader.faults().empty())
  {
    throw config::Error(private_node.getNamespace(), reader.faults());
  }

  diagnostics_.setHardwareID("none");
  diagnostics_.add("Response",
                   [this](diagnostic_updater::DiagnosticStatusWrapper& status) { summary_.report(status); });
  diagnostic_timer_ = node.createWallTimer(ros::WallDuration(period),
                                           [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  gap_subscriber_ = node.subscribe<Gap>(
      "gap", queue_size, [this](const Gap::ConstPtr& gap) { summary_.add(*gap); }, ros::VoidConstPtr(), hints);
  force_subscriber_ = node.subscribe<ContactForce>(
      "contact_force", queue_size, [this](const ContactForce::ConstPtr& force) { summary_.add(*force); },
      ros::VoidConstPtr(), hints);
  impact_subscriber_ = node.subscribe<Impact>(
      "impact", impact_queue, [this](const Impact::ConstPtr& impact) { summary_.add(*impact); }, ros::VoidConstPtr(),
      hints);
}

}  // namespace vibro_impact::graph
