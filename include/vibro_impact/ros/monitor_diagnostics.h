#pragma once

#include <cstdint>
#include <string>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <vibro_impact/AlarmArray.h>

#include "vibro_impact/core/response_monitor.h"

namespace vibro_impact::graph
{
/// What a monitor says of itself on /diagnostics, one status per concern.
class MonitorDiagnostics
{
public:
  /// `wear_source`: where the wear coefficient comes from; empty: there is none.
  explicit MonitorDiagnostics(std::string wear_source);

  /// Response: what came since the start; a warning where something was missing or refused since the last report.
  void report(const core::ResponseMonitor& monitor, std::uint64_t contact_changes,
              diagnostic_updater::DiagnosticStatusWrapper& status);

  /// Alarms: as severe as the worst one that is active; the value of each is its text.
  static void report(const AlarmArray& alarms, diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  std::string wear_source_;
  std::uint64_t reported_missing_ = 0;
  std::uint64_t reported_refused_ = 0;
};

}  // namespace vibro_impact::graph
