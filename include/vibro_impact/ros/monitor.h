#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include "vibro_impact/ros/response_summary.h"

namespace vibro_impact::graph
{
/// What a node that listens to a simulator looks like: it sums up `gap`, `contact_force` and `impact` on /diagnostics.
///
/// All callbacks must come from one thread at a time.
class Monitor
{
public:
  /// Reads the private parameters, which throws config::Error with all their faults, and subscribes.
  Monitor(ros::NodeHandle node, const ros::NodeHandle& private_node);

private:
  ResponseSummary summary_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostic_timer_;
  ros::Subscriber gap_subscriber_;
  ros::Subscriber force_subscriber_;
  ros::Subscriber impact_subscriber_;
};

}  // namespace vibro_impact::graph
