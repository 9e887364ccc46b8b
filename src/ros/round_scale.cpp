#include "vibro_impact/ros/round_scale.h"

#include <cmath>

namespace vibro_impact::graph
{
namespace
{
/// A round number stays until it is off by more than this, either way: more than from one round number to the next.
constexpr double hysteresis = 2.6;
}  // namespace

double RoundScale::update(double wanted)
{
  if (fixed_ > 0.0 || !std::isfinite(wanted) || wanted <= 0.0 ||
      (value_ > 0.0 && wanted < value_ * hysteresis && wanted > value_ / hysteresis))
  {
    return value_;
  }
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double digits = wanted / power;
  // the nearest by ratio
  value_ = power * (digits < std::sqrt(2.0)    ? 1.0
                    : digits < std::sqrt(10.0) ? 2.0
                    : digits < std::sqrt(50.0) ? 5.0
                                               : 10.0);
  return value_;
}

}  // namespace vibro_impact::graph
