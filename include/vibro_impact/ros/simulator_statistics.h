#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include "vibro_impact/core/energy_account.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
/// Counts what a simulator takes, refuses and gives, and says how it is.
class SimulatorStatistics
{
public:
  /// `topic`: name of the excitation's topic; `max_input_age`: silence after which the input is stale, s.
  SimulatorStatistics(const std::string& topic, double max_input_age);

  /// A block of `samples` samples was answered within `computing_time` (s, wall).
  void count(const StreamSimulation::Answer& answer, double computing_time);

  /// A block of a second publisher was refused.
  void countSecondPublisher(const std::string& source, const std::string& second);

  void countReset(const StreamSimulation::Answer& answer);

  /// The totals since the start, and a level for what has happened since the last report. `input_age`: wall time since
  /// the last block, s; nothing before the first.
  void report(std::optional<double> input_age, diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  struct Totals
  {
    std::uint64_t blocks_accepted = 0;
    std::uint64_t blocks_refused = 0;
    std::uint64_t blocks_of_second_publisher = 0;
    std::uint64_t blocks_lost = 0;
    std::uint64_t samples_lost = 0;
    std::uint64_t gaps_bridged = 0;
    std::uint64_t samples_bridged = 0;
    std::uint64_t restarts = 0;
    std::uint64_t resets = 0;
    std::uint64_t impacts = 0;
    std::uint64_t contact_changes = 0;
    std::uint64_t switch_limits = 0;
    double stream_time = 0.0;     ///< s
    double computing_time = 0.0;  ///< s
  };

  std::string topic_;
  double max_input_age_;
  Totals totals_;
  Totals reported_;
  double real_time_factor_ = 0.0;
  std::string last_refusal_;
  std::string publishers_;
};

/// The entries of an energy account (J), and how well it closes.
void report(const core::EnergyAccount& account, diagnostic_updater::DiagnosticStatusWrapper& status);

}  // namespace vibro_impact::graph
