#include "frequency_drift.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace vibro_impact::core
{
namespace
{
// Log likelihood ratios, twice, that decide whether a line is a piece of a sweep, or has a constant frequency. The
// latter takes more: of the many lines that a sweep is cut into, those are favoured in which noise happens to hide the
// drift.
constexpr double surely_swept = -10.0;
constexpr double surely_constant = 40.0;

// How the frequency drifts along a line: rad per sample from end to end, and its standard deviation.
struct Drift
{
  double value = 0.0;
  double deviation = std::numeric_limits<double>::infinity();
};

Drift driftOf(const std::vector<DriveCycle>& cycles, const PhaseLine& line)
{
  Drift drift;
  if (isScrap(line))
  {
    return drift;
  }
  // The part of t^2 that no line can follow.
  double third = 0.0;
  for (std::size_t k = line.first; k < line.last; ++k)
  {
    const double t = cycles[k].time - line.time;
    third += cycles[k].weight * t * t * t;
  }
  double moment = 0.0;
  double norm = 0.0;
  for (std::size_t k = line.first; k < line.last; ++k)
  {
    const double t = cycles[k].time - line.time;
    const double curve = t * t - line.spread / line.weight - third / line.spread * t;
    moment += cycles[k].weight * curve * (cycles[k].phase - line.at(cycles[k].time));
    norm += cycles[k].weight * curve * curve;
  }
  const double length = static_cast<double>(cycles[line.last - 1].last - cycles[line.first].first);
  drift.value = 2.0 * moment / norm * length;
  drift.deviation = 2.0 * length / std::sqrt(norm);
  return drift;
}
}  // namespace

std::vector<bool> constantLines(const std::vector<DriveCycle>& cycles, const std::vector<PhaseLine>& lines)
{
  std::vector<Drift> drifts;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < lines.size(); ++i)
  {
    // Scraps say nothing of the frequency.
    std::size_t before = i;
    while (before > 0 && (before == i || isScrap(lines[before])))
    {
      --before;
    }
    std::size_t after = i;
    while (after + 1 < lines.size() && (after == i || isScrap(lines[after])))
    {
      ++after;
    }
    const double length = static_cast<double>(cycles[lines[i].last - 1].last - cycles[lines[i].first].first);
    const double swept = before == after ? 0.0
                                         : (lines[after].slope - lines[before].slope) /
                                               (lines[after].time - lines[before].time) * length;
    drifts.push_back(driftOf(cycles, lines[i]));
    ratios.push_back(swept * (swept - 2.0 * drifts[i].value) / (drifts[i].deviation * drifts[i].deviation));
  }
  const auto opinion = [&](std::size_t i) { return std::clamp(ratios[i], surely_swept, -0.2 * surely_swept); };
  std::vector<bool> constant;
  for (std::size_t i = 0; i < lines.size(); ++i)
  {
    double ratio = ratios[i];
    for (std::size_t away = 1; ratio > surely_swept && ratio < surely_constant && away < lines.size(); ++away)
    {
      ratio += (away <= i ? opinion(i - away) : 0.0) + (i + away < lines.size() ? opinion(i + away) : 0.0);
    }
    // Where nothing decides, there is no other frequency to compare with: a drift must be no more than noise, or tiny.
    const bool harmless = std::abs(drifts[i].value) < std::max(5.0 * drifts[i].deviation, 1.0e-3 * lines[i].slope);
    constant.push_back(std::abs(ratio) < -0.3 * surely_swept ? harmless : ratio > 0.0);
  }
  return constant;
}

}  // namespace vibro_impact::core
