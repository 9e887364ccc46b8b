#include "vibro_impact/core/sine_band.h"

#include "drive_phase.h"

namespace vibro_impact::core
{
double accelerationAmplitude(const MotionAmplitude& amplitude, double frequency)
{
  const double omega = two_pi * frequency;
  switch (amplitude.quantity)
  {
    case MotionQuantity::displacement:
      return omega * omega * amplitude.value;
    case MotionQuantity::velocity:
      return omega * amplitude.value;
    default:
      return amplitude.value;
  }
}

}  // namespace vibro_impact::core
