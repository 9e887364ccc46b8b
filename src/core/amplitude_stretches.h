#pragma once

#include <cstddef>
#include <vector>

#include "drive_cycles.h"
#include "phase_lines.h"
#include "vibro_impact/core/drive_steps.h"

namespace vibro_impact::core
{
/// The cycles [first, last) of a run.
struct AmplitudeStretch
{
  std::size_t first;
  std::size_t last;
};

/// Finds the stretches of a run over which the amplitude is constant: rests, ramps and soft starts lie between them.
class AmplitudeStretches
{
public:
  /// Keeps a reference to the cycles; of the options the shortest step and the amplitude's tolerance count.
  AmplitudeStretches(const std::vector<DriveCycle>& cycles, const StepSearchOptions& options);

  /// The stretches of constant amplitude within a line, in order, none shorter than the shortest step.
  std::vector<AmplitudeStretch> within(const PhaseLine& line) const;

  /// Of a stretch of at least one cycle, in the unit of the samples.
  double medianAmplitude(const AmplitudeStretch& stretch) const;

private:
  std::vector<double> amplitudes(const AmplitudeStretch& stretch) const;
  void search(std::size_t first, std::size_t last, double tolerance, std::vector<AmplitudeStretch>& found) const;
  double amplitudeAt(std::size_t k, std::size_t first, std::size_t last) const;
  double commonestAmplitude(std::size_t first, std::size_t last, double tolerance) const;
  AmplitudeStretch trim(AmplitudeStretch stretch) const;
  double scatter(const AmplitudeStretch& stretch) const;
  double rise(const AmplitudeStretch& stretch) const;

  const std::vector<DriveCycle>& cycles_;
  std::size_t shortest_;  // in cycles
  double tolerance_;      // relative
};

}  // namespace vibro_impact::core
