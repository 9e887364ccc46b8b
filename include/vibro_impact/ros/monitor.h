#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include "vibro_impact/core/response_monitor.h"
#include "vibro_impact/ros/contact_feedback.h"
#include "vibro_impact/ros/held_contact.h"
#include "vibro_impact/ros/monitor_diagnostics.h"
#include "vibro_impact/ros/monitor_messages.h"
#include "vibro_impact/ros/monitor_parameters.h"

namespace vibro_impact::graph
{
/// The monitor on the graph: gap, contact_force, impact, model_info and base_excitation in; impact_statistics and alarm
/// out; wear back to the simulator, if asked to.
///
/// All callbacks must come from one thread at a time.
class Monitor
{
public:
  /// Reads the private parameters, which throws config::Error with all their faults, and subscribes.
  Monitor(ros::NodeHandle node, const ros::NodeHandle& private_node);

private:
  void subscribe(ros::NodeHandle& node);
  void onSilenceTimer();
  /// The statistics that are due, and what follows from them. `silent`: nothing has come for a while.
  void publish(bool silent);

  MonitorParameters parameters_;
  core::ResponseMonitor monitor_;
  AlarmPanel alarms_;
  std::optional<ContactFeedback> feedback_;
  HeldContact contact_;
  std::uint64_t heard_at_timer_ = 0;  ///< samples and impacts
  ros::Publisher statistics_publisher_;
  ros::Publisher alarm_publisher_;
  MonitorDiagnostics reports_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostic_timer_;
  ros::WallTimer silence_timer_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace vibro_impact::graph
