#pragma once

#include <cstdint>
#include <vector>

#include "vibro_impact/core/sine_band.h"

namespace vibro_impact::core
{
/// A sine of constant frequency and amplitude.
struct SineParameters
{
  double acceleration = 0.0;         ///< amplitude, m/s^2, >= 0
  double reference_frequency = 1.0;  ///< what the frequency is given in, Hz, > 0
  double frequency = 0.0;            ///< times reference_frequency, > 0
  double cycles = 0.0;               ///< > 0
  double soft_start_cycles = 0.0;    ///< cosine ramp of the amplitude over the first cycles, from 0 to `cycles`
};

/// Steps of constant frequency, each of the same whole number of cycles, from a start frequency up or down to a stop
/// frequency.
struct SteppedSineParameters
{
  double acceleration = 0.0;         ///< amplitude of every step, m/s^2, >= 0
  double reference_frequency = 1.0;  ///< what the frequencies are given in, Hz, > 0
  double start_frequency = 0.0;      ///< times reference_frequency, > 0
  double stop_frequency = 0.0;       ///< the same; the last step is the last one that does not lie beyond it
  double frequency_step = 0.0;       ///< the same, > 0 also for steps downwards
  std::int64_t cycles_per_step = 0;  ///< >= 1
  double soft_start_cycles =
      0.0;            ///< cosine ramp over the first cycles and after every rest, from 0 to `cycles_per_step`
  double rest = 0.0;  ///< without drive between two steps, s, >= 0
};

/// Dwells at frequencies at equal distances through one band after the other. Each lasts whole cycles, and begins at
/// phase zero.
struct SineDwellParameters
{
  std::vector<SineBand> bands;  ///< in their order, each upwards, downwards or of one frequency; at least one
  double frequency_step = 1.0;  ///< Hz, > 0; the last one of a band is the last one that does not lie beyond `to`
  double dwell = 0.0;           ///< at each frequency, s, > 0; rounded up to whole cycles
  double ramp_cycles = 0.0;  ///< over the first cycles of each dwell the amplitude of the acceleration comes from that
                             ///< of the one before, or from zero, by a cosine ramp; >= 0, shorter than each dwell
};

/// A dwell at one frequency.
struct SineDwell
{
  double frequency = 0.0;     ///< Hz
  double acceleration = 0.0;  ///< amplitude, m/s^2
  double cycles = 0.0;        ///< a whole number
};

/// The frequencies of the steps in their order, Hz.
std::vector<double> stepFrequencies(const SteppedSineParameters& parameters);

/// The dwells in their order.
std::vector<SineDwell> sineDwells(const SineDwellParameters& parameters);

}  // namespace vibro_impact::core
