#pragma once

#include <sstream>
#include <string>

namespace vibro_impact::graph
{
/// The parts in one text, numbers to the digits that tell two samples of a long stream apart.
template <typename... Parts>
std::string text(const Parts&... parts)
{
  std::ostringstream stream;
  stream.precision(12);
  (stream << ... << parts);
  return stream.str();
}

}  // namespace vibro_impact::graph
