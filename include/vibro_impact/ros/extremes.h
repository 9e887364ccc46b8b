#pragma once

#include <cstdint>
#include <vector>

#include "vibro_impact/ros/samples.h"

namespace vibro_impact::graph
{
/// The extremes of one stretch of samples.
struct Extremes
{
  double force = 0.0;  ///< greatest contact force, N
  Stamp stamp = 0;     ///< of the first sample with that force, ns
  double gap = 0.0;    ///< smallest gap, m
};

/// Thins gap and force out to a rate that plotting tools follow, without losing a peak: every stretch gives its
/// extremes.
///
/// Stretches are counted in samples, so that a stream gives the same ones at whatever speed it is played and however it
/// is cut into blocks. One that is open at a restart goes on.
class ExtremesHold
{
public:
  /// `rate`: stretches per second of the stream's time, > 0.
  explicit ExtremesHold(double rate);

  /// Takes a block's answers (same stamp, period and number of samples). The extremes of every stretch that ended in
  /// it; they hold until the next call.
  const std::vector<Extremes>& take(const Samples& gap, const Samples& force);

private:
  double rate_;
  std::uint64_t taken_ = 0;  ///< samples of the open stretch
  Extremes open_;
  std::vector<Extremes> ended_;
};

}  // namespace vibro_impact::graph
