#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

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

#include "vibro_impact/ros/excitation_input.h"
#include "vibro_impact/ros/extremes.h"
#include "vibro_impact/ros/log_throttle.h"
#include "vibro_impact/ros/output_queue.h"
#include "vibro_impact/ros/simulator_parameters.h"
#include "vibro_impact/ros/simulator_statistics.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
/// The simulator on the graph: base_excitation in, gap, contact_force and impact out; excitation_used, too, where what
/// comes in is single samples.
///
/// All callbacks must come from one thread at a time (the global queue of a node, or a nodelet's single-threaded one).
class Simulator : private ExcitationSink
{
public:
  /// Reads the private parameters, advertises, subscribes, in that order. Throws config::Error with all faults of the
  /// parameters before anything shows on the graph.
  Simulator(ros::NodeHandle node, ros::NodeHandle private_node);

  /// The stream ends: nothing is taken any more, an open impact is published as cut short, and what was published is on
  /// its way to the subscribers.
  void finish();

private:
  void onExcitation(const Samples& excitation) override;
  void onRefusal(const std::string& reason, std::uint64_t samples) override;
  void onSecondPublisher(const std::string& source, const std::string& second, std::size_t samples) override;
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onPause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool onSetContact(SetContact::Request& request, SetContact::Response& response);

  void addDiagnostics();
  std::vector<const OutputQueue*> queues() const;
  /// The motion ends; `reason`: why the next one begins.
  const StreamSimulation::Answer& rest(std::uint8_t cause, const std::string& reason);
  void publish(const StreamSimulation::Answer& answer);
  /// Whether somebody wants the motion; then every how many samples, else 0.
  std::uint64_t motionStep(double sample_period) const;
  void publishMotion(const StreamSimulation::Answer& answer);
  void publishStart(const StreamSimulation::Answer& answer);
  /// What holds from sample `seq` on, at `stamp`.
  void publishModelInfo(const core::SwitchedModel& model, std::uint64_t seq, const ros::Time& stamp);
  void log(const Verdict& verdict);

  SimulatorParameters parameters_;
  StreamSimulation simulation_;
  std::uint64_t contact_changes_ = 0;
  ExtremesHold extremes_;
  bool paused_ = false;
  std::string start_reason_ = "first block";
  std::uint8_t start_cause_ = StreamStart::FIRST;
  std::uint64_t starts_ = 0;
  LogThrottle refusals_;
  LogThrottle bridges_;
  LogThrottle restarts_;
  LogThrottle publishers_;
  LogThrottle contact_refusals_;

  OutputQueue excitation_used_;  ///< of single samples only
  OutputQueue gap_;
  OutputQueue force_;
  OutputQueue impact_;
  ros::Publisher motion_publisher_;
  ros::Publisher model_info_publisher_;
  ros::Publisher stream_start_publisher_;
  ros::Publisher wrench_publisher_;
  ros::Publisher gap_now_publisher_;
  InputStatistics input_statistics_;
  ComputingStatistics computing_statistics_;
  OutputQueueStatistics queue_statistics_;
  ModelStatistics model_statistics_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostic_timer_;
  ros::ServiceServer reset_server_;
  ros::ServiceServer pause_server_;
  ros::ServiceServer set_contact_server_;
  ExcitationInput input_;
};

}  // namespace vibro_impact::graph
