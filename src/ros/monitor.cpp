#include "vibro_impact/ros/monitor.h"

#include <utility>

#include "vibro_impact/ros/checked_subscription.h"

namespace vibro_impact::graph
{
namespace
{
/// An impact is small and must not be lost.
constexpr std::uint32_t impact_queue = 100000;

template <typename Message, typename Callback>
ros::Subscriber listen(ros::NodeHandle& node, const std::string& topic, std::uint32_t queue, const Callback& callback)
{
  ros::SubscribeOptions options =
      checkedSubscription<Message>(topic, queue, [callback](const auto& event) { callback(*event.getConstMessage()); });
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  return node.subscribe(options);
}
}  // namespace

Monitor::Monitor(ros::NodeHandle node, const ros::NodeHandle& private_node)
    : parameters_(readMonitorParameters(private_node)),
      monitor_(parameters_.options),
      alarms_(parameters_.alarms),
      statistics_publisher_(node.advertise<ImpactStatistics>("impact_statistics", parameters_.queue_size, true)),
      alarm_publisher_(node.advertise<AlarmArray>("alarm", parameters_.queue_size, true)),
      reports_(parameters_.wear_source),
      diagnostics_(node, private_node, private_node.getNamespace())
{
  using Status = diagnostic_updater::DiagnosticStatusWrapper;
  alarm_publisher_.publish(alarms_.message());
  diagnostics_.setHardwareID("none");
  diagnostics_.add("Response", [this](Status& status) { reports_.report(monitor_, contact_.changes(), status); });
  diagnostics_.add("Alarms", [this](Status& status) { MonitorDiagnostics::report(alarms_.message(), status); });
  if (parameters_.wear_feedback)
  {
    feedback_.emplace(node, *parameters_.wear_feedback);
    diagnostics_.add("Wear feedback", [this](Status& status) { feedback_->report(status); });
  }
  diagnostic_timer_ = node.createWallTimer(ros::WallDuration(parameters_.diagnostic_period),
                                           [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  silence_timer_ = node.createWallTimer(ros::WallDuration(parameters_.silence),
                                        [this](const ros::WallTimerEvent&) { onSilenceTimer(); });
  subscribe(node);
}

void Monitor::subscribe(ros::NodeHandle& node)
{
  const std::uint32_t queue = parameters_.queue_size;
  const auto on_info = [this](const ModelInfo& info)
  {
    if (contact_.take(info) && feedback_)
    {
      feedback_->hold(contact_);
    }
  };
  const auto on_force = [this](const ContactForce& force)
  {
    monitor_.addForce(toBlock(force));
    publish(false);
  };
  subscribers_ = {listen<ModelInfo>(node, "model_info", queue, on_info),
                  listen<Impact>(node, "impact", impact_queue,
                                 [this](const auto& impact) { monitor_.addImpact(toReleasedImpact(impact)); }),
                  listen<Gap>(node, "gap", queue, [this](const auto& gap) { monitor_.addGap(toBlock(gap)); }),
                  listen<BaseExcitation>(node, "base_excitation", queue,
                                         [this](const auto& drive) { monitor_.addExcitation(toBlock(drive)); }),
                  listen<ContactForce>(node, "contact_force", queue, on_force)};
}

void Monitor::onSilenceTimer()
{
  const std::uint64_t heard = monitor_.forceSamples().taken() + monitor_.impacts().taken();
  publish(heard == std::exchange(heard_at_timer_, heard));
}

void Monitor::publish(bool silent)
{
  while (const core::ResponseStatistics* statistics = monitor_.next(silent))
  {
    ImpactStatistics message;
    toMessage(monitor_, contact_.changes(), message);
    statistics_publisher_.publish(message);
    if (alarms_.update(*statistics))
    {
      alarm_publisher_.publish(alarms_.message());
    }
    if (feedback_)
    {
      feedback_->wear(statistics->time, statistics->wear_depth);
    }
  }
}

}  // namespace vibro_impact::graph
