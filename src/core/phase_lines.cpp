#include "phase_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "median.h"

namespace vibro_impact::core
{
namespace
{
// The growth of chi-squared that keeps two lines apart. Merging them saves two numbers; pure noise exceeds 40 once in
// half a thousand million times.
constexpr double significant_corner = 40.0;
// Phases are never trusted beyond this, rad: clean samples do not make every trace of distortion a corner, and steps of
// 0.1 % and five cycles are still told apart.
constexpr double smallest_phase_deviation = 2.0e-3;

struct Merged
{
  PhaseLine line;
  double cost;  // by how much chi-squared grows
};

Merged merge(const PhaseLine& a, const PhaseLine& b)
{
  const double between_weight = a.weight * b.weight / (a.weight + b.weight);
  const double dt = b.time - a.time;
  const double dp = b.phase - a.phase;
  Merged merged;
  PhaseLine& line = merged.line;
  line.first = a.first;
  line.last = b.last;
  line.weight = a.weight + b.weight;
  line.time = a.time + dt * b.weight / line.weight;
  line.phase = a.phase + dp * b.weight / line.weight;
  line.spread = a.spread + b.spread + between_weight * dt * dt;
  line.slope = (a.spread * a.slope + b.spread * b.slope + between_weight * dt * dp) / line.spread;
  const double da = a.slope - line.slope;
  const double db = b.slope - line.slope;
  const double miss = dp - line.slope * dt;
  merged.cost = a.spread * da * da + b.spread * db * db + between_weight * miss * miss;
  return merged;
}

// Weights of the phases of a run from their own scatter about their neighbours, which steps, being rare, do not
// disturb.
void weigh(std::vector<DriveCycle>& run)
{
  constexpr std::size_t block = 256;
  std::vector<double> scatter;
  for (std::size_t from = 0, to = 0; from < run.size(); from = to)
  {
    // A remainder too short for an estimate of its own shares that of the block before it.
    to = run.size() - from < 2 * block ? run.size() : from + block;
    scatter.clear();
    for (std::size_t k = std::max<std::size_t>(from, 1); k + 1 < run.size() && k < to; ++k)
    {
      const DriveCycle& before = run[k - 1];
      const DriveCycle& after = run[k + 1];
      const double share = (run[k].time - before.time) / (after.time - before.time);
      scatter.push_back(run[k].phase - before.phase - share * (after.phase - before.phase));
    }
    double deviation = smallest_phase_deviation;
    if (scatter.size() >= 3)
    {
      const double centre = median(scatter);
      for (double& value : scatter)
      {
        value = std::abs(value - centre);
      }
      // The variance of a value less the mean of its neighbours is one and a half times that of the value.
      deviation = std::max(deviation, median_to_deviation * median(scatter) / std::sqrt(1.5));
    }
    for (std::size_t k = from; k < to; ++k)
    {
      run[k].weight = 1.0 / (deviation * deviation);
    }
  }
}

// Straight lines through the phases of one run, merged from pairs of cycles by least growth of chi-squared.
std::vector<PhaseLine> cutIntoLines(const std::vector<DriveCycle>& cycles)
{
  struct Node
  {
    PhaseLine line;
    std::size_t previous;
    std::size_t next;
    unsigned version = 0;
    bool alive = true;
  };
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<Node> nodes;
  for (std::size_t k = 0; k < cycles.size(); k += 2)
  {
    const std::size_t i = nodes.size();
    nodes.push_back({lineThrough(cycles, k, std::min(k + 2, cycles.size())), i == 0 ? none : i - 1, i + 1});
  }
  nodes.back().next = none;

  struct Merge
  {
    double cost;
    std::size_t left;
    unsigned left_version;
    unsigned right_version;
    bool operator<(const Merge& other) const
    {
      return cost != other.cost ? cost > other.cost : left > other.left;
    }
  };
  std::priority_queue<Merge> merges;
  const auto consider = [&](std::size_t left)
  {
    const std::size_t right = nodes[left].next;
    const double cost = merge(nodes[left].line, nodes[right].line).cost;
    if (cost < significant_corner)
    {
      merges.push({cost, left, nodes[left].version, nodes[right].version});
    }
  };
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i)
  {
    consider(i);
  }
  while (!merges.empty())
  {
    const Merge best = merges.top();
    merges.pop();
    Node& left = nodes[best.left];
    if (!left.alive || left.version != best.left_version || left.next == none ||
        nodes[left.next].version != best.right_version)
    {
      continue;
    }
    Node& right = nodes[left.next];
    left.line = merge(left.line, right.line).line;
    ++left.version;
    right.alive = false;
    ++right.version;
    left.next = right.next;
    if (left.next != none)
    {
      nodes[left.next].previous = best.left;
      consider(best.left);
    }
    if (left.previous != none)
    {
      consider(left.previous);
    }
  }

