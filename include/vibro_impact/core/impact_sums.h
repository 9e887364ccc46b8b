#pragma once

#include <cstdint>

#include "vibro_impact/core/stream_time.h"

namespace vibro_impact::core
{
/// What a monitor keeps of an impact.
struct ReleasedImpact
{
  std::uint64_t number = 0;  ///< since the motion began, from 0
  StreamTime onset = 0;
  StreamTime release = 0;
  double duration = 0.0;     ///< s
  double impulse = 0.0;      ///< N s
  double peak_force = 0.0;   ///< N
  double energy_lost = 0.0;  ///< J
  bool cut_short = false;    ///< not the whole episode
};

/// Sums over impacts, in the order in which they are added. Those that are cut short are no sample of what an impact is
/// like; but their force was there.
struct ImpactSums
{
  std::uint64_t whole = 0;
  std::uint64_t cut_short = 0;
  double whole_impulse = 0.0;    ///< of the whole ones, N s
  double impulse_squares = 0.0;  ///< of the whole ones, (N s)^2
  double impulse_max = 0.0;      ///< of the whole ones, N s
  double impulse = 0.0;          ///< of all, N s
  double mean_forces = 0.0;      ///< sum of impulse/duration of all, N
  double peak_force = 0.0;       ///< greatest of all, N
  double energy_lost = 0.0;      ///< by all, J

  void add(const ReleasedImpact& impact);

  /// Of the whole ones; 0 without any, N s.
  double impulseMean() const;
  /// Root of the mean square, likewise.
  double impulseRms() const;
};

}  // namespace vibro_impact::core
