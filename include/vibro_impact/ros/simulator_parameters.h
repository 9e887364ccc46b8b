#pragma once

#include <cstdint>
#include <string>

#include <xmlrpcpp/XmlRpcValue.h>

#include "vibro_impact/core/parameters.h"
#include "vibro_impact/ros/input_parameters.h"
#include "vibro_impact/ros/simulator_statistics.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
/// Everything that the private parameters of a simulator say.
struct SimulatorParameters
{
  core::SystemParameters system;  ///< beam1, beam2, contact, damping, basis
  InputParameters input;          ///< input, axis, frame_id, sample_period, offset, offset_duration
  StreamLimits limits;            ///< max_acceleration, max_bridged_gap, max_step_back, max_stamp_jitter
  double mirror_rate = 50.0;      ///< messages of each slow mirror per second of the stream's time, Hz
  double motion_rate =
      0.0;  ///< rows of `motion` per second of the stream's time, Hz; 0: 64 per period of the lowest natural frequency
  std::uint32_t queue_size = 1000;  ///< messages in the queue of each subscriber and publisher; 0: no limit
  DiagnosticThresholds thresholds;  ///< max_input_age, warn_..., error_...
  double diagnostic_period = 1.0;   ///< s of wall time
};

/// Reads a parameter tree, as the parameter server gives it. A text that is wholly a number counts as one. The file of
/// a modal table is relative to `configuration_directory`; without that its path must be absolute. Throws config::Error
/// with all faults in one message, `name` the name of the tree: unknown, missing, mistyped and out-of-range parameters,
/// each with its value and what is allowed.
SimulatorParameters parseSimulatorParameters(const XmlRpc::XmlRpcValue& tree, const std::string& name);

/// A parameter tree as YAML text: numbers, words, lists and maps mean the same in both.
std::string toYaml(const XmlRpc::XmlRpcValue& value);

}  // namespace vibro_impact::graph
