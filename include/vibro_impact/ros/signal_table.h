#pragma once

#include <string>

#include "vibro_impact/config/sampled_excitation.h"
#include "vibro_impact/ros/shaker_parameters.h"

namespace vibro_impact::graph
{
/// All samples of a shaker's signal, the first at time zero. Throws config::Error if they are more than 2e8.
config::SampledExcitation sampleSignal(const ShakerParameters& parameters);

/// Of the signal those samples that lie from `from` to `to` (s): comma-separated text with the columns time (s) and
/// acceleration (m/s^2), as config::readExcitation() reads it. Throws config::Error if that are none, or more than 5e7.
std::string signalTable(const ShakerParameters& parameters, double from, double to);

/// What there is to say of the signal, as lines of text: its length, and what follows from its family (frequencies,
/// root mean square, velocity left by a shock).
std::string describeSignal(const ShakerParameters& parameters);

}  // namespace vibro_impact::graph
