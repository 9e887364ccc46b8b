#pragma once

#include <cstddef>
#include <string>

#include "vibro_impact/ros/parameter_reader.h"
#include "vibro_impact/ros/sample_grid.h"

namespace vibro_impact::graph
{
/// What the excitation comes in, and hence the type of its topic.
enum class InputKind
{
  block,  ///< vibro_impact/BaseExcitation
  accel,  ///< geometry_msgs/AccelStamped: accelerations
  imu     ///< sensor_msgs/Imu: specific forces (REP-145), gravity included
};

/// How the parameter `input` calls it.
const char* nameOf(InputKind kind);

/// The direction of a sensor's frame in which the base moves.
struct Axis
{
  std::size_t component = 2;  ///< 0, 1, 2: x, y, z
  double sign = 1.0;          ///< of the component in that direction
};

/// What the private parameters of a simulator say of its source.
struct InputParameters
{
  InputKind kind = InputKind::block;
  // Of single samples (accel, imu):
  Axis axis;
  std::string frame_id;  ///< of every sample; empty: that of the first
  GridParameters grid;
};

/// Reads and checks input, axis, frame_id, sample_period, offset and offset_duration; rejects what has no meaning for
/// the source chosen, max_stamp_jitter included.
InputParameters readInput(ParameterReader& reader);

}  // namespace vibro_impact::graph
