#pragma once

#include <cstddef>
#include <vector>

#include "drive_cycles.h"

namespace vibro_impact::core
{
/// A straight line through the phases of the cycles [first, last) of a run: statistics that merge without cancellation.
/// Its slope is the frequency. Times are in samples.
struct PhaseLine
{
  std::size_t first = 0;
  std::size_t last = 0;
  double weight = 0.0;  // sum over its cycles, rad^-2
  double time = 0.0;    // weighted mean
  double phase = 0.0;   // weighted mean, rad
  double spread = 0.0;  // weighted sum of (t - time)^2
  double slope = 0.0;   // rad per sample

  double at(double t) const
  {
    return phase + slope * (t - time);
  }
};

/// Too short to tell a drift.
inline bool isScrap(const PhaseLine& line)
{
  return line.last - line.first < 4;
}

/// The line that fits the phases of the cycles [first, last), one or more, best; the cycles have their weights.
PhaseLine lineThrough(const std::vector<DriveCycle>& cycles, std::size_t first, std::size_t last);

/// Cuts the phases of a run of at least one cycle into lines, as few as the noise allows; in order, without a gap.
/// Gives the cycles their weights, and drops those that a spike or a jump has spoilt from the run: the lines count the
/// cycles that are left.
std::vector<PhaseLine> phaseLines(std::vector<DriveCycle>& run);

}  // namespace vibro_impact::core
