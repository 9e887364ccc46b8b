#pragma once

#include <chrono>
#include <ctime>
#include <fstream>
#include <string>

namespace vibro_impact
{
inline double wallTime()  ///< s
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline double processorTime(clockid_t clock)
{
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1.0e-9 * static_cast<double>(time.tv_nsec);
}

/// Processor time of the calling thread, s.
inline double threadTime()
{
  return processorTime(CLOCK_THREAD_CPUTIME_ID);
}

/// Processor time of all threads, s.
inline double processTime()
{
  return processorTime(CLOCK_PROCESS_CPUTIME_ID);
}

/// Processor and day, for the head of a table.
inline std::string today()
{
  std::string processor = "unknown processor";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
  {
    if (line.rfind("model name", 0) == 0)
    {
      processor = line.substr(line.find(": ") + 2);
      break;
    }
  }
  const std::time_t now = std::time(nullptr);
  char day[16];
  std::strftime(day, sizeof(day), "%Y-%m-%d", std::gmtime(&now));
  return processor + ", " + day;
}
}  // namespace vibro_impact
