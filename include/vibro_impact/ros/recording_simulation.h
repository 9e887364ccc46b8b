#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vibro_impact/config/simulated_run.h"
#include "vibro_impact/core/parameters.h"
#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/samples.h"
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

/// A change of the contact, as its model_info dates it.
struct RecordedChange
{
  std::uint64_t seq = 0;  ///< number of the first sample that it holds for
  Stamp stamp = 0;        ///< of that sample, which tells one stream from the next
  core::ContactParameters contact;
};

/// What was simulated with in the course of a recording.
struct RecordedModel
{
  core::SystemParameters parameters;    ///< at the beginning
  std::vector<RecordedChange> changes;  ///< in the order in which they were made
  RecordedChange known_from;            ///< what the recording tells first: the contact before it is not known
};

/// Throws config::Error if the recording holds no configuration, several that differ in more than the contact, or not
/// all changes of the contact.
RecordedModel recordedModel(const RecordedRun& recording);

/// Plays the excitation of a recording to a model as the simulator takes it, by the rules of StreamRules: gap, force
/// and impacts are those of a node, bit for bit. At a restart the energy account begins anew. Throws config::Error if
/// the recording is damaged, no block of it is fit to be taken, or it begins before the contact is known.
RecordingSimulation simulateRecording(const RecordedRun& recording, const RecordedModel& recorded,
                                      const StreamLimits& limits, const config::HistorySelection& history,
                                      const config::RunProgress& progress);

}  // namespace vibro_impact::graph
