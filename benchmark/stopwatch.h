#pragma once

#include <chrono>
#include <ctime>

namespace vibro_impact
{
inline double wallTime()  ///< s
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Processor time of the calling thread, s.
inline double threadTime()
{
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1.0e-9 * static_cast<double>(time.tv_nsec);
}
}  // namespace vibro_impact
