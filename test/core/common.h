// What tests of every layer have in common.

#pragma once

#include <vector>

#include "vibro_impact/core/impact.h"

namespace vibro_impact::core
{
constexpr double pi = 3.14159265358979323846;
constexpr double two_pi = 2.0 * pi;

/// Keeps every impact it hears of.
struct Recorder : ImpactSink
{
  void onImpact(const Impact& impact) override
  {
    impacts.push_back(impact);
  }
  std::vector<Impact> impacts;
};

}  // namespace vibro_impact::core
