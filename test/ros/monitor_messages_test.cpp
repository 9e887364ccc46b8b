#include <cmath>
#include <map>
#include <string>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <gtest/gtest.h>

#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/held_contact.h"
#include "vibro_impact/ros/monitor_diagnostics.h"
#include "vibro_impact/ros/monitor_messages.h"

namespace core = vibro_impact::core;
using diagnostic_msgs::DiagnosticStatus;
using vibro_impact::Alarm;
using vibro_impact::AlarmArray;
using vibro_impact::graph::AlarmPanel;
using vibro_impact::graph::AlarmParameters;
using vibro_impact::graph::MonitorDiagnostics;
using vibro_impact::graph::toBlock;
using vibro_impact::graph::toMessage;
using vibro_impact::graph::toReleasedImpact;

namespace
{
constexpr core::StreamTime start = 1'700'000'000'000'000'000;

core::ResponseStatistics statisticsAt(core::StreamTime time, double impact_rate, double depth)
{
  core::ResponseStatistics statistics;
  statistics.time = time;
  statistics.impact_rate = impact_rate;
  statistics.wear_depth = depth;
  return statistics;
}

std::vector<AlarmParameters> parameters()
{
  return {{"hammering", core::findQuantity("impact_rate"), {200.0, 150.0}, Alarm::ERROR},
          {"silent", core::findQuantity("impact_rate"), {1.0, 10.0}, Alarm::WARN}};
}

TEST(AlarmPanel, saysTheStateOfAllFromTheBeginning)
{
  AlarmPanel panel(parameters());
  ASSERT_EQ(panel.message().alarms.size(), 2u);
  EXPECT_TRUE(panel.message().header.stamp.isZero());
  EXPECT_EQ(panel.message().alarms[0].name, "hammering");
  EXPECT_EQ(panel.message().alarms[0].text, "impact_rate: no statistics yet");
  // The first statistics are news, whatever they say.
  EXPECT_TRUE(panel.update(statisticsAt(start, 50.0, 0.0)));
  EXPECT_EQ(panel.message().header.stamp, vibro_impact::graph::toTime(start));
  EXPECT_EQ(panel.message().alarms[0].text, "impact_rate is 50 1/s: not above 200");
  EXPECT_EQ(panel.message().alarms[1].text, "impact_rate is 50 1/s: not below 1");
  EXPECT_FALSE(panel.update(statisticsAt(start + 1, 60.0, 0.0)));
}

TEST(AlarmPanel, raisesAndClearsInBothDirections)
{
  AlarmPanel panel(parameters());
  panel.update(statisticsAt(start, 50.0, 0.0));
  EXPECT_TRUE(panel.update(statisticsAt(start + 1000, 250.0, 0.0)));
  const Alarm hammering = panel.message().alarms[0];
  EXPECT_TRUE(hammering.active);
  EXPECT_EQ(hammering.since, vibro_impact::graph::toTime(start + 1000));
  EXPECT_EQ(hammering.value, 250.0);
  EXPECT_EQ(hammering.raised, 1u);
  EXPECT_EQ(hammering.text, "impact_rate is 250 1/s: raised above 200");
  EXPECT_FALSE(panel.message().alarms[1].active);
  EXPECT_FALSE(panel.update(statisticsAt(start + 2000, 160.0, 0.0)));
  EXPECT_TRUE(panel.update(statisticsAt(start + 3000, 0.0, 0.0)));
  EXPECT_FALSE(panel.message().alarms[0].active);
  EXPECT_EQ(panel.message().alarms[0].text, "impact_rate is 0 1/s: cleared below 150");
  EXPECT_TRUE(panel.message().alarms[1].active);
  EXPECT_EQ(panel.message().alarms[1].text, "impact_rate is 0 1/s: raised below 1");
  EXPECT_TRUE(panel.update(statisticsAt(start + 4000, 20.0, 0.0)));
  EXPECT_EQ(panel.message().alarms[1].text, "impact_rate is 20 1/s: cleared above 10");
  EXPECT_EQ(panel.message().alarms[1].raised, 1u);
}

TEST(AlarmPanel, countsNoDelayWhileNobodyListens)
{
  constexpr core::StreamTime second = 1'000'000'000;
  std::vector<AlarmParameters> patient = parameters();
  patient.resize(1);
  patient[0].limits.on_delay = 2 * second;
  AlarmPanel panel(patient);
  const auto update = [&](core::StreamTime time, std::uint64_t stretch)
  {
    core::ResponseStatistics statistics = statisticsAt(start + time, 300.0, 0.0);
    statistics.stretch = stretch;
    panel.update(statistics);
    return panel.message().alarms[0].active != 0;
  };
  EXPECT_FALSE(update(0, 1));
  EXPECT_FALSE(update(3600 * second, 2));
  EXPECT_FALSE(update(3601 * second, 2));
  EXPECT_TRUE(update(3602 * second, 2));
}

TEST(AlarmPanel, diagnosticsAreAsSevereAsTheWorst)
{
  AlarmPanel panel(parameters());
  const auto level = [&panel]
  {
    diagnostic_updater::DiagnosticStatusWrapper status;
    MonitorDiagnostics::report(panel.message(), status);
    EXPECT_EQ(status.values.size(), 2u);
    return status;
  };
  EXPECT_EQ(level().level, DiagnosticStatus::OK);
  panel.update(statisticsAt(start, 0.0, 0.0));
  EXPECT_EQ(level().level, DiagnosticStatus::WARN);
  EXPECT_EQ(level().message, "silent: impact_rate is 0 1/s: raised below 1");
  panel.update(statisticsAt(start, 300.0, 0.0));
  EXPECT_EQ(level().level, DiagnosticStatus::ERROR);
  panel.update(statisticsAt(start, 100.0, 0.0));
  EXPECT_EQ(level().level, DiagnosticStatus::OK);
}

vibro_impact::Impact impactOf(std::uint64_t number, double impulse, double peak_force)
{
  vibro_impact::Impact impact;
  impact.header.stamp = vibro_impact::graph::toTime(start);
  impact.number = number;
  impact.duration = 1.0e-4;
  impact.impulse = impulse;
  impact.peak_force = peak_force;
  return impact;
}

class MonitorDiagnosticsTest : public testing::Test
{
protected:
  void addBlock(std::uint64_t seq, const std::vector<double>& gap_values, const std::vector<double>& force_values)
  {
    vibro_impact::Gap gap;
    gap.header.stamp = vibro_impact::graph::toTime(start + 1'000'000 * static_cast<core::StreamTime>(seq));
    gap.seq = seq;
    gap.sample_period = 1.0e-3;
    gap.gap = gap_values;
    monitor_.addGap(toBlock(gap));
    vibro_impact::ContactForce force;
    force.header = gap.header;
    force.seq = seq;
    force.sample_period = 1.0e-3;
    force.force = force_values;
    monitor_.addForce(toBlock(force));
  }

