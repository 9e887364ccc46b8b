#include "vibro_impact/core/response_statistics.h"

#include <algorithm>

namespace vibro_impact::core
{
const std::vector<Quantity>& quantities()
{
  using Statistics = ResponseStatistics;
  static const std::vector<Quantity> all = {
      {"contact_duty", "", [](const Statistics& s) { return s.contact_duty; }},
      {"impact_power", "W", [](const Statistics& s) { return s.impact_power; }},
      {"impact_rate", "1/s", [](const Statistics& s) { return s.impact_rate; }},
      {"impulse_max", "N s", [](const Statistics& s) { return s.sums.impulse_max; }},
      {"impulse_mean", "N s", [](const Statistics& s) { return s.sums.impulseMean(); }},
      {"impulse_rms", "N s", [](const Statistics& s) { return s.sums.impulseRms(); }},
      {"mean_force", "N", [](const Statistics& s) { return s.mean_force; }},
      {"normal_work_rate", "W", [](const Statistics& s) { return s.normal_work_rate; }},
      {"peak_force", "N", [](const Statistics& s) { return s.sums.peak_force; }},
      {"period", "", [](const Statistics& s) { return static_cast<double>(s.period); }},
      {"wear_depth", "m", [](const Statistics& s) { return s.wear_depth; }},
      {"wear_rate", "m^3/s", [](const Statistics& s) { return s.wear_rate; }},
      {"wear_volume", "m^3", [](const Statistics& s) { return s.wear_volume; }},
  };
  return all;
}

const Quantity* findQuantity(const std::string& name)
{
  const auto found = std::find_if(quantities().begin(), quantities().end(),
                                  [&name](const Quantity& quantity) { return name == quantity.name; });
  return found == quantities().end() ? nullptr : &*found;
}

}  // namespace vibro_impact::core
