#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "vibro_impact/core/response.h"
#include "vibro_impact/core/sine_fit.h"

namespace vibro_impact::core
{
struct StepSearchOptions
{
  int shortest_step = 4;             ///< in drive cycles, >= 4
  double amplitude_tolerance = 0.1;  ///< largest deviation of a cycle's amplitude from its step's, relative, in (0, 1)
  double lowest_frequency = 1.0;     ///< of a drive to look for, Hz, > 0
  double largest_residual = 0.2;     ///< noise and distortion left by a cycle's fit, relative to its amplitude, > 0
};

/// A stretch of samples over which frequency and amplitude of the drive are constant.
struct FoundStep
{
  std::uint64_t first = 0;  ///< number of its first sample
  std::uint64_t last = 0;   ///< number of the sample after its last one
  double frequency = 0.0;   ///< as the phases of its cycles tell it, rad/s
  double amplitude = 0.0;   ///< median of its cycles', in the unit of the samples
};

/// Finds the steps of a stepped sine in its samples, as they stream by; keeps a few numbers per drive cycle, no
/// samples.
///
/// Each cycle is cut out where the signal rises through its middle, and gives one phase and one amplitude by a sine fit
/// of its own. Phase against time is then cut into straight lines where the noise leaves no other choice: every line is
/// a frequency. Lines that only approximate a curve, the phase of a swept sine, are told apart by the frequency
/// drifting within them as fast as it changes between them. Within a line the stretches of constant amplitude are the
/// steps: rests and soft starts fall out. Steps need be neither coherent in phase nor cut on a sample.
class DriveStepFinder
{
public:
  /// `sample_period` in s, finite and > 0. Throws std::invalid_argument for a value out of range.
  explicit DriveStepFinder(double sample_period, const StepSearchOptions& options = {});
  ~DriveStepFinder();
  DriveStepFinder(DriveStepFinder&&) noexcept;
  DriveStepFinder& operator=(DriveStepFinder&&) noexcept;

  /// Takes `count` samples of which the first has the number `first`. Numbers ascend; where some are missing, or a
  /// sample is not finite, the drive counts as interrupted.
  void add(std::uint64_t first, const double* samples, std::size_t count);

  /// The steps found, by ascending sample number; empty for a drive that has none.
  std::vector<FoundStep> finish();

private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// A step as a four-parameter sine fit over the whole of it measures it.
struct MeasuredStep
{
  std::uint64_t first = 0;  ///< number of its first sample
  std::uint64_t last = 0;   ///< number of the sample after its last one
  SineFit fit;              ///< of all but half a cycle at either end, where a boundary may be off by as much
};

/// Measures the steps found, in a second pass over the same samples.
class DriveStepMeter
{
public:
  /// `steps` as DriveStepFinder::finish() gave them.
  DriveStepMeter(const std::vector<FoundStep>& steps, double sample_period);

  /// Takes samples by ascending number, those of every step without a gap.
  void add(std::uint64_t first, const double* samples, std::size_t count);

  /// One entry per step; throws std::logic_error if samples of a step have not been seen.
  std::vector<MeasuredStep> finish() const;

private:
  struct Piece
  {
    FoundStep step;
    std::uint64_t fit_first;
    SineFitter fitter;
  };
  std::vector<Piece> pieces_;
  std::size_t current_ = 0;
};

/// Both passes over `count` samples in memory, the first of which is number 0.
std::vector<MeasuredStep> findDriveSteps(const double* samples, std::size_t count, double sample_period,
                                         const StepSearchOptions& options = {});

/// The step on the time axis that starts at sample 0.
DriveStep driveStep(const MeasuredStep& step, double sample_period);

}  // namespace vibro_impact::core
