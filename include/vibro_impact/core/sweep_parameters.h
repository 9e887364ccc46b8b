#pragma once

namespace vibro_impact::core
{
enum class SweepLaw
{
  linear,      ///< constant rate in Hz/s
  logarithmic  ///< constant rate in octaves per minute
};

/// A sine whose frequency glides from start to stop, up or down.
struct SweptSineParameters
{
  SweepLaw law = SweepLaw::linear;
  double acceleration = 0.0;         ///< amplitude, m/s^2, >= 0
  double reference_frequency = 1.0;  ///< what the frequencies are given in, Hz, > 0
  double start_frequency = 0.0;      ///< times reference_frequency, > 0
  double stop_frequency = 0.0;       ///< the same, not the start frequency
  double duration = 0.0;             ///< s, > 0
  double soft_start_cycles = 0.0;    ///< cosine ramp over the first cycles, >= 0
};

}  // namespace vibro_impact::core
