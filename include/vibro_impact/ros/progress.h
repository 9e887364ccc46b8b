#pragma once

#include <string>

namespace vibro_impact::graph
{
/// How far a shaker is.
struct Progress
{
  double stream_time = 0.0;          ///< published so far, s
  double stream_duration = 0.0;      ///< in the end, s
  double wall_time = 0.0;            ///< since the first block, s
  double frequency = 0.0;            ///< of the drive now, Hz; 0: at rest; NaN: not said
  double reference_frequency = 1.0;  ///< in which frequencies were given, Hz
};

/// One line for the console: share, frequency, stream time, speed, and when the end is to be expected.
std::string toText(const Progress& progress);

/// A time for people: "0.5 s", "59.9 s", "1:00", "1:01:01".
std::string toClock(double seconds);

}  // namespace vibro_impact::graph