  /// The level; the values go to value_.
  int report()
  {
    while (monitor_.next(true) != nullptr)
    {
    }
    diagnostic_updater::DiagnosticStatusWrapper status;
    diagnostics_.report(monitor_, 3, status);
    for (const auto& entry : status.values)
    {
      value_[entry.key] = entry.value;
    }
    return status.level;
  }

  core::ResponseMonitor monitor_{core::MonitorOptions()};
  MonitorDiagnostics diagnostics_{"a test rig"};
  std::map<std::string, std::string> value_;
};

TEST_F(MonitorDiagnosticsTest, sumsUp)
{
  addBlock(100, {2.0e-3, -1.0e-3}, {0.0, 4.0});
  addBlock(102, {1.0e-3, 3.0e-3}, {0.0, 0.0});
  monitor_.addImpact(toReleasedImpact(impactOf(7, 0.5, 5.0)));
  monitor_.addImpact(toReleasedImpact(impactOf(8, 0.25, 3.0)));
  EXPECT_EQ(report(), DiagnosticStatus::OK);
  EXPECT_EQ(value_["Samples of gap"], "4");
  EXPECT_EQ(value_["Samples of force"], "4");
  EXPECT_EQ(value_["Samples of gap missing"], "0");
  EXPECT_EQ(value_["Impacts"], "2");
  EXPECT_EQ(value_["Smallest gap (m)"], "-0.001");
  EXPECT_EQ(value_["Share of time in contact"], "0.250000");
  EXPECT_EQ(value_["Greatest force (N)"], "5");
  EXPECT_EQ(value_["Impulse of all impacts (N s)"], "0.75");
  EXPECT_EQ(value_["Greatest impulse (N s)"], "0.5");
  EXPECT_EQ(value_["Contact changes"], "3");
  EXPECT_EQ(value_["Wear coefficient from"], "a test rig");
}

TEST_F(MonitorDiagnosticsTest, sawWhatIsMissingAndWarnsOnce)
{
  addBlock(0, {1.0}, {0.0});
  addBlock(5, {1.0}, {0.0});
  monitor_.addImpact(toReleasedImpact(impactOf(0, 0.0, 0.0)));
  monitor_.addImpact(toReleasedImpact(impactOf(3, 0.0, 0.0)));
  EXPECT_EQ(report(), DiagnosticStatus::WARN);
  EXPECT_EQ(value_["Samples of gap missing"], "4");
  EXPECT_EQ(value_["Samples of force missing"], "4");
  EXPECT_EQ(value_["Impacts missing"], "2");
  EXPECT_EQ(report(), DiagnosticStatus::OK);
}

TEST_F(MonitorDiagnosticsTest, warnsOnceOfWhatNoSimulatorSays)
{
  vibro_impact::Impact impact = impactOf(0, 0.0, 0.0);
  impact.duration = -1.0;
  monitor_.addImpact(toReleasedImpact(impact));
  EXPECT_EQ(report(), DiagnosticStatus::WARN);
  EXPECT_EQ(value_["Messages refused"], "1");
  EXPECT_EQ(report(), DiagnosticStatus::OK);
}

TEST_F(MonitorDiagnosticsTest, survivesABlockThatNoSimulatorSends)
{
  vibro_impact::ContactForce force;
  force.header.stamp = ros::Time(4294967295, 0);  // the last second that a stamp can hold
  force.sample_period = 1.0;
  force.force = {0.0};
  monitor_.addForce(toBlock(force));
  force.header.stamp = vibro_impact::graph::toTime(start);
  force.sample_period = 1.0e6;
  monitor_.addForce(toBlock(force));
  EXPECT_EQ(report(), DiagnosticStatus::WARN);
  EXPECT_EQ(value_["Messages refused"], "2");
  EXPECT_EQ(value_["Samples of force"], "0");
  // The latest statistics that can be become a message.
  force.header.stamp = ros::Time(4294967293, 0);
  force.sample_period = 1.0;
  monitor_.addForce(toBlock(force));
  EXPECT_EQ(report(), DiagnosticStatus::OK);
  vibro_impact::ImpactStatistics message;
  toMessage(monitor_, 0, message);
  EXPECT_EQ(message.header.stamp, ros::Time(4294967294, 0));
}

TEST(MonitorMessages, theStatisticsSayWhatTheMonitorSays)
{
  core::MonitorOptions options;
  options.wear = {2.0e-14, 1.0e-6, 0.5, 0.0};
  options.drive_frequency = 50.0;
  core::ResponseMonitor monitor(options);
  const std::vector<double> force(1000, 1.0);
  monitor.addForce({0, start, 1.0e-3, force.data(), force.size()});
  for (std::uint64_t i = 0; i < 40; ++i)
  {
    vibro_impact::Impact impact = impactOf(i, i % 2 == 0 ? 1.0e-3 : 2.0e-3, 3.0);
    impact.header.stamp = vibro_impact::graph::toTime(start + static_cast<core::StreamTime>(i) * 20'000'000);
    impact.energy_lost = 1.0e-4;
    monitor.addImpact(toReleasedImpact(impact));
  }
  while (monitor.next(true) != nullptr)
  {
  }
  vibro_impact::ImpactStatistics message;
  toMessage(monitor, 2, message);
  EXPECT_EQ(message.header.stamp, vibro_impact::graph::toTime(start + 1'000'000'000));
  EXPECT_EQ(message.header.frame_id, "base_frame");
  EXPECT_EQ(message.impacts, 40u);
  EXPECT_DOUBLE_EQ(message.impact_rate, 40.0);
  EXPECT_NEAR(message.impulse_mean, 1.5e-3, 1.0e-12 * 1.5e-3);
  EXPECT_NEAR(message.impulse_rms, std::sqrt(2.5e-6), 1.0e-12 * std::sqrt(2.5e-6));
  EXPECT_EQ(message.impulse_max, 2.0e-3);
  EXPECT_EQ(message.histogram.size(), message.histogram_edges.size() + 1);
  EXPECT_EQ(message.peak_force, 3.0);
  EXPECT_DOUBLE_EQ(message.contact_duty, 1.0);
  EXPECT_NEAR(message.mean_force, 0.06, 1.0e-12 * 0.06);
  EXPECT_NEAR(message.impact_power, 4.0e-3, 1.0e-12 * 4.0e-3);
  EXPECT_NEAR(message.normal_work_rate, 0.03, 1.0e-12 * 0.03);
  EXPECT_NEAR(message.wear_rate, 6.0e-16, 1.0e-12 * 6.0e-16);
  EXPECT_EQ(message.drive_frequency, 50.0);
  EXPECT_EQ(message.period, 2u);
  EXPECT_DOUBLE_EQ(message.period_time, 0.04);
  EXPECT_EQ(message.total_impacts, 40u);
  EXPECT_DOUBLE_EQ(message.total_time, 1.0);
  EXPECT_NEAR(message.total_normal_work, 0.03, 1.0e-12 * 0.03);
  EXPECT_NEAR(message.wear_volume, 6.0e-16, 1.0e-12 * 6.0e-16);
  EXPECT_NEAR(message.wear_depth, 6.0e-10, 1.0e-12 * 6.0e-10);
  EXPECT_EQ(message.contact_changes, 2u);
}

TEST(HeldContact, countsChangesAndLeavesWhatCannotBeRead)
{
  vibro_impact::graph::HeldContact held;
  vibro_impact::ModelInfo info;
  info.configuration = "contact: 3";
  EXPECT_FALSE(held.take(info));
  EXPECT_FALSE(held.contact());
  const std::string rest =
      "beam1: {youngs_modulus: 1.0e+9, density: 1000.0, length: 0.1, height: 0.001, width: 0.01, "
      "contact_location: 0.05}\nbeam2: rigid\ndamping: {free: 0.01, contact: 0.05}\n"
      "basis: {type: attachment, modes_per_beam: 2}\n";
  info.configuration = rest + "contact: {stiffness: 1000.0, clearance: 1.0e-7}\n";
  EXPECT_TRUE(held.take(info));
  EXPECT_FALSE(held.take(info)) << "the same once more";
  EXPECT_TRUE(held.unchanged());
  EXPECT_EQ(held.changes(), 0u);
  info.number = 1;
  info.configuration = rest + "contact: {stiffness: 1000.0, clearance: 2.0e-7}\n";
  EXPECT_TRUE(held.take(info));
  EXPECT_EQ(held.contact()->clearance, 2.0e-7);
  EXPECT_FALSE(held.unchanged());
  EXPECT_EQ(held.changes(), 1u);
}

}  // namespace
