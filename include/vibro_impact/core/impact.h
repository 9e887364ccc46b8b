#pragma once

#include <cstdint>

namespace vibro_impact::core
{
/// One contact episode, from its located onset to its located release.
struct Impact
{
  std::uint64_t number = 0;  ///< running number since the simulation started from rest, from 0
  std::uint64_t interval =
      0;                  ///< number of the drive interval (from sample `interval` to the next) in which the onset lies
  double offset = 0.0;    ///< time from the start of that interval to the onset, s
  double duration = 0.0;  ///< s
  double impulse = 0.0;   ///< integral of the contact force, N s
  double peak_force = 0.0;        ///< N
  double peak_time = 0.0;         ///< time from the onset to the peak force, s
  double approach_speed = 0.0;    ///< -g' at the onset, m/s; 0 if the episode was there at the start
  double separation_speed = 0.0;  ///< g' at the release, m/s; 0 if it was cut short
  double energy_lost = 0.0;       ///< dissipated + mapping_loss, J
  bool cut_short = false;         ///< not the whole episode: in contact at the start, a reset, or the end of the drive
  double dissipated = 0.0;        ///< by damping during the episode, J
  double mapping_loss = 0.0;      ///< lost by the mapping at onset and release, J; 0 in the attachment basis
  double base_work = 0.0;         ///< work of the base on both structures during the episode, J
};

/// Whoever wants to hear of impacts while a simulation advances. Called in the order of release.
class ImpactSink
{
public:
  virtual ~ImpactSink() = default;
  virtual void onImpact(const Impact& impact) = 0;
};

}  // namespace vibro_impact::core
