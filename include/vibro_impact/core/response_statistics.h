#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vibro_impact/core/impact_sums.h"

namespace vibro_impact::core
{
/// What a monitor makes of a response: over the window that ends at `time`, and in all up to then.
struct ResponseStatistics
{
  StreamTime time = 0;
  std::uint64_t stretch = 0;             ///< number of the stretch of time that it lies in, from 1
  double window = 0.0;                   ///< time of the window whose samples were heard, s
  ImpactSums sums;                       ///< of the impacts released in the window
  std::vector<std::uint64_t> histogram;  ///< of their impulses, as ImpulseHistogram counts
  double impact_rate = 0.0;              ///< whole impacts, 1/s
  double contact_duty = 0.0;             ///< 1
  double mean_force = 0.0;               ///< impulse by time, N
  double impact_power = 0.0;             ///< energy lost by time, W
  double normal_work_rate = 0.0;         ///< W
  double wear_rate = 0.0;                ///< m^3/s
  double drive_frequency = 0.0;          ///< 0: unknown, Hz
  int period = 0;                        ///< drive cycles, 0: none
  ImpactSums total;
  double total_time = 0.0;          ///< heard, s
  double total_contact_time = 0.0;  ///< of it with a force, s
  double total_normal_work = 0.0;   ///< J
  double wear_volume = 0.0;         ///< m^3
  double wear_depth = 0.0;          ///< m
};

/// A number of the statistics that an alarm may watch.
struct Quantity
{
  const char* name;
  const char* unit;  ///< empty: a count or a share
  double (*value)(const ResponseStatistics&);
};

/// All of them.
const std::vector<Quantity>& quantities();

/// The one of that name; null if there is none.
const Quantity* findQuantity(const std::string& name);

}  // namespace vibro_impact::core