  std::vector<PhaseLine> lines;
  for (std::size_t i = 0; i != none; i = nodes[i].next)
  {
    lines.push_back(nodes[i].line);
  }
  return lines;
}

// Drops the cycles that lie by themselves between two lines: those that a spike or a jump has spoilt.
std::vector<DriveCycle> withoutScraps(const std::vector<DriveCycle>& cycles, const std::vector<PhaseLine>& lines)
{
  std::vector<DriveCycle> kept;
  for (std::size_t i = 0; i < lines.size(); ++i)
  {
    const bool alone = i > 0 && i + 1 < lines.size() && !isScrap(lines[i - 1]) && !isScrap(lines[i + 1]);
    if (!isScrap(lines[i]) || !alone)
    {
      kept.insert(kept.end(), cycles.begin() + static_cast<std::ptrdiff_t>(lines[i].first),
                  cycles.begin() + static_cast<std::ptrdiff_t>(lines[i].last));
    }
  }
  return kept;
}

// Gives every cycle near a cut to the line it lies on: merging pairs leaves a cut one or two cycles off.
std::vector<PhaseLine> refineCuts(const std::vector<DriveCycle>& cycles, std::vector<PhaseLine> lines)
{
  constexpr std::size_t reach = 3;
  const auto miss = [&](const PhaseLine& line, std::size_t k)
  {
    const double residual = cycles[k].phase - line.at(cycles[k].time);
    return cycles[k].weight * residual * residual;
  };
  for (std::size_t i = 0; i + 1 < lines.size(); ++i)
  {
    const std::size_t cut = lines[i].last;
    const std::size_t left_length = cut - lines[i].first;
    const std::size_t right_length = lines[i + 1].last - cut;
    if (left_length < 3 || right_length < 3)
    {
      continue;
    }
    // The lines themselves without the cycles next to the cut, as far as enough others are left.
    const PhaseLine left = lineThrough(cycles, lines[i].first, cut - std::min<std::size_t>(2, (left_length - 1) / 2));
    const PhaseLine right =
        lineThrough(cycles, cut + std::min<std::size_t>(2, (right_length - 1) / 2), lines[i + 1].last);
    const std::size_t from = cut - std::min(reach, left_length - 2);
    const std::size_t to = cut + std::min(reach, right_length - 2);
    double cost = 0.0;
    for (std::size_t k = from; k < to; ++k)
    {
      cost += miss(right, k);
    }
    double least = cost;
    std::size_t best = from;
    for (std::size_t k = from; k < to; ++k)
    {
      cost += miss(left, k) - miss(right, k);
      if (cost < least)
      {
        least = cost;
        best = k + 1;
      }
    }
    lines[i] = lineThrough(cycles, lines[i].first, best);
    lines[i + 1] = lineThrough(cycles, best, lines[i + 1].last);
  }
  return lines;
}
}  // namespace

PhaseLine lineThrough(const std::vector<DriveCycle>& cycles, std::size_t first, std::size_t last)
{
  PhaseLine line;
  line.first = first;
  line.last = last;
  const DriveCycle& origin = cycles[first];
  for (std::size_t k = first; k < last; ++k)
  {
    line.weight += cycles[k].weight;
    line.time += cycles[k].weight * (cycles[k].time - origin.time);
    line.phase += cycles[k].weight * (cycles[k].phase - origin.phase);
  }
  line.time = origin.time + line.time / line.weight;
  line.phase = origin.phase + line.phase / line.weight;
  double moment = 0.0;
  for (std::size_t k = first; k < last; ++k)
  {
    const double t = cycles[k].time - line.time;
    line.spread += cycles[k].weight * t * t;
    moment += cycles[k].weight * t * (cycles[k].phase - line.phase);
  }
  line.slope = line.spread > 0.0 ? moment / line.spread : cycles[first].advance;
  return line;
}

std::vector<PhaseLine> phaseLines(std::vector<DriveCycle>& run)
{
  weigh(run);
  std::vector<PhaseLine> lines = cutIntoLines(run);
  if (std::vector<DriveCycle> kept = withoutScraps(run, lines); kept.size() < run.size())
  {
    run = std::move(kept);
    lines = cutIntoLines(run);
  }
  return refineCuts(run, std::move(lines));
}

}  // namespace vibro_impact::core
