#pragma once

#include <cstdint>
#include <vector>

#include "vibro_impact/core/sine_band.h"

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

/// Where two bands of a sweep meet, the amplitude of the acceleration passes from the one's law to the other's over so
/// many octaves about their common frequency, by half a cosine in the logarithm of frequency.
constexpr double crossover_octaves = 1.0 / 16.0;

/// A sine that glides through adjoining bands at a constant rate in octaves per minute, once or to and fro.
struct BandedSweepParameters
{
  std::vector<SineBand>
      bands;                ///< upwards, each at least `crossover_octaves` wide, beginning where the one before ends
  double rate = 0.0;        ///< octaves per minute, > 0
  bool upwards = true;      ///< the first sweep; the next ones go to and fro
  std::int64_t sweeps = 1;  ///< >= 1, each through all bands; two are a sweep cycle
  double soft_start_cycles = 0.0;  ///< cosine ramp over the first cycles, >= 0
};

/// The amplitude of the acceleration (m/s^2) at a frequency (Hz) inside the bands.
double accelerationAmplitude(const std::vector<SineBand>& bands, double frequency);

}  // namespace vibro_impact::core
