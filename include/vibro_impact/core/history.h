#pragma once

#include "vibro_impact/core/energy_account.h"

namespace vibro_impact::core
{
/// One point of the history of a motion.
struct HistorySample
{
  double time = 0.0;          ///< since the run began (SampledSimulation) or since setDrive() (HarmonicSimulation), s
  double acceleration = 0.0;  ///< of the base, m/s^2
  double gap = 0.0;           ///< m, negative while the contact spring is compressed
  double gap_velocity = 0.0;  ///< g', m/s
  double force = 0.0;         ///< contact force, N, positive in compression
  bool in_contact = false;    ///< S1
  EnergyAccount energy;       ///< of the run up to here
};

}  // namespace vibro_impact::core
