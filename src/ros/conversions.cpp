#include "vibro_impact/ros/conversions.h"

#include <vector>

#include "vibro_impact/config/configuration.h"

namespace vibro_impact::graph
{
namespace
{
constexpr double two_pi = 6.283185307179586;

template <typename Message>
void toBlock(const Samples& samples, Message& message, std::vector<double>& values)
{
  message.header = std_msgs::Header();
  message.header.stamp = toTime(samples.stamp);
  message.header.frame_id = base_frame;
  message.seq = samples.seq;
  message.sample_period = samples.sample_period;
  values = samples.values;
}

template <typename Message>
void fromBlock(const Message& message, const std::vector<double>& values, Samples& samples)
{
  samples.stamp = fromTime(message.header.stamp);
  samples.seq = message.seq;
  samples.sample_period = message.sample_period;
  samples.values = values;
}

std::vector<double> hertz(const Eigen::ArrayXd& frequency)
{
  const Eigen::ArrayXd scaled = frequency / two_pi;
  return {scaled.data(), scaled.data() + scaled.size()};
}
}  // namespace

const char* const base_frame = "base_frame";

Stamp fromTime(const ros::Time& time)
{
  return static_cast<Stamp>(time.toNSec());
}

ros::Time toTime(Stamp stamp)
{
  return ros::Time().fromNSec(static_cast<std::uint64_t>(stamp));
}

void toMessage(const Samples& samples, BaseExcitation& message)
{
  toBlock(samples, message, message.acceleration);
}

void toMessage(const Samples& samples, Gap& message)
{
  toBlock(samples, message, message.gap);
}

void toMessage(const Samples& samples, ContactForce& message)
{
  toBlock(samples, message, message.force);
}

void toMessage(const StampedImpact& impact, Impact& message)
{
  message.header = std_msgs::Header();
  message.header.stamp = toTime(impact.stamp);
  message.header.frame_id = base_frame;
  message.number = impact.impact.number;
  message.seq = impact.impact.interval;
  message.offset = impact.impact.offset;
  message.duration = impact.impact.duration;
  message.impulse = impact.impact.impulse;
  message.peak_force = impact.impact.peak_force;
  message.peak_time = impact.impact.peak_time;
  message.approach_speed = impact.impact.approach_speed;
  message.separation_speed = impact.impact.separation_speed;
  message.energy_lost = impact.impact.energy_lost;
  message.cut_short = impact.impact.cut_short;
  message.dissipated = impact.impact.dissipated;
  message.mapping_loss = impact.impact.mapping_loss;
  message.base_work = impact.impact.base_work;
}

void toMessage(const StreamSimulation::Motion& motion, const core::SwitchedModel& model, double sample_period,
               StructureMotion& message)
{
  message.header = std_msgs::Header();
  message.header.stamp = toTime(motion.stamp);
  message.header.frame_id = base_frame;
  message.seq = motion.seq;
  message.sample_period = sample_period;
  message.step = motion.step;
  message.structure.clear();
  message.mode.clear();
  message.contact_deflection.clear();
  for (const core::StructureMode& mode : model.structureModes())
  {
    message.structure.push_back(static_cast<std::uint8_t>(mode.structure));
    message.mode.push_back(static_cast<std::uint32_t>(mode.number));
    message.contact_deflection.push_back(mode.contact_deflection);
  }
  message.coordinates = motion.coordinates;
  message.gap = motion.gap;
  message.force = motion.force;
  message.acceleration = motion.acceleration;
}

void toMessage(const core::SwitchedModel& model, const std::string& configuration, const std::string& version,
               ModelInfo& message)
{
  const Eigen::ArrayXd loss = model.mappingLoss();
  message.header = std_msgs::Header();
  message.header.frame_id = base_frame;
  message.version = version;
  message.configuration = configuration;
  message.free_frequencies = hertz(model.free().frequency);
  message.contact_frequencies = hertz(model.contact().frequency);
  message.mapping_loss.assign(loss.data(), loss.data() + loss.size());
  message.seq = 0;
  message.number = 0;
}

void fromMessage(const BaseExcitation& message, Samples& samples)
{
  fromBlock(message, message.acceleration, samples);
}

void fromMessage(const Gap& message, Samples& samples)
{
  fromBlock(message, message.gap, samples);
}

void fromMessage(const ContactForce& message, Samples& samples)
{
  fromBlock(message, message.force, samples);
}

StampedImpact fromMessage(const Impact& message)
{
  StampedImpact impact;
  impact.stamp = fromTime(message.header.stamp);
  impact.impact.number = message.number;
  impact.impact.interval = message.seq;
  impact.impact.offset = message.offset;
  impact.impact.duration = message.duration;
  impact.impact.impulse = message.impulse;
  impact.impact.peak_force = message.peak_force;
  impact.impact.peak_time = message.peak_time;
  impact.impact.approach_speed = message.approach_speed;
  impact.impact.separation_speed = message.separation_speed;
  impact.impact.energy_lost = message.energy_lost;
  impact.impact.cut_short = message.cut_short;
  impact.impact.dissipated = message.dissipated;
  impact.impact.mapping_loss = message.mapping_loss;
  impact.impact.base_work = message.base_work;
  return impact;
}

core::SystemParameters fromMessage(const ModelInfo& message)
{
  return config::parse(message.configuration, "model_info");
}

}  // namespace vibro_impact::graph
