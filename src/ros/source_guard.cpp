#include "vibro_impact/ros/source_guard.h"

namespace vibro_impact::graph
{
SourceGuard::SourceGuard(double max_age) : max_age_(max_age)
{
}

bool SourceGuard::admit(const std::string& publisher, std::uint32_t connected, double wall_time)
{
  if (publisher != source_)
  {
    const bool source_is_gone = source_.empty() || connected <= 1 || wall_time - last_time_ > max_age_;
    if (!source_is_gone)
    {
      return false;
    }
    source_ = publisher;
  }
  last_time_ = wall_time;
  return true;
}

}  // namespace vibro_impact::graph
