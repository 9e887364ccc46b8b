#pragma once

namespace vibro_impact::core
{
/// What the amplitude of a sine is given as.
enum class MotionQuantity
{
  displacement,  ///< m
  velocity,      ///< m/s
  acceleration   ///< m/s^2
};

/// Amplitude (zero to peak) of a sine that moves the base.
struct MotionAmplitude
{
  MotionQuantity quantity = MotionQuantity::acceleration;
  double value = 0.0;  ///< >= 0
};

/// The amplitude of the acceleration (m/s^2) at a frequency (Hz): (2 pi f)^2 times that of the displacement, 2 pi f
/// times that of the velocity.
double accelerationAmplitude(const MotionAmplitude& amplitude, double frequency);

/// A range of frequencies in which displacement, velocity or acceleration has one amplitude.
struct SineBand
{
  double from = 0.0;  ///< Hz, > 0
  double to = 0.0;    ///< Hz, > 0
  MotionAmplitude amplitude;
};

}  // namespace vibro_impact::core
