#include "vibro_impact/ros/sensor_samples.h"

#include <array>

#include "text.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
namespace
{
/// How messages call the value that is taken, sign included.
std::string quantityOf(const InputParameters& parameters)
{
  static const std::array<const char*, 3> components = {"x", "y", "z"};
  return text(parameters.axis.sign < 0.0 ? "-" : "",
              parameters.kind == InputKind::imu ? "linear_acceleration." : "accel.linear.",
              components[parameters.axis.component]);
}

}  // namespace

SensorSamples::SensorSamples(const InputParameters& parameters, const StreamLimits& limits)
    : parameters_(parameters), grid_(parameters.grid, limits, quantityOf(parameters))
{
  if (!parameters_.frame_id.empty())
  {
    frame_id_ = parameters_.frame_id;
  }
}

const SampleGrid::Answer& SensorSamples::take(const geometry_msgs::AccelStamped& message)
{
  return take(message.header, message.accel.linear);
}

const SampleGrid::Answer& SensorSamples::take(const sensor_msgs::Imu& message)
{
  if (message.linear_acceleration_covariance[0] == -1.0)
  {
    return refuse("linear_acceleration_covariance[0] is -1: the sensor gives no accelerations");
  }
  return take(message.header, message.linear_acceleration);
}

const SampleGrid::Answer& SensorSamples::take(const std_msgs::Header& header,
                                              const geometry_msgs::Vector3& acceleration)
{
  if (!frame_id_)
  {
    frame_id_ = header.frame_id;
  }
  if (header.frame_id != *frame_id_)
  {
    return refuse(text("header.frame_id is \"", header.frame_id, "\", must be \"", *frame_id_, "\", ",
                       parameters_.frame_id.empty() ? "that of the first sample" : "as ~frame_id says"));
  }
  const std::array<double, 3> components = {acceleration.x, acceleration.y, acceleration.z};
  return grid_.take(fromTime(header.stamp), parameters_.axis.sign * components[parameters_.axis.component]);
}

const SampleGrid::Answer& SensorSamples::refuse(const std::string& reason)
{
  refusal_.refusal = reason;
  refusal_.refused = 1;
  return refusal_;
}

}  // namespace vibro_impact::graph
