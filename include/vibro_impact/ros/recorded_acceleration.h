#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vibro_impact/ros/input_parameters.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
/// The base acceleration that a topic of a recording holds.
struct RecordedAcceleration
{
  double sample_period = 0.0;        ///< s
  std::vector<double> acceleration;  ///< m/s^2
  std::uint64_t bridged = 0;         ///< of these, on a straight line where some were missing
  std::uint64_t refused = 0;         ///< samples that were left out
  std::string first_irregularity;    ///< why the first was refused or bridged; empty: none was
};

/// Reads one topic of one or several bags by the rules of the simulator: refuses what it would refuse, bridges what it
/// would bridge. `input` says of what type the topic is, and how samples of a sensor are to be taken. Throws
/// config::Error, with a line that says why, if a bag cannot be read, there is no such topic, no sample of it can be
/// taken, or the stream starts anew: it must be one stretch.
RecordedAcceleration readRecordedAcceleration(const std::vector<std::string>& bags, const std::string& topic,
                                              const InputParameters& input, const StreamLimits& limits);

}  // namespace vibro_impact::graph
