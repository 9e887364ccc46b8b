#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "vibro_impact/core/archard_wear.h"
#include "vibro_impact/core/drive_frequency.h"
#include "vibro_impact/core/impulse_histogram.h"
#include "vibro_impact/core/response_statistics.h"
#include "vibro_impact/core/sample_block.h"
#include "vibro_impact/core/stream_counter.h"
#include "vibro_impact/core/time_intervals.h"

namespace vibro_impact::core
{
struct MonitorOptions
{
  StreamTime window = 1'000'000'000;            ///< ns
  StreamTime report_period = 200'000'000;       ///< ns
  StreamTime settling_time = 500'000'000;       ///< ns
  ImpulseHistogram histogram{1e-9, 100.0, 44};  ///< its classes: four in a decade
  ArchardWear wear;
  double drive_frequency = 0.0;      ///< 0: measured in the excitation, Hz
  double period_tolerance = 1.0e-4;  ///< ResponseOptions::tolerance
};

/// Sums up the answers of a simulator in the time of their stream: at whatever speed they come, the same answers give
/// the same statistics.
///
/// The blocks of contact force tell the time. Impacts arrive by a way of their own, and may be overtaken by the force
/// of their block; but among themselves they are in order. Statistics of an instant are therefore made when the force
/// has reached it and an impact has come that was released later, or, where there are none, when the force has gone on
/// for the settling time. An impact that comes later still is counted as late; it is in the totals of the next
/// statistics.
///
/// Where time goes back or leaves out more than a window, another stretch of time begins, with instants of its own.
/// Back: the window is emptied, the totals go on. Impacts and force may each be the first to go back: impacts of the
/// stretch that is to come wait for its first block, and those of the last one that come after it are late.
///
/// What no simulator says is refused and counted: numbers that are not finite, a sample period outside of
/// [min_sample_period, max_sample_period], a block that ends at end_of_time or later; and a block of force with more
/// than `most_reports_per_block` report periods, all of whose statistics would be due at once.
class ResponseMonitor
{
public:
  /// Stamps may go back by this much and are still those of the same stream, ns.
  static constexpr StreamTime max_step_back = 100'000'000;
  /// Longest duration of an impact, s.
  static constexpr double longest = 1.0e6;
  /// Report periods in a block of force.
  static constexpr double most_reports_per_block = 10000.0;
  /// Impacts that are looked at for a period.
  static constexpr std::size_t period_impacts = 1000;

  explicit ResponseMonitor(const MonitorOptions& options);

  void addImpact(const ReleasedImpact& impact);

  /// m
  void addGap(const SampleBlock& gap);

  /// Base acceleration, m/s^2; its frequency alone is of interest.
  void addExcitation(const SampleBlock& acceleration);

  /// N
  void addForce(const SampleBlock& force);

  /// Statistics that are due, in the order of time: those at the end of a stretch that another one has followed, and
  /// those of each multiple of the report period since a stretch began. To be asked until there are none, before the
  /// next block comes; they hold until the next ones are made.
  ///
  /// `silent`: nothing has come for a while. Then nothing is waited for, and the last ones are those at the end of the
  /// last block.
  const ResponseStatistics* next(bool silent = false);

  const StreamCounter& gapSamples() const
  {
    return gap_samples_;
  }
  const StreamCounter& forceSamples() const
  {
    return force_samples_;
  }
  const StreamCounter& impacts() const
  {
    return impact_counter_;
  }
  std::uint64_t missing() const
  {
    return gap_samples_.missing() + force_samples_.missing() + impact_counter_.missing();
  }
  /// Blocks and impacts.
  std::uint64_t refused() const
  {
    return refused_;
  }
  std::uint64_t lateImpacts() const
  {
    return late_impacts_;
  }
  /// How often the impacts were counted anew or time went back.
  std::uint64_t restarts() const
  {
    return impact_counter_.restarts() + steps_back_;
  }
  /// Infinite before the first sample, m.
  double smallestGap() const
  {
    return smallest_gap_;
  }
  /// Of all samples and impacts that came, N.
  double peakForce() const
  {
    return peak_force_;
  }
  /// Of the classes that ResponseStatistics::histogram counts.
  const std::vector<double>& histogramEdges() const
  {
    return histogram_.edges();
  }
  /// The last ones made.
  const ResponseStatistics& statistics() const
  {
    return statistics_;
  }

private:
  void takeForce(const SampleBlock& force);
  const ResponseStatistics& report(StreamTime time);
  void sumUp(StreamTime from);
  int period() const;
  /// Whether time has gone back since, to be told by the force alone so far: such an impact is late.
  bool isLeftBehind(const ReleasedImpact& impact) const;
  /// The impacts before are of another stretch of time: in the totals, but in no window.
  void leaveImpacts();
  void beginStretch(StreamTime stamp);

  MonitorOptions options_;
  ImpulseHistogram histogram_;
  DriveFrequency excitation_;
  StreamCounter gap_samples_;
  StreamCounter force_samples_;
  StreamCounter impact_counter_;
  std::uint64_t refused_ = 0;
  std::uint64_t late_impacts_ = 0;
  std::uint64_t steps_back_ = 0;
  double smallest_gap_ = std::numeric_limits<double>::infinity();
  double peak_force_ = 0.0;

  std::deque<ReleasedImpact> impacts_;  ///< in order of release: those of the window, and those yet to be counted
  std::size_t counted_ = 0;             ///< of them, in `total_`
  std::deque<std::deque<ReleasedImpact>> ahead_;  ///< of the next stretches, whose blocks are still to come
  std::optional<ReleasedImpact> last_impact_;     ///< of whatever stretch
  bool impacts_behind_ = false;                   ///< time went back, and the impacts have not followed yet
  StreamTime left_end_ = 0;                       ///< end of the stretch from which it went back
  std::optional<StreamTime> newest_release_;      ///< of the impacts of this stretch
  ImpactSums total_;

  bool started_ = false;
  TimeIntervals heard_;
  TimeIntervals contact_;
  std::uint64_t stretch_ = 0;  ///< how many have begun
  StreamTime stretch_begin_ = 0;
  StreamTime end_ = 0;  ///< of the last block
  StreamTime total_heard_ = 0;
  StreamTime total_contact_ = 0;
  StreamTime next_report_ = 0;
  std::optional<StreamTime> reported_;
  bool fresh_ = false;                      ///< something came since the last statistics
  std::deque<ResponseStatistics> closing_;  ///< those up to the end of the last stretch, not yet given away
  ResponseStatistics statistics_;
};

}  // namespace vibro_impact::core
