#include "vibro_impact/ros/monitor_messages.h"

#include <string>
#include <utility>

#include "text.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
namespace
{
template <typename Message>
core::SampleBlock toBlock(const Message& message, const std::vector<double>& values)
{
  return {message.seq, fromTime(message.header.stamp), message.sample_period, values.data(), values.size()};
}

std::string describe(const Alarm& alarm, const std::string& unit, bool turned)
{
  const bool active = alarm.active != 0;
  const bool cleared = turned && !active;
  const char* const state = active ? "raised" : cleared ? "cleared" : "not";
  const char* const side = (alarm.raise_at > alarm.clear_at) != cleared ? "above" : "below";
  return text(alarm.quantity, " is ", alarm.value, unit.empty() ? "" : " ", unit, ": ", state, ' ', side, ' ',
              cleared ? alarm.clear_at : alarm.raise_at);
}
}  // namespace

core::ReleasedImpact toReleasedImpact(const Impact& message)
{
  core::ReleasedImpact impact;
  impact.number = message.number;
  impact.onset = fromTime(message.header.stamp);
  // Of an impossible duration the monitor itself takes care.
  const bool dated = message.duration >= 0.0 && message.duration <= core::ResponseMonitor::longest;
  impact.release = impact.onset + (dated ? core::nanoseconds(message.duration) : 0);
  impact.duration = message.duration;
  impact.impulse = message.impulse;
  impact.peak_force = message.peak_force;
  impact.energy_lost = message.energy_lost;
  impact.cut_short = message.cut_short != 0;
  return impact;
}

core::SampleBlock toBlock(const BaseExcitation& message)
{
  return toBlock(message, message.acceleration);
}

core::SampleBlock toBlock(const Gap& message)
{
  return toBlock(message, message.gap);
}

core::SampleBlock toBlock(const ContactForce& message)
{
  return toBlock(message, message.force);
}

void toMessage(const core::ResponseMonitor& monitor, std::uint64_t contact_changes, ImpactStatistics& message)
{
  const core::ResponseStatistics& statistics = monitor.statistics();
  message.header.stamp = toTime(statistics.time);
  message.header.frame_id = base_frame;
  message.window = statistics.window;
  message.impacts = statistics.sums.whole;
  message.cut_short = statistics.sums.cut_short;
  message.impact_rate = statistics.impact_rate;
  message.impulse_mean = statistics.sums.impulseMean();
  message.impulse_rms = statistics.sums.impulseRms();
  message.impulse_max = statistics.sums.impulse_max;
  message.histogram_edges = monitor.histogramEdges();
  message.histogram = statistics.histogram;
  message.peak_force = statistics.sums.peak_force;
  message.contact_duty = statistics.contact_duty;
  message.mean_force = statistics.mean_force;
  message.impact_power = statistics.impact_power;
  message.normal_work_rate = statistics.normal_work_rate;
  message.wear_rate = statistics.wear_rate;
  message.drive_frequency = statistics.drive_frequency;
  message.period = static_cast<std::uint32_t>(statistics.period);
  message.period_time = statistics.period > 0 ? statistics.period / statistics.drive_frequency : 0.0;
  message.total_impacts = statistics.total.whole;
  message.total_cut_short = statistics.total.cut_short;
  message.total_time = statistics.total_time;
  message.total_contact_time = statistics.total_contact_time;
  message.total_impulse = statistics.total.impulse;
  message.total_energy_lost = statistics.total.energy_lost;
  message.total_normal_work = statistics.total_normal_work;
  message.wear_volume = statistics.wear_volume;
  message.wear_depth = statistics.wear_depth;
  message.missing_impacts = monitor.impacts().missing();
  message.missing_samples = monitor.forceSamples().missing();
  message.late_impacts = monitor.lateImpacts();
  message.restarts = monitor.restarts();
  message.contact_changes = contact_changes;
}

AlarmPanel::AlarmPanel(const std::vector<AlarmParameters>& parameters)
{
  message_.header.frame_id = base_frame;
  for (const AlarmParameters& one : parameters)
  {
    watched_.push_back({one.quantity, core::Alarm(one.limits)});
    Alarm alarm;
    alarm.name = one.name;
    alarm.quantity = one.quantity->name;
    alarm.severity = one.severity;
    alarm.raise_at = one.limits.raise_at;
    alarm.clear_at = one.limits.clear_at;
    alarm.text = text(alarm.quantity, ": no statistics yet");
    message_.alarms.push_back(alarm);
  }
}

bool AlarmPanel::update(const core::ResponseStatistics& statistics)
{
  const bool first = message_.header.stamp.isZero();
  bool changed = false;
  const bool another_stretch = std::exchange(stretch_, statistics.stretch) != statistics.stretch;
  for (std::size_t i = 0; i < watched_.size(); ++i)
  {
    Alarm& alarm = message_.alarms[i];
    if (another_stretch)
    {
      watched_[i].alarm.beginStretch();
    }
    const double value = watched_[i].quantity->value(statistics);
    const bool turned = watched_[i].alarm.update(statistics.time, value);
    if (!turned && !first)
    {
      continue;
    }
    changed = true;
    alarm.active = watched_[i].alarm.active() ? 1 : 0;
    alarm.value = value;
    if (turned)
    {
      alarm.since = toTime(statistics.time);
      alarm.raised += alarm.active;
    }
    alarm.text = describe(alarm, watched_[i].quantity->unit, turned);
  }
  if (changed)
  {
    message_.header.stamp = toTime(statistics.time);
  }
  return changed;
}

}  // namespace vibro_impact::graph
