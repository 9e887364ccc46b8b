#pragma once

#include <optional>
#include <string>

#include <geometry_msgs/AccelStamped.h>
#include <geometry_msgs/Vector3.h>
#include <sensor_msgs/Imu.h>

#include "vibro_impact/ros/input_parameters.h"
#include "vibro_impact/ros/sample_grid.h"

namespace vibro_impact::graph
{
/// The acceleration of the base from the messages of a sensor: the component along the axis, put on a grid. Messages of
/// another frame, or of a sensor that gives no accelerations, are refused.
class SensorSamples
{
public:
  SensorSamples(const InputParameters& parameters, const StreamLimits& limits);

  /// As SampleGrid::take(); the answer holds until the next call.
  const SampleGrid::Answer& take(const geometry_msgs::AccelStamped& message);
  const SampleGrid::Answer& take(const sensor_msgs::Imu& message);

  const SampleGrid& grid() const
  {
    return grid_;
  }
  /// Of the samples; nothing: not known yet.
  const std::optional<std::string>& frameId() const
  {
    return frame_id_;
  }

private:
  const SampleGrid::Answer& take(const std_msgs::Header& header, const geometry_msgs::Vector3& acceleration);
  const SampleGrid::Answer& refuse(const std::string& reason);

  InputParameters parameters_;
  SampleGrid grid_;
  std::optional<std::string> frame_id_;
  SampleGrid::Answer refusal_;
};

}  // namespace vibro_impact::graph
