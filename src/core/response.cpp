#include "vibro_impact/core/response.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace vibro_impact::core
{
namespace
{
constexpr double two_pi = 6.28318530717958647693;

/// The sequence of impacts repeats: `impacts` of them in `cycles` drive cycles.
struct Recurrence
{
  int cycles = 0;
  std::size_t impacts = 0;
};

/// Whether each of the last impacts equals the one `shift` impacts before it, `cycles` drive cycles later.
bool repeats(const std::vector<TimedImpact>& impacts, std::size_t shift, int cycles, double cycle,
             const ResponseOptions& options)
{
  double greatest = 0.0;
  for (const TimedImpact& timed : impacts)
  {
    greatest = std::max(greatest, std::abs(timed.impact.impulse));
  }
  const std::size_t compared =
      std::min(std::max(shift, static_cast<std::size_t>(options.captured_impacts)), impacts.size() - shift);
  for (std::size_t i = impacts.size() - compared; i < impacts.size(); ++i)
  {
    const TimedImpact& now = impacts[i];
    const TimedImpact& before = impacts[i - shift];
    if (std::abs(now.onset - before.onset - cycles * cycle) > options.tolerance * cycle ||
        std::abs(now.impact.impulse - before.impact.impulse) > options.tolerance * greatest)
    {
      return false;
    }
  }
  return true;
}

Recurrence findRecurrence(const std::vector<TimedImpact>& impacts, double cycle, const ResponseOptions& options)
{
  for (int cycles = 1; cycles <= options.longest_period; ++cycles)
  {
    // The partner of the last impact fixes how many impacts there are in so many cycles.
    const double wanted = impacts.back().onset - cycles * cycle;
    const auto partner = std::lower_bound(impacts.begin(), impacts.end(), wanted - options.tolerance * cycle,
                                          [](const TimedImpact& timed, double time) { return timed.onset < time; });
    const auto shift = static_cast<std::size_t>(impacts.end() - 1 - partner);
    // Enough of them must be there to be compared: a whole period twice.
    if (shift == 0 || 2 * shift > impacts.size())
    {
      continue;
    }
    if (repeats(impacts, shift, cycles, cycle, options))
    {
      return {cycles, shift};
    }
  }
  return {};
}

struct Totals
{
  double impacts = 0.0;
  double impulse = 0.0;
};

Totals totals(const std::vector<TimedImpact>& impacts, double from, double to)
{
  Totals sum;
  for (const TimedImpact& timed : impacts)
  {
    if (timed.onset >= from && timed.onset < to)
    {
      sum.impacts += 1.0;
      sum.impulse += timed.impact.impulse;
    }
  }
  return sum;
}
}  // namespace

Response evaluateResponse(const DriveStep& step, const std::vector<TimedImpact>& impacts, const ReferenceScales& scales,
                          const ResponseOptions& options)
{
  Response response;
  response.step = step;
  ResponseRow& row = response.row;
  row.omega_star = step.frequency / scales.frequency;
  row.frequency_hz = step.frequency / two_pi;
  row.acceleration = step.acceleration;
  row.contact_share = step.contact_share;
  row.stiffness = step.contact.stiffness;
  row.clearance = step.contact.clearance;

  std::vector<TimedImpact> whole;
  std::copy_if(impacts.begin(), impacts.end(), std::back_inserter(whole),
               [](const TimedImpact& timed) { return !timed.impact.cut_short; });
  const double middle = 0.5 * (step.start + step.end);
  if (whole.empty() || whole.back().onset + whole.back().impact.duration < middle)
  {
    row.period = 1;
    row.steady = true;
    return response;
  }

  const double cycle = two_pi / step.frequency;
  const Recurrence recurrence = findRecurrence(whole, cycle, options);
  row.period = recurrence.cycles;
  if (recurrence.cycles > 0)
  {
    row.steady = true;
    const double cycles = recurrence.cycles;
    row.impacts_per_cycle = static_cast<double>(recurrence.impacts) / cycles;
    for (std::size_t i = whole.size() - recurrence.impacts; i < whole.size(); ++i)
    {
      row.impulse_per_cycle += whole[i].impact.impulse / cycles;
    }
  }
  else
  {
    // Nothing repeats: the averages of the third and the last quarter of the step tell whether it has settled.
    const double quarter = 0.25 * (step.end - step.start);
    const Totals third = totals(whole, step.end - 2.0 * quarter, step.end - quarter);
    const Totals last = totals(whole, step.end - quarter, step.end);
    const double sum = third.impulse + last.impulse;
    row.steady = std::abs(last.impulse - third.impulse) <= options.statistical_tolerance * std::abs(0.5 * sum);
    const double cycles = 2.0 * quarter / cycle;
    row.impacts_per_cycle = (third.impacts + last.impacts) / cycles;
    row.impulse_per_cycle = sum / cycles;
  }

  const std::size_t captured = std::min(whole.size(), static_cast<std::size_t>(options.captured_impacts));
  response.captured.assign(whole.end() - static_cast<std::ptrdiff_t>(captured), whole.end());
  row.impacts = static_cast<int>(captured);
  row.impulse_min = row.impulse_max = response.captured.front().impact.impulse;
  for (const TimedImpact& timed : response.captured)
  {
    const Impact& impact = timed.impact;
    row.impulse_mean += impact.impulse / static_cast<double>(captured);
    row.duration_mean += impact.duration / static_cast<double>(captured);
    row.impulse_min = std::min(row.impulse_min, impact.impulse);
    row.impulse_max = std::max(row.impulse_max, impact.impulse);
    row.peak_force = std::max(row.peak_force, impact.peak_force);
  }
  row.impulse_star_mean = scales.impulseStar(row.impulse_mean);
  row.impulse_star_min = scales.impulseStar(row.impulse_min);
  row.impulse_star_max = scales.impulseStar(row.impulse_max);
  return response;
}

int repetitionPeriod(const std::vector<TimedImpact>& impacts, double cycle, const ResponseOptions& options)
{
  return impacts.empty() ? 0 : findRecurrence(impacts, cycle, options).cycles;
}

}  // namespace vibro_impact::core
