#include "vibro_impact/ros/process.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <system_error>

namespace vibro_impact::graph
{
namespace
{
// How often each thread has been taken off a processor so far; nothing if one of them is not asleep.
std::optional<std::map<std::string, std::uint64_t>> switchesOfSleepers(int pid)
{
  std::map<std::string, std::uint64_t> switches;
  std::error_code error;
  for (std::filesystem::directory_iterator thread("/proc/" + std::to_string(pid) + "/task", error), end;
       !error && thread != end; thread.increment(error))
  {
    std::ifstream status(thread->path() / "status");
    std::uint64_t& count = switches[thread->path().filename().string()];
    for (std::string word; status >> word;)
    {
      if (word == "State:" && status >> word && word != "S")
      {
        return std::nullopt;
      }
      std::uint64_t number = 0;
      if ((word == "voluntary_ctxt_switches:" || word == "nonvoluntary_ctxt_switches:") && status >> number)
      {
        count += number;
      }
    }
  }
  return switches;
}

}  // namespace

bool isAsleep(int pid)
{
  // The threads are looked at one after the other, while they may wake each other. Where none has run between two such
  // looks, all of them were asleep in between.
  const auto first = switchesOfSleepers(pid);
  return first && switchesOfSleepers(pid) == first;
}

}  // namespace vibro_impact::graph
