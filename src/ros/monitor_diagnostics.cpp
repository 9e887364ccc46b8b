#include "vibro_impact/ros/monitor_diagnostics.h"

#include <utility>

namespace vibro_impact::graph
{
using diagnostic_msgs::DiagnosticStatus;

MonitorDiagnostics::MonitorDiagnostics(std::string wear_source) : wear_source_(std::move(wear_source))
{
}

void MonitorDiagnostics::report(const core::ResponseMonitor& monitor, std::uint64_t contact_changes,
                                diagnostic_updater::DiagnosticStatusWrapper& status)
{
  const core::ResponseStatistics& statistics = monitor.statistics();
  status.summary(DiagnosticStatus::OK, "listening");
  if (monitor.missing() > std::exchange(reported_missing_, monitor.missing()))
  {
    status.mergeSummary(DiagnosticStatus::WARN, "answers are missing");
  }
  if (monitor.refused() > std::exchange(reported_refused_, monitor.refused()))
  {
    status.mergeSummary(DiagnosticStatus::WARN, "answers that no simulator gives were refused");
  }
  status.add("Samples of gap", monitor.gapSamples().taken());
  status.add("Samples of gap missing", monitor.gapSamples().missing());
  status.add("Samples of force", monitor.forceSamples().taken());
  status.add("Samples of force missing", monitor.forceSamples().missing());
  status.add("Impacts", monitor.impacts().taken());
  status.add("Impacts missing", monitor.impacts().missing());
  status.add("Impacts late", monitor.lateImpacts());
  status.add("Messages refused", monitor.refused());
  status.add("Restarts", monitor.restarts());
  status.add("Contact changes", contact_changes);
  status.addf("Smallest gap (m)", "%.9g", monitor.smallestGap());
  status.addf("Greatest force (N)", "%.9g", monitor.peakForce());
  // Up to the last statistics:
  status.addf("Share of time in contact", "%.6f",
              statistics.total_time > 0.0 ? statistics.total_contact_time / statistics.total_time : 0.0);
  status.add("Impacts cut short", statistics.total.cut_short);
  status.addf("Impulse of all impacts (N s)", "%.9g", statistics.total.impulse);
  status.addf("Greatest impulse (N s)", "%.9g", statistics.total.impulse_max);
  status.addf("Impact rate (1/s)", "%.9g", statistics.impact_rate);
  status.add("Period (drive cycles)", statistics.period);
  status.addf("Normal work rate (W)", "%.9g", statistics.normal_work_rate);
  status.addf("Wear depth (m)", "%.9g", statistics.wear_depth);
  status.add("Wear coefficient from", wear_source_.empty() ? "none" : wear_source_);
}

void MonitorDiagnostics::report(const AlarmArray& alarms, diagnostic_updater::DiagnosticStatusWrapper& status)
{
  status.summary(DiagnosticStatus::OK, "no alarm");
  for (const Alarm& alarm : alarms.alarms)
  {
    if (alarm.active != 0)
    {
      status.mergeSummary(alarm.severity, alarm.name + ": " + alarm.text);
    }
    status.add(alarm.name, alarm.text);
  }
}

}  // namespace vibro_impact::graph
