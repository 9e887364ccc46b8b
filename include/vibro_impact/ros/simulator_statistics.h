#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include "vibro_impact/core/energy_account.h"
#include "vibro_impact/ros/output_queue.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
/// From where on a simulator's diagnostics are no longer OK. "Since the last report" is one diagnostic period.
struct DiagnosticThresholds
{
  double max_input_age = 1.0;           ///< silence after which the input is stale, s of wall time
  double warn_lost_samples = 0.0;       ///< WARN where more samples than this were missing since the last report
  double warn_real_time_factor = 1.5;   ///< WARN where the computing of a second took more than 1 / this, s
  double error_real_time_factor = 1.0;  ///< ERROR, likewise
  double warn_block_load = 1.0;         ///< WARN where a block took more than this times the time it lasts
  double warn_queue_share = 0.5;        ///< WARN where more than this share of an output queue is full
  double warn_energy_closure = 1.0e-6;  ///< WARN where the energy account closes worse than this
};

/// Counts what a simulator hears: what it takes, refuses and misses.
///
/// Of all samples sent since the first one taken, each is in one of the counts of accepted, refused, discarded
/// (while paused) and lost ones. Bridged are those of the refused and the lost ones that lie in short gaps.
class InputStatistics
{
public:
  /// `topic`: name of the excitation's topic.
  InputStatistics(std::string topic, const DiagnosticThresholds& thresholds);

  /// A block of `samples` samples from number `seq` on was judged.
  void count(const Verdict& verdict, std::uint64_t seq, std::size_t samples);

  /// So many single samples were refused before they could be put into a block.
  void countRefusal(const std::string& reason, std::uint64_t samples);

  /// A block of a second publisher was refused.
  void countSecondPublisher(const std::string& source, const std::string& second, std::size_t samples);

  /// A block came while the simulator was paused.
  void countDiscarded(std::size_t samples);

  /// The totals since the start, and a level for what has happened since the last report. `input_age`: wall time since
  /// the last block, s; nothing before the first.
  void report(std::optional<double> input_age, bool paused, diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  struct Totals
  {
    std::uint64_t blocks_accepted = 0;
    std::uint64_t blocks_refused = 0;
    std::uint64_t blocks_of_second_publisher = 0;
    std::uint64_t blocks_discarded = 0;
    std::uint64_t blocks_lost = 0;
    std::uint64_t samples_accepted = 0;
    std::uint64_t samples_refused = 0;
    std::uint64_t samples_discarded = 0;
    std::uint64_t samples_lost = 0;
    std::uint64_t samples_bridged = 0;
    std::uint64_t gaps_bridged = 0;
    std::uint64_t restarts = 0;
  };

  void noteRefused(std::uint64_t seq, std::size_t samples);
  std::uint64_t refusedWithin(std::uint64_t first, std::uint64_t end) const;

  std::string topic_;
  DiagnosticThresholds thresholds_;
  Totals totals_;
  Totals reported_;
  /// Numbers [first, end) of the samples refused since the last block taken: they came, though they are missing.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> refused_;
  std::string last_refusal_;
  std::string publishers_;
};

/// Measures how long computing takes.
class ComputingStatistics
{
public:
  explicit ComputingStatistics(const DiagnosticThresholds& thresholds);

  /// Computing and publishing the answer to a block that lasts `stream_time` took `computing_time`, s.
  void count(double stream_time, double computing_time);

  /// The real-time factor and the worst block since the last report; without a block since, those of the last one.
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  struct Period
  {
    double stream_time = 0.0;     ///< s
    double computing_time = 0.0;  ///< s
    double worst_time = 0.0;      ///< longest computing time of a block, s
    double worst_load = 0.0;      ///< greatest computing time of a block over the time it lasts
  };

  DiagnosticThresholds thresholds_;
  Period period_;
  Period reported_;
  double worst_time_ = 0.0;  ///< since the start, s
};

/// Counts what the model does.
class ModelStatistics
{
public:
  explicit ModelStatistics(const DiagnosticThresholds& thresholds);

  void count(const StreamSimulation::Answer& answer);
  void countReset(const StreamSimulation::Answer& answer);

  /// `account`: of the stream since it began.
  void report(const core::EnergyAccount& account, diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  struct Totals
  {
    std::uint64_t impacts = 0;
    std::uint64_t impacts_cut_short = 0;
    std::uint64_t contact_changes = 0;
    std::uint64_t resets = 0;
    std::uint64_t switch_limits = 0;
  };

  DiagnosticThresholds thresholds_;
  Totals totals_;
  Totals reported_;
};

/// Looks after the queues of several topics.
class OutputQueueStatistics
{
public:
  /// The queues must outlive this object.
  OutputQueueStatistics(const std::vector<const OutputQueue*>& queues, const DiagnosticThresholds& thresholds);

  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  std::vector<std::pair<const OutputQueue*, std::uint64_t>> queues_;  ///< and what was dropped as of the last report
  DiagnosticThresholds thresholds_;
};

}  // namespace vibro_impact::graph
