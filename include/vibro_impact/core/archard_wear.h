#pragma once

#include "vibro_impact/core/impact_sums.h"

namespace vibro_impact::core
{
/// Wear by Archard's law in the form of a work rate: worn volume = coefficient * work, where work is the integral of
/// the normal force over the distance slid (J. F. Archard, J. Appl. Phys. 24 (1953) 981; as a work rate T. M. Frick et
/// al., ASME Symposium on Flow-Induced Vibrations 3 (1984) 149).
///
/// The model moves along the normal alone, so that sliding has to be assumed, in one of two ways: at a constant speed v
/// during contact, work = v impulse; or over a constant distance s in each impact at a speed that is constant within
/// it, work = s impulse/duration.
struct ArchardWear
{
  double coefficient = 0.0;       ///< K, worn volume by work, m^2/N (that is 1/Pa)
  double area = 1.0;              ///< over which the volume is spread, m^2
  double sliding_speed = 0.0;     ///< v, m/s
  double sliding_distance = 0.0;  ///< s, m

  /// J
  double normalWork(const ImpactSums& sums) const
  {
    return sliding_speed * sums.impulse + sliding_distance * sums.mean_forces;
  }
  /// m^3
  double volume(const ImpactSums& sums) const
  {
    return coefficient * normalWork(sums);
  }
  /// m
  double depth(const ImpactSums& sums) const
  {
    return volume(sums) / area;
  }
};

}  // namespace vibro_impact::core
