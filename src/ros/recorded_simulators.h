#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/recording_simulation.h"

namespace vibro_impact::graph
{
/// The model of one simulator in the course of a recording, as its model_info tells it.
struct RecordedSimulator
{
  RecordedModel model;
  std::uint64_t first_number = 0;                ///< running number of its first model_info
  std::map<std::size_t, std::uint64_t> missing;  ///< running numbers missing, by the change before which they are
};

/// The simulators of a recording, one after another: one that is started anew tells its model anew, with numbers that
/// begin anew. Repetitions are left. None if there is no model_info. Throws config::Error if a configuration is none,
/// or changes in more than its contact.
std::vector<RecordedSimulator> recordedSimulators(const RecordedRun& recording);

}  // namespace vibro_impact::graph
