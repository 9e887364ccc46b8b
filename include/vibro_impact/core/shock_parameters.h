#pragma once

#include <cstdint>

namespace vibro_impact::core
{
enum class ShockShape
{
  half_sine,
  terminal_peak_sawtooth  ///< rises in proportion to time and falls from its peak within a sample
};

/// Equal pulses of acceleration. Nothing brings the base to rest after one: each leaves it with velocityChange().
struct ShockParameters
{
  ShockShape shape = ShockShape::half_sine;
  double peak = 0.0;             ///< m/s^2, not 0; a negative one for a pulse in the negative direction
  double duration = 0.0;         ///< of a pulse, s; at least 10 samples
  double before = 0.0;           ///< without acceleration before the first pulse, s, >= 0
  double after = 0.0;            ///< after the last one, s, >= 0; it ends at zero acceleration in any case
  std::int64_t repetitions = 1;  ///< pulses, >= 1
  double interval = 0.0;         ///< from the start of a pulse to that of the next, s, > duration where there is a next
};

/// By how much a pulse changes the velocity of the base, m/s: 2 A T/pi (half sine), A T/2 (sawtooth).
double velocityChange(const ShockParameters& parameters);

/// The same of its samples at `sample_rate` (Hz) with straight lines between them, of a pulse that begins with one. The
/// fall of a sawtooth takes a sample: A (T + 1/sample_rate)/2 where the duration is a whole number of samples.
double velocityChange(const ShockParameters& parameters, double sample_rate);

}  // namespace vibro_impact::core
