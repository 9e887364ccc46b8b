#include "vibro_impact/ros/progress.h"

#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

namespace vibro_impact::graph
{
namespace
{
std::ostringstream plainStream()
{
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream << std::fixed;
  return stream;
}

}  // namespace

std::string toClock(double seconds)
{
  std::ostringstream stream = plainStream();
  if (std::round(10.0 * seconds) < 600.0)
  {
    stream << std::setprecision(1) << seconds << " s";
    return stream.str();
  }
  const long long whole = std::llround(seconds);
  stream << std::setfill('0');
  if (whole >= 3600)
  {
    stream << whole / 3600 << ':' << std::setw(2);
  }
  stream << whole / 60 % 60 << ':' << std::setw(2) << whole % 60;
  return stream.str();
}

std::string toText(const Progress& progress)
{
  std::ostringstream stream = plainStream();
  stream << std::setprecision(1) << std::setw(5) << 100.0 * progress.stream_time / progress.stream_duration << " %";
  if (progress.frequency > 0.0)
  {
    stream << ", " << progress.frequency << " Hz";
    if (progress.reference_frequency != 1.0)
    {
      stream << " (" << std::setprecision(3) << progress.frequency / progress.reference_frequency << ')'
             << std::setprecision(1);
    }
  }
  else if (!std::isnan(progress.frequency))
  {
    stream << ", at rest";
  }
  stream << ", " << toClock(progress.stream_time) << " of " << toClock(progress.stream_duration);
  if (progress.wall_time > 0.0 && progress.stream_time > 0.0)
  {
    const double speed = progress.stream_time / progress.wall_time;
    stream << ", " << speed << " x real time, " << toClock((progress.stream_duration - progress.stream_time) / speed)
           << " left";
  }
  return stream.str();
}

}  // namespace vibro_impact::graph
