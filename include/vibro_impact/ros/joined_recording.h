#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <ros/time.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ModelInfo.h>
#include <vibro_impact/StreamStart.h>

#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/recording_check.h"
#include "vibro_impact/ros/sample_column.h"

namespace vibro_impact::graph
{
/// Everything that a recording holds, its blocks joined on the axis of samples of its excitation: element i belongs to
/// sample summary.first + i. NaN where a value is not in the recording, or is no answer to the excitation recorded.
struct JoinedRecording
{
  RecordingSummary summary;
  ros::Time start;             ///< stamp of the first sample
  SampleColumn acceleration;   ///< m/s^2
  SampleColumn gap;            ///< m
  SampleColumn contact_force;  ///< N

  // In the order of recording, without repetitions.
  std::vector<Impact> impacts;
  std::vector<ModelInfo> models;
  std::vector<StreamStart> starts;
};

/// Reads a recording as RecordingCheck judges it, and throws as that does; and where more samples are missing than are
/// recorded, and ten million more, which have no place in memory. `stream`: which of the stretches to take between the
/// places where this would throw, from 0 on; then the excitation is read twice.
JoinedRecording joinRecording(const RecordedRun& recording, std::optional<std::size_t> stream = {},
                              const RecordedRun::Progress& progress = {});

}  // namespace vibro_impact::graph
