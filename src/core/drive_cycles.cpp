#include "drive_cycles.h"

#include <algorithm>
#include <cmath>

#include "drive_phase.h"
#include "vibro_impact/core/sine_fit.h"

namespace vibro_impact::core
{
namespace
{
// Samples that the fit of a single cycle needs.
constexpr std::size_t fewest_samples_per_cycle = 8;
// Cycles that may be missing between two of one run: a spike spoils one or two.
constexpr double longest_hole = 6.5;
// Cycles without a good one after which the amplitude of the last good one is no guide any more.
constexpr double cycles_until_lost = 2.5;
}  // namespace

DriveCycleFollower::DriveCycleFollower(double sample_period, const StepSearchOptions& options)
    : sample_period_(sample_period),
      largest_residual_(options.largest_residual),
      memory_(static_cast<std::size_t>(std::ceil(1.0 / (options.lowest_frequency * sample_period))))
{
}

void DriveCycleFollower::add(std::uint64_t first, const double* samples, std::size_t count)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    if (!std::isfinite(samples[i]))
    {
      started_ = false;
      continue;
    }
    if (!started_ || first + i != number_)
    {
      start(first + i, samples[i]);
    }
    takeSample(samples[i]);
  }
}

std::size_t DriveCycleFollower::runs() const
{
  return starts_of_runs_.size();
}

std::vector<DriveCycle> DriveCycleFollower::run(std::size_t i) const
{
  const std::size_t first = starts_of_runs_[i];
  const std::size_t last = i + 1 < starts_of_runs_.size() ? starts_of_runs_[i + 1] : cycles_.size();
  return {cycles_.begin() + static_cast<std::ptrdiff_t>(first), cycles_.begin() + static_cast<std::ptrdiff_t>(last)};
}

// Begins anew with the sample of this number: what came before is not connected with it.
void DriveCycleFollower::start(std::uint64_t first, double x)
{
  started_ = true;
  interrupted_ = true;
  number_ = first;
  samples_.clear();
  in_memory_ = 0;
  low_ = high_ = before_low_ = before_high_ = turning_ = last_sample_ = x;
  locked_ = false;
  rising_ = false;
  onset_known_ = false;
}

// Follows the signal from turning point to turning point. A rise by a third of its range ends a cycle and begins the
// next: noise does not reach that far, and no offset matters. The range is that of the last good cycle, whatever
// spikes there are; where the cycles are lost, that of the recent samples.
void DriveCycleFollower::takeSample(double x)
{
  if (locked_ && number_ > locked_until_)
  {
    locked_ = false;
    in_memory_ = 0;
    low_ = high_ = before_low_ = before_high_ = x;
  }
  low_ = std::min(low_, x);
  high_ = std::max(high_, x);
  const double range =
      locked_ ? 2.0 * cycles_.back().amplitude : std::max(high_, before_high_) - std::min(low_, before_low_);
  const double reach = range / 3.0;
  if (rising_)
  {
    turning_ = std::max(turning_, x);
    if (turning_ - x > reach)
    {
      rising_ = false;
      turning_ = x;
    }
  }
  else
  {
    turning_ = std::min(turning_, x);
    const double level = turning_ + reach;
    if (x > level)
    {
      rising_ = true;
      turning_ = x;
      const double into = level > last_sample_ ? (level - last_sample_) / (x - last_sample_) : 0.0;
      startCycle(static_cast<double>(number_) - 1.0 + into);
    }
  }
  last_sample_ = x;
  samples_.push_back(x);
  ++number_;
  if (++in_memory_ >= memory_)
  {
    before_low_ = low_;
    before_high_ = high_;
    low_ = high_ = x;
    in_memory_ = 0;
  }
  if (samples_.size() > 2 * memory_)
  {
    samples_.clear();
    onset_known_ = false;
  }
}

// `time`: of the crossing, between the sample before the present one and the present one.
void DriveCycleFollower::startCycle(double time)
{
  if (onset_known_)
  {
    takeCycle(time - onset_);
  }
  samples_.clear();
  onset_ = time;
  onset_known_ = true;
}

// The samples since the last crossing are one cycle of the given length.
void DriveCycleFollower::takeCycle(double length)
{
  const std::size_t count = samples_.size();
  if (count < fewest_samples_per_cycle)
  {
    return;
  }
  // Very few samples cannot tell the third harmonic from noise.
  const int harmonics = count < 12 ? 2 : SineFitter::most_harmonics;
  SineFitter fitter(two_pi / (length * sample_period_), sample_period_, count, harmonics);
  fitter.add(samples_.data(), count);
  const SineFit fit = fitter.knownFrequency();
  if (!(fit.residual < largest_residual_ * fit.amplitude))
  {
    return;
  }
  DriveCycle cycle;
  cycle.last = number_;
  cycle.first = cycle.last - count;
  cycle.time = 0.5 * (static_cast<double>(cycle.first) + static_cast<double>(cycle.last - 1));
  cycle.amplitude = fit.amplitude;
  cycle.advance = two_pi / length;
  cycle.phase = fit.phase;
  if (interrupted_ || !follows(cycle))
  {
    starts_of_runs_.push_back(cycles_.size());
    interrupted_ = false;
  }
  else
  {
    const DriveCycle& before = cycles_.back();
    const double expected = before.phase + 0.5 * (before.advance + cycle.advance) * (cycle.time - before.time);
    cycle.phase = expected + std::remainder(fit.phase - expected, two_pi);
  }
  cycles_.push_back(cycle);
  locked_ = true;
  locked_until_ = number_ + static_cast<std::uint64_t>(cycles_until_lost * length);
}

// Whether a cycle carries on the run of the last one.
bool DriveCycleFollower::follows(const DriveCycle& cycle) const
{
  const DriveCycle& before = cycles_.back();
  return (cycle.time - before.time) * std::min(cycle.advance, before.advance) < longest_hole * two_pi;
}

}  // namespace vibro_impact::core
