#include "amplitude_stretches.h"

#include <algorithm>
#include <cmath>

#include "median.h"

namespace vibro_impact::core
{
AmplitudeStretches::AmplitudeStretches(const std::vector<DriveCycle>& cycles, const StepSearchOptions& options)
    : cycles_(cycles),
      shortest_(static_cast<std::size_t>(options.shortest_step)),
      tolerance_(options.amplitude_tolerance)
{
}

std::vector<AmplitudeStretch> AmplitudeStretches::within(const PhaseLine& line) const
{
  std::vector<AmplitudeStretch> found;
  search(line.first, line.last, tolerance_, found);
  return found;
}

double AmplitudeStretches::medianAmplitude(const AmplitudeStretch& stretch) const
{
  std::vector<double> values = amplitudes(stretch);
  return median(values);
}

std::vector<double> AmplitudeStretches::amplitudes(const AmplitudeStretch& stretch) const
{
  std::vector<double> values;
  for (std::size_t k = stretch.first; k < stretch.last; ++k)
  {
    values.push_back(cycles_[k].amplitude);
  }
  return values;
}

void AmplitudeStretches::search(std::size_t first, std::size_t last, double tolerance,
                                std::vector<AmplitudeStretch>& found) const
{
  if (last - first < shortest_)
  {
    return;
  }
  const double level = commonestAmplitude(first, last, tolerance);
  AmplitudeStretch longest{first, first};
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
  const AmplitudeStretch trimmed = trim(longest);
  found.push_back(trimmed.last - trimmed.first < shortest_ ? longest : trimmed);
  search(longest.last, last, tolerance_, found);
}

// Without single outliers.
double AmplitudeStretches::amplitudeAt(std::size_t k, std::size_t first, std::size_t last) const
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
double AmplitudeStretches::commonestAmplitude(std::size_t first, std::size_t last, double tolerance) const
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
AmplitudeStretch AmplitudeStretches::trim(AmplitudeStretch stretch) const
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
double AmplitudeStretches::scatter(const AmplitudeStretch& stretch) const
{
  std::vector<double> values;
  for (std::size_t k = stretch.first; k + 1 < stretch.last; ++k)
  {
    values.push_back(std::abs(cycles_[k + 1].amplitude - cycles_[k].amplitude));
  }
  return median_to_deviation * median(values) / std::sqrt(2.0);
}

// Change of the amplitude along a stretch, by a straight line through it.
double AmplitudeStretches::rise(const AmplitudeStretch& stretch) const
{
  const auto count = static_cast<double>(stretch.last - stretch.first);
  double moment = 0.0;
  for (std::size_t k = stretch.first; k < stretch.last; ++k)
  {
    moment += (static_cast<double>(k - stretch.first) - 0.5 * (count - 1.0)) * cycles_[k].amplitude;
  }
  return std::abs(12.0 * moment / (count * (count + 1.0)));
}

}  // namespace vibro_impact::core
