#include "vibro_impact/core/drive_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace vibro_impact::core
{
namespace
{
constexpr double two_pi = 6.283185307179586476925286766559;

// The growth of chi-squared that keeps two lines apart. Merging them saves two numbers; pure noise exceeds 40 once in
// half a thousand million times.
constexpr double significant_corner = 40.0;
// Log likelihood ratios, twice, that decide whether a line is a piece of a sweep, or has a constant frequency. The
// latter takes more: of the many lines that a sweep is cut into, those are favoured in which noise happens to hide the
// drift.
constexpr double surely_swept = -10.0;
constexpr double surely_constant = 40.0;
// Phases are never trusted beyond this, rad: clean samples do not make every trace of distortion a corner, and steps of
// 0.1 % and five cycles are still told apart.
constexpr double smallest_phase_deviation = 2.0e-3;
// From the median of the absolute deviations to the standard deviation of a normal distribution.
constexpr double median_to_deviation = 1.4826;
// Samples that the fit of a single cycle needs.
constexpr std::size_t fewest_samples_per_cycle = 8;
// Cycles that may be missing between two of one run: a spike spoils one or two.
constexpr double longest_hole = 6.5;
// Cycles without a good one after which the amplitude of the last good one is no guide any more.
constexpr double cycles_until_lost = 2.5;

// What one drive cycle says of the drive. Times are in samples.
struct Cycle
{
  std::uint64_t first = 0;  // its first sample
  std::uint64_t last = 0;   // the sample after its last one
  double time = 0.0;        // its middle
  double phase = 0.0;       // there, unwrapped along its run, rad
  double amplitude = 0.0;
  double advance = 0.0;  // phase per sample as its length tells it, rad
  double weight = 0.0;   // inverse square of the phase's standard deviation
};

// A straight line through the phases of the cycles [first, last): statistics that merge without cancellation.
struct Line
{
  std::size_t first = 0;
  std::size_t last = 0;
  double weight = 0.0;
  double time = 0.0;    // weighted mean
  double phase = 0.0;   // weighted mean
  double spread = 0.0;  // weighted sum of (t - time)^2
  double slope = 0.0;   // rad per sample

  double at(double t) const
  {
    return phase + slope * (t - time);
  }
};

// Too short to tell a drift.
bool isScrap(const Line& line)
{
  return line.last - line.first < 4;
}

struct Merged
{
  Line line;
  double cost;  // by how much chi-squared grows
};

Merged merge(const Line& a, const Line& b)
{
  const double between_weight = a.weight * b.weight / (a.weight + b.weight);
  const double dt = b.time - a.time;
  const double dp = b.phase - a.phase;
  Merged merged;
  Line& line = merged.line;
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

Line lineThrough(const std::vector<Cycle>& cycles, std::size_t first, std::size_t last)
{
  Line line;
  line.first = first;
  line.last = last;
  const Cycle& origin = cycles[first];
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

double median(std::vector<double>& values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Weights of the phases of a run from their own scatter about their neighbours, which steps, being rare, do not
// disturb.
void weigh(std::vector<Cycle>& run)
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
      const Cycle& before = run[k - 1];
      const Cycle& after = run[k + 1];
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
std::vector<Line> cutIntoLines(const std::vector<Cycle>& cycles)
{
  struct Node
  {
    Line line;
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

  std::vector<Line> lines;
  for (std::size_t i = 0; i != none; i = nodes[i].next)
  {
    lines.push_back(nodes[i].line);
  }
  return lines;
}

// Gives every cycle near a cut to the line it lies on: merging pairs leaves a cut one or two cycles off.
std::vector<Line> refineCuts(const std::vector<Cycle>& cycles, std::vector<Line> lines)
{
  constexpr std::size_t reach = 3;
  const auto miss = [&](const Line& line, std::size_t k)
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
    const Line left = lineThrough(cycles, lines[i].first, cut - std::min<std::size_t>(2, (left_length - 1) / 2));
    const Line right = lineThrough(cycles, cut + std::min<std::size_t>(2, (right_length - 1) / 2), lines[i + 1].last);
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

// How the frequency drifts along a line: rad per sample from end to end, and its standard deviation.
struct Drift
{
  double value = 0.0;
  double deviation = std::numeric_limits<double>::infinity();
};

Drift driftOf(const std::vector<Cycle>& cycles, const Line& line)
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

// Which lines have a constant frequency, and are not pieces of a sweep. Were a line a piece of a sweep, its frequency
// would drift as fast as it changes from the line before to the line after; the log likelihood ratio of no drift
// against that one decides. Short lines are undecided by themselves: their neighbours, ever more distant ones, are
// asked as well, and are believed more readily when they speak of a sweep, for a sweep is never alone.
std::vector<bool> constantLines(const std::vector<Cycle>& cycles, const std::vector<Line>& lines)
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

// A range of cycles.
struct Stretch
{
  std::size_t first;
  std::size_t last;
};

class StretchSearch
{
public:
  StretchSearch(const std::vector<Cycle>& cycles, const StepSearchOptions& options)
      : cycles_(cycles),
        shortest_(static_cast<std::size_t>(options.shortest_step)),
        tolerance_(options.amplitude_tolerance)
  {
  }

  // The stretches of constant amplitude within a line, in order.
  std::vector<Stretch> within(const Line& line) const
  {
    std::vector<Stretch> found;
    search(line.first, line.last, tolerance_, found);
    return found;
  }

  double medianAmplitude(const Stretch& stretch) const
  {
    std::vector<double> values = amplitudes(stretch);
    return median(values);
  }

private:
  std::vector<double> amplitudes(const Stretch& stretch) const
  {
    std::vector<double> values;
    for (std::size_t k = stretch.first; k < stretch.last; ++k)
    {
      values.push_back(cycles_[k].amplitude);
    }
    return values;
  }

  void search(std::size_t first, std::size_t last, double tolerance, std::vector<Stretch>& found) const
  {
    if (last - first < shortest_)
    {
      return;
    }
    const double level = commonestAmplitude(first, last, tolerance);
    Stretch longest{first, first};
    std::size_t start = first;
    for (std::size_t k = first; k <= last; ++k)
    {
      if (k == last || std::abs(amplitudeAt(k, first, last) - level) > tolerance * level)
      {
        if (k - start > longest.last - longest.first)
        {
          longest = {start, k};
        }
        start = k + 1;
      }
    }
    if (longest.last - longest.first < shortest_)
    {
      return;
    }
    // A ramp fills the whole band, however narrow; a level does not, and two close levels part in a narrower one.
    if (rise(longest) > 1.5 * tolerance * level)
    {
      if (tolerance * level > 8.0 * scatter(longest))
      {
        search(first, last, 0.5 * tolerance, found);
      }
      return;
    }
    search(first, longest.first, tolerance_, found);
    const Stretch trimmed = trim(longest);
    found.push_back(trimmed.last - trimmed.first < shortest_ ? longest : trimmed);
    search(longest.last, last, tolerance_, found);
  }

  // Without single outliers.
  double amplitudeAt(std::size_t k, std::size_t first, std::size_t last) const
  {
    const double here = cycles_[k].amplitude;
    if (k == first || k + 1 == last)
    {
      return here;
    }
    const double a = cycles_[k - 1].amplitude;
    const double b = cycles_[k + 1].amplitude;
    return std::max(std::min(a, b), std::min(std::max(a, b), here));
  }

  // The level about which, within the tolerance, most of the cycles lie.
  double commonestAmplitude(std::size_t first, std::size_t last, double tolerance) const
  {
    std::vector<double> sorted = amplitudes({first, last});
    std::sort(sorted.begin(), sorted.end());
    std::size_t best_first = 0;
    std::size_t best_count = 0;
    std::size_t to = 0;
    for (std::size_t from = 0; from < sorted.size(); ++from)
    {
      while (to < sorted.size() && sorted[to] * (1.0 - tolerance) <= sorted[from] * (1.0 + tolerance))
      {
        ++to;
      }
      if (to - from > best_count)
      {
        best_count = to - from;
        best_first = from;
      }
    }
    return sorted[best_first + best_count / 2];
  }

  // Without the cycles at either end that stand out from the others: the last of a soft start.
  Stretch trim(Stretch stretch) const
  {
    std::vector<double> values = amplitudes(stretch);
    const double level = median(values);
    for (double& value : values)
    {
      value = std::abs(value - level);
    }
    const double allowed = std::max(5.0 * median_to_deviation * median(values), 0.02 * level);
    const auto stands_out = [&](std::size_t k) { return std::abs(cycles_[k].amplitude - level) > allowed; };
    while (stretch.first < stretch.last && stands_out(stretch.first))
    {
      ++stretch.first;
    }
    while (stretch.first < stretch.last && stands_out(stretch.last - 1))
    {
      --stretch.last;
    }
    return stretch;
  }

  // Standard deviation of the amplitude from cycle to cycle.
  double scatter(const Stretch& stretch) const
  {
    std::vector<double> values;
    for (std::size_t k = stretch.first; k + 1 < stretch.last; ++k)
    {
      values.push_back(std::abs(cycles_[k + 1].amplitude - cycles_[k].amplitude));
    }
    return median_to_deviation * median(values) / std::sqrt(2.0);
  }

  // Change of the amplitude along a stretch, by a straight line through it.
  double rise(const Stretch& stretch) const
  {
    const auto count = static_cast<double>(stretch.last - stretch.first);
    double moment = 0.0;
    for (std::size_t k = stretch.first; k < stretch.last; ++k)
    {
      moment += (static_cast<double>(k - stretch.first) - 0.5 * (count - 1.0)) * cycles_[k].amplitude;
    }
    return std::abs(12.0 * moment / (count * (count + 1.0)));
  }

  const std::vector<Cycle>& cycles_;
  std::size_t shortest_;
  double tolerance_;
};

// Drops the cycles that lie by themselves between two lines: those that a spike or a jump has spoilt.
std::vector<Cycle> withoutScraps(const std::vector<Cycle>& cycles, const std::vector<Line>& lines)
{
  std::vector<Cycle> kept;
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

// A step and the line through its phases.
struct Candidate
{
  FoundStep step;
  Line line;
};

// Where a drive that is continuous in phase goes over from one step to the next, the lines through their phases meet:
// moves the boundary there, unless that is more than a cycle or two from where it was found.
void joinSteps(Candidate& left, Candidate& right)
{
  const double left_end = static_cast<double>(left.step.last);
  const double right_start = static_cast<double>(right.step.first);
  const double cycle = two_pi / std::min(left.line.slope, right.line.slope);
  const double difference = left.line.slope - right.line.slope;
  const double middle = 0.5 * (left_end + right_start);
  const double meeting = middle + (right.line.at(middle) - left.line.at(middle)) / difference;
  const bool near = right_start - left_end < 3.0 * cycle && std::abs(meeting - left_end) < 2.0 * cycle &&
                    std::abs(meeting - right_start) < 2.0 * cycle;
  const bool enough = meeting > static_cast<double>(left.step.first) + 2.0 * cycle &&
                      meeting < static_cast<double>(right.step.last) - 2.0 * cycle;
  if (near && enough)
  {
    left.step.last = right.step.first = static_cast<std::uint64_t>(std::ceil(meeting));
  }
}
}  // namespace

struct DriveStepFinder::Implementation
{
  Implementation(double period, const StepSearchOptions& search_options)
      : sample_period(period),
        options(search_options),
        memory(static_cast<std::size_t>(std::ceil(1.0 / (search_options.lowest_frequency * period))))
  {
  }

  void add(std::uint64_t first, const double* values, std::size_t count)
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      if (!std::isfinite(values[i]))
      {
        started = false;
        continue;
      }
      if (!started || first + i != number)
      {
        start(first + i, values[i]);
      }
      take(values[i]);
    }
  }

  // Begins anew with the sample of this number: what came before is not connected with it.
  void start(std::uint64_t first, double x)
  {
    started = true;
    interrupted = true;
    number = first;
    samples.clear();
    in_memory = 0;
    low = high = before_low = before_high = turning = last_sample = x;
    locked = false;
    rising = false;
    onset_known = false;
  }

  // Follows the signal from turning point to turning point. A rise by a third of its range ends a cycle and begins the
  // next: noise does not reach that far, and no offset matters. The range is that of the last good cycle, whatever
  // spikes there are; where the cycles are lost, that of the recent samples.
  void take(double x)
  {
    if (locked && number > locked_until)
    {
      locked = false;
      in_memory = 0;
      low = high = before_low = before_high = x;
    }
    low = std::min(low, x);
    high = std::max(high, x);
    const double range =
        locked ? 2.0 * cycles.back().amplitude : std::max(high, before_high) - std::min(low, before_low);
    const double reach = range / 3.0;
    if (rising)
    {
      turning = std::max(turning, x);
      if (turning - x > reach)
      {
        rising = false;
        turning = x;
      }
    }
    else
    {
      turning = std::min(turning, x);
      const double level = turning + reach;
      if (x > level)
      {
        rising = true;
        turning = x;
        const double into = level > last_sample ? (level - last_sample) / (x - last_sample) : 0.0;
        startCycle(static_cast<double>(number) - 1.0 + into);
      }
    }
    last_sample = x;
    samples.push_back(x);
    ++number;
    if (++in_memory >= memory)
    {
      before_low = low;
      before_high = high;
      low = high = x;
      in_memory = 0;
    }
    if (samples.size() > 2 * memory)
    {
      samples.clear();
      onset_known = false;
    }
  }

  // `time`: of the crossing, between the sample before the present one and the present one.
  void startCycle(double time)
  {
    if (onset_known)
    {
      takeCycle(time - onset);
    }
    samples.clear();
    onset = time;
    onset_known = true;
  }

  // The samples since the last crossing are one cycle of the given length.
  void takeCycle(double length)
  {
    const std::size_t count = samples.size();
    if (count < fewest_samples_per_cycle)
    {
      return;
    }
    // Very few samples cannot tell the third harmonic from noise.
    const int harmonics = count < 12 ? 2 : SineFitter::most_harmonics;
    SineFitter fitter(two_pi / (length * sample_period), sample_period, count, harmonics);
    fitter.add(samples.data(), count);
    const SineFit fit = fitter.knownFrequency();
    if (!(fit.residual < options.largest_residual * fit.amplitude))
    {
      return;
    }
    Cycle cycle;
    cycle.last = number;
    cycle.first = cycle.last - count;
    cycle.time = 0.5 * (static_cast<double>(cycle.first) + static_cast<double>(cycle.last - 1));
    cycle.amplitude = fit.amplitude;
    cycle.advance = two_pi / length;
    cycle.phase = fit.phase;
    if (interrupted || !follows(cycle))
    {
      runs.push_back(cycles.size());
      interrupted = false;
    }
    else
    {
      const Cycle& before = cycles.back();
      const double expected = before.phase + 0.5 * (before.advance + cycle.advance) * (cycle.time - before.time);
      cycle.phase = expected + std::remainder(fit.phase - expected, two_pi);
    }
    cycles.push_back(cycle);
    locked = true;
    locked_until = number + static_cast<std::uint64_t>(cycles_until_lost * length);
  }

  // Whether a cycle carries on the run of the last one.
  bool follows(const Cycle& cycle) const
  {
    const Cycle& before = cycles.back();
    return (cycle.time - before.time) * std::min(cycle.advance, before.advance) < longest_hole * two_pi;
  }

  void searchRun(std::vector<Cycle> run, std::vector<FoundStep>& steps) const
  {
    if (run.size() < static_cast<std::size_t>(options.shortest_step))
    {
      return;
    }
    weigh(run);
    std::vector<Line> lines = cutIntoLines(run);
    if (std::vector<Cycle> kept = withoutScraps(run, lines); kept.size() < run.size())
    {
      run = std::move(kept);
      lines = cutIntoLines(run);
    }
    lines = refineCuts(run, std::move(lines));
    const std::vector<bool> constant = constantLines(run, lines);
    const StretchSearch search(run, options);
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < lines.size(); ++i)
    {
      for (const Stretch& stretch : constant[i] ? search.within(lines[i]) : std::vector<Stretch>())
      {
        Candidate candidate;
        candidate.line = lineThrough(run, stretch.first, stretch.last);
        candidate.step.first = run[stretch.first].first;
        candidate.step.last = run[stretch.last - 1].last;
        candidate.step.frequency = candidate.line.slope / sample_period;
        candidate.step.amplitude = search.medianAmplitude(stretch);
        take(candidate, candidates);
      }
    }
    for (std::size_t i = 0; i + 1 < candidates.size(); ++i)
    {
      joinSteps(candidates[i], candidates[i + 1]);
    }
    for (const Candidate& candidate : candidates)
    {
      steps.push_back(candidate.step);
    }
  }

  // A short stretch of hardly another frequency and amplitude beside a long one is the end of its soft start, not a
  // step.
  void take(const Candidate& candidate, std::vector<Candidate>& candidates) const
  {
    if (!candidates.empty())
    {
      const FoundStep& before = candidates.back().step;
      const FoundStep& step = candidate.step;
      const bool close = std::abs(step.frequency - before.frequency) < 1.0e-3 * step.frequency &&
                         std::abs(step.amplitude - before.amplitude) < options.amplitude_tolerance * step.amplitude &&
                         static_cast<double>(step.first - before.last) * step.frequency * sample_period < two_pi;
      if (close && 4 * (step.last - step.first) < before.last - before.first)
      {
        return;
      }
      if (close && 4 * (before.last - before.first) < step.last - step.first)
      {
        candidates.pop_back();
      }
    }
    candidates.push_back(candidate);
  }

  double sample_period;
  StepSearchOptions options;

  // The signal since its last interruption.
  std::uint64_t number = 0;  // of the next sample
  bool started = false;
  bool interrupted = true;  // since the last cycle
  std::size_t memory;       // samples over which the range of the signal is remembered: one to two times as many
  std::size_t in_memory = 0;
  double low = 0.0;
  double high = 0.0;
  double before_low = 0.0;
  double before_high = 0.0;
  bool locked = false;  // onto good cycles
  std::uint64_t locked_until = 0;
  bool rising = false;
  double turning = 0.0;  // the extreme since the last turn
  double last_sample = 0.0;

  // The cycle under way.
  bool onset_known = false;
  double onset = 0.0;
  std::vector<double> samples;  // since the last crossing

  std::vector<Cycle> cycles;
  std::vector<std::size_t> runs;  // the first cycle of each
};

DriveStepFinder::DriveStepFinder(double sample_period, const StepSearchOptions& options)
{
  const auto require = [](bool fulfilled, const char* name, double value, const char* allowed)
  {
    if (!fulfilled)
    {
      std::ostringstream text;
      text << "step search: " << name << " is " << value << ", must be " << allowed;
      throw std::invalid_argument(text.str());
    }
  };
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  require(positive(sample_period), "sample_period", sample_period, "> 0");
  require(options.shortest_step >= 4, "shortest_step", options.shortest_step, ">= 4");
  require(options.amplitude_tolerance > 0.0 && options.amplitude_tolerance < 1.0, "amplitude_tolerance",
          options.amplitude_tolerance, "in (0, 1)");
  require(positive(options.lowest_frequency) && options.lowest_frequency * sample_period > 1.0e-9 &&
              options.lowest_frequency * sample_period < 0.1,
          "lowest_frequency", options.lowest_frequency, "> 0 and less than a tenth of the sample rate");
  require(positive(options.largest_residual), "largest_residual", options.largest_residual, "> 0");
  implementation_ = std::make_unique<Implementation>(sample_period, options);
}

DriveStepFinder::~DriveStepFinder() = default;
DriveStepFinder::DriveStepFinder(DriveStepFinder&&) noexcept = default;
DriveStepFinder& DriveStepFinder::operator=(DriveStepFinder&&) noexcept = default;

void DriveStepFinder::add(std::uint64_t first, const double* samples, std::size_t count)
{
  implementation_->add(first, samples, count);
}

std::vector<FoundStep> DriveStepFinder::finish()
{
  std::vector<FoundStep> steps;
  const std::vector<std::size_t>& runs = implementation_->runs;
  for (std::size_t i = 0; i < runs.size(); ++i)
  {
    const std::vector<Cycle>& cycles = implementation_->cycles;
    const std::size_t last = i + 1 < runs.size() ? runs[i + 1] : cycles.size();
    implementation_->searchRun(
        {cycles.begin() + static_cast<std::ptrdiff_t>(runs[i]), cycles.begin() + static_cast<std::ptrdiff_t>(last)},
        steps);
  }
  return steps;
}

DriveStepMeter::DriveStepMeter(const std::vector<FoundStep>& steps, double sample_period)
{
  for (const FoundStep& step : steps)
  {
    const double half_cycle = 0.5 * two_pi / (step.frequency * sample_period);
    const auto margin = static_cast<std::uint64_t>(std::ceil(half_cycle));
    const std::uint64_t length = step.last - step.first - 2 * margin;
    pieces_.push_back(
        {step, step.first + margin,
         SineFitter(step.frequency, sample_period, static_cast<std::size_t>(length), SineFitter::most_harmonics)});
  }
}

void DriveStepMeter::add(std::uint64_t first, const double* samples, std::size_t count)
{
  const std::uint64_t last = first + count;
  while (current_ < pieces_.size() && last > pieces_[current_].fit_first)
  {
    Piece& piece = pieces_[current_];
    const std::uint64_t wanted = piece.fit_first + piece.fitter.added();
    if (first > wanted)
    {
      return;
    }
    if (last > wanted)
    {
      piece.fitter.add(samples + (wanted - first), static_cast<std::size_t>(last - wanted));
    }
    if (!piece.fitter.complete())
    {
      return;
    }
    ++current_;
  }
}

std::vector<MeasuredStep> DriveStepMeter::finish() const
{
  std::vector<MeasuredStep> measured;
  for (const Piece& piece : pieces_)
  {
    if (!piece.fitter.complete())
    {
      throw std::logic_error("the samples of the step from sample " + std::to_string(piece.step.first) + " to " +
                             std::to_string(piece.step.last) + " are not all there");
    }
    measured.push_back({piece.step.first, piece.step.last, piece.fitter.unknownFrequency()});
  }
  return measured;
}

std::vector<MeasuredStep> findDriveSteps(const double* samples, std::size_t count, double sample_period,
                                         const StepSearchOptions& options)
{
  DriveStepFinder finder(sample_period, options);
  finder.add(0, samples, count);
  DriveStepMeter meter(finder.finish(), sample_period);
  meter.add(0, samples, count);
  return meter.finish();
}

DriveStep driveStep(const MeasuredStep& step, double sample_period)
{
  return {step.fit.frequency, step.fit.amplitude, static_cast<double>(step.first) * sample_period,
          static_cast<double>(step.last) * sample_period};
}
}  // namespace vibro_impact::core
