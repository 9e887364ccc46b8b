#pragma once

#include <memory>
#include <optional>
#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/ContactForce.h>
#include <vibro_impact/Gap.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/SetContact.h>
#include <vibro_impact/StreamStart.h>

#include "vibro_impact/ros/extremes.h"
#include "vibro_impact/ros/log_throttle.h"
#include "vibro_impact/ros/output_queue.h"
#include "vibro_impact/ros/simulator_parameters.h"
#include "vibro_impact/ros/simulator_statistics.h"
#include "vibro_impact/ros/source_guard.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
/// The simulator on the graph: base_excitation in, gap, contact_force and impact out.
///
/// All callbacks must come from one thread at a time (the global queue of a node, or a nodelet's single-threaded one).
class Simulator
{
public:
  /// Reads the private parameters, advertises, subscribes, in that order. Throws config::Error with all faults of the
  /// parameters before anything shows on the graph.
  Simulator(ros::NodeHandle node, ros::NodeHandle private_node);

  /// The stream ends: nothing is taken any more, an open impact is published as cut short, and what was published is on
  /// its way to the subscribers.
  void finish();

private:
  void onExcitation(const ros::MessageEvent<const BaseExcitation>& event);
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onPause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool onSetContact(SetContact::Request& request, SetContact::Response& response);
  void onWaiting(const ros::WallTimerEvent& event);

  void addDiagnostics();
  std::optional<double> inputAge() const;
  /// The motion ends; `reason`: why the next one begins.
  const StreamSimulation::Answer& rest(const std::string& reason);
  void publish(const StreamSimulation::Answer& answer);
  void publishStart(const StreamSimulation::Answer& answer);
  /// What holds from sample `seq` on, at `stamp`.
  void publishModelInfo(const core::SwitchedModel& model, std::uint64_t seq, const ros::Time& stamp);
  void log(const Verdict& verdict);

  SimulatorParameters parameters_;
  StreamSimulation simulation_;
  std::uint64_t contact_changes_ = 0;
  ExtremesHold extremes_;
  SourceGuard guard_;
  bool paused_ = false;
  std::string start_reason_ = "first block";
  std::optional<ros::SteadyTime> last_input_;
  LogThrottle refusals_;
  LogThrottle bridges_;
  LogThrottle restarts_;
  LogThrottle publishers_;
  LogThrottle losses_;
  LogThrottle contact_refusals_;

  Samples excitation_;  ///< keeps its memory from block to block

  OutputQueue gap_;
  OutputQueue force_;
  OutputQueue impact_;
  OutputQueue stream_start_;
  ros::Publisher model_info_publisher_;
  ros::Publisher wrench_publisher_;
  ros::Publisher gap_now_publisher_;
  InputStatistics input_statistics_;
  ComputingStatistics computing_statistics_;
  OutputQueueStatistics queue_statistics_;
  ModelStatistics model_statistics_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostic_timer_;
  ros::WallTimer waiting_timer_;
  ros::ServiceServer reset_server_;
  ros::ServiceServer pause_server_;
  ros::ServiceServer set_contact_server_;
  ros::Subscriber excitation_subscriber_;
};

}  // namespace vibro_impact::graph
