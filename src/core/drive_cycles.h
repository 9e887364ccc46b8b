#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vibro_impact/core/drive_steps.h"

namespace vibro_impact::core
{
/// What one drive cycle says of the drive. Times are in samples.
struct DriveCycle
{
  std::uint64_t first = 0;  // its first sample
  std::uint64_t last = 0;   // the sample after its last one
  double time = 0.0;        // its middle
  double phase = 0.0;       // there, unwrapped along its run, rad
  double amplitude = 0.0;   // in the unit of the samples
  double advance = 0.0;     // phase per sample as its length tells it, rad
  double weight = 0.0;  // inverse square of the phase's standard deviation, rad^-2; unknown here, phaseLines() sets it
};

/// Follows a drive through its samples from cycle to cycle and fits a sine to each. Cycles that follow one another, but
/// for a few that a spike has spoilt, make a run; their phases are unwrapped, so that they grow along it.
class DriveCycleFollower
{
public:
  /// `sample_period` in s; of the options the lowest frequency and the largest residual count. Both are in range.
  DriveCycleFollower(double sample_period, const StepSearchOptions& options);

  /// As DriveStepFinder::add().
  void add(std::uint64_t first, const double* samples, std::size_t count);

  /// How many runs there are so far.
  std::size_t runs() const;

  /// The cycles of run `i` < runs(), one or more, by ascending time.
  std::vector<DriveCycle> run(std::size_t i) const;

private:
  void start(std::uint64_t first, double x);
  void takeSample(double x);
  void startCycle(double time);
  void takeCycle(double length);
  bool follows(const DriveCycle& cycle) const;

  double sample_period_;
  double largest_residual_;

  // The signal since its last interruption.
  std::uint64_t number_ = 0;  // of the next sample
  bool started_ = false;
  bool interrupted_ = true;  // since the last cycle
  std::size_t memory_;       // samples over which the range of the signal is remembered: one to two times as many
  std::size_t in_memory_ = 0;
  double low_ = 0.0;
  double high_ = 0.0;
  double before_low_ = 0.0;
  double before_high_ = 0.0;
  bool locked_ = false;  // onto good cycles
  std::uint64_t locked_until_ = 0;
  bool rising_ = false;
  double turning_ = 0.0;  // the extreme since the last turn
  double last_sample_ = 0.0;

  // The cycle under way.
  bool onset_known_ = false;
  double onset_ = 0.0;
  std::vector<double> samples_;  // since the last crossing

  std::vector<DriveCycle> cycles_;
  std::vector<std::size_t> starts_of_runs_;  // the first cycle of each
};

}  // namespace vibro_impact::core
