#include "vibro_impact/core/impact_sums.h"

#include <algorithm>
#include <cmath>

namespace vibro_impact::core
{
void ImpactSums::add(const ReleasedImpact& impact)
{
  if (impact.cut_short)
  {
    ++cut_short;
  }
  else
  {
    ++whole;
    whole_impulse += impact.impulse;
    impulse_squares += impact.impulse * impact.impulse;
    impulse_max = std::max(impulse_max, impact.impulse);
  }
  impulse += impact.impulse;
  mean_forces += impact.duration > 0.0 ? impact.impulse / impact.duration : 0.0;
  peak_force = std::max(peak_force, impact.peak_force);
  energy_lost += impact.energy_lost;
}

double ImpactSums::impulseMean() const
{
  return whole > 0 ? whole_impulse / static_cast<double>(whole) : 0.0;
}

double ImpactSums::impulseRms() const
{
  return whole > 0 ? std::sqrt(impulse_squares / static_cast<double>(whole)) : 0.0;
}

}  // namespace vibro_impact::core
