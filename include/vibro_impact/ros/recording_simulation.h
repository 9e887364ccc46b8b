#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vibro_impact/config/simulated_run.h"
#include "vibro_impact/core/parameters.h"
#include "vibro_impact/ros/contact_history.h"
#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
/// What a recorded excitation makes of a model.
struct RecordingSimulation
{
  config::SimulatedRun run;        ///< its time is zero at the first sample that was taken
  double sample_period = 0.0;      ///< s, of the block taken last
  std::uint64_t samples = 0;       ///< taken from blocks
  std::uint64_t refused = 0;       ///< blocks
  std::uint64_t bridged = 0;       ///< samples
  std::uint64_t restarts = 0;      ///< from rest
  std::string first_irregularity;  ///< why the first block was refused, bridged to or restarted at; empty: none was
};

/// The model of a recording and the changes of its contact. Throws config::Error if the recording holds no
/// configuration, or several that differ in more than the contact.
ContactHistory recordedContacts(const RecordedRun& recording);

/// Plays the excitation of a recording to a model as the simulator takes it, by the rules of StreamRules: the same
/// impacts as those of a node, bit for bit. `changes`: of the contact, in the course of the recording. At a restart the
/// energy account begins anew. Throws config::Error if the recording is damaged or no block of it is fit to be taken.
RecordingSimulation simulateRecording(const RecordedRun& recording, const core::SystemParameters& parameters,
                                      const std::vector<DatedContact>& changes, const StreamLimits& limits,
                                      const config::HistorySelection& history, const config::RunProgress& progress);

}  // namespace vibro_impact::graph
