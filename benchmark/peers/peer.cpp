#include "peer.h"

#include <cmath>

namespace vibro_impact::peers
{
std::vector<double> tolerances()
{
  std::vector<double> result;
  for (int quarter = 8; quarter <= 56; ++quarter)
  {
    result.push_back(std::pow(10.0, -0.25 * quarter));
  }
  return result;
}
}  // namespace vibro_impact::peers
