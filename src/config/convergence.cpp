#include "vibro_impact/config/convergence.h"

#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "vibro_impact/config/model_summary.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/response.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::config
{
namespace
{
constexpr double two_pi = 6.28318530717958647693;
// Batches long enough to be independent of each other, and enough of them for a standard error.
constexpr std::uint64_t batches = 50;
// Beyond this many standard errors two means are taken to differ: with fifty batches, one pair in 5000 by chance.
constexpr double significant = 4.0;
// The relative kick that the neighbouring motion gets, the distance (in cycles) at which it is no longer one, and the
// drive cycles it is given. A distance that grows in proportion to time does not get there.
constexpr double kick = 1.0e-9;
constexpr double parted = 1.0e-3;
constexpr std::uint64_t parting_cycles = 1000;

class ImpactCollector : public core::ImpactSink
{
public:
  void onImpact(const core::Impact& impact) override
  {
    if (!impact.cut_short)
    {
      impacts.push_back(impact);
    }
  }
  std::vector<core::Impact> impacts;
};

double processorTime()
{
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1.0e-9 * static_cast<double>(now.tv_nsec);
}

double circularDistance(double one, double other, double period)
{
  const double distance = std::fabs(std::fmod(one - other, period));
  return std::min(distance, period - distance);
}

std::vector<std::size_t> nearestPartners(const std::vector<PhasedImpact>& from, const std::vector<PhasedImpact>& to,
                                         double shift, double period)
{
  std::vector<std::size_t> partners;
  for (const PhasedImpact& impact : from)
  {
    const auto partner = std::min_element(to.begin(), to.end(),
                                          [&](const PhasedImpact& a, const PhasedImpact& b)
                                          {
                                            return circularDistance(impact.phase, a.phase + shift, period) <
                                                   circularDistance(impact.phase, b.phase + shift, period);
                                          });
    partners.push_back(static_cast<std::size_t>(partner - to.begin()));
  }
  return partners;
}

ImpactChange changeAt(const std::vector<PhasedImpact>& one, const std::vector<PhasedImpact>& other, double shift,
                      double period)
{
  double greatest = 0.0;
  for (const auto* impacts : {&one, &other})
  {
    for (const PhasedImpact& impact : *impacts)
    {
      greatest = std::max(greatest, std::abs(impact.impulse));
    }
  }
  if (greatest == 0.0)
  {
    return {};
  }
  ImpactChange change;
  std::vector<bool> has_partner(other.size(), false);
  if (!other.empty())
  {
    const auto there = nearestPartners(one, other, shift, period);
    const auto back = nearestPartners(other, one, -shift, period);
    for (std::size_t i = 0; i < one.size(); ++i)
    {
      const std::size_t j = there[i];
      const bool partners = back[j] == i;
      has_partner[j] = has_partner[j] || partners;
      const double impulse = partners ? one[i].impulse - other[j].impulse : one[i].impulse;
      change.impulse = std::max(change.impulse, std::abs(impulse) / greatest);
      if (partners)
      {
        change.onset = std::max(change.onset, circularDistance(one[i].phase, other[j].phase + shift, period));
      }
    }
  }
  else
  {
    change.impulse = 1.0;
  }
  for (std::size_t j = 0; j < other.size(); ++j)
  {
    if (!has_partner[j])
    {
      change.impulse = std::max(change.impulse, std::abs(other[j].impulse) / greatest);
    }
  }
  return change;
}

bool agree(const Estimate& one, const Estimate& other, double accuracy)
{
  const double allowed = std::max(accuracy * std::abs(other.value), significant * std::hypot(one.error, other.error));
  return std::abs(one.value - other.value) <= allowed;
}

constexpr Estimate ImpactStatistics::*estimates[] = {
    &ImpactStatistics::impulse_mean,
    &ImpactStatistics::impulse_spread,
    &ImpactStatistics::impacts_per_cycle,
    &ImpactStatistics::impulse_per_cycle,
};

bool agree(const BasisRun& one, const BasisRun& other, double accuracy)
{
  if (one.period != other.period)
  {
    return false;
  }
  if (one.period == 0)
  {
    return std::all_of(std::begin(estimates), std::end(estimates),
                       [&](auto estimate)
                       { return agree((*one.statistics).*estimate, (*other.statistics).*estimate, accuracy); });
  }
  const ImpactChange change = compareImpacts(one.impacts, other.impacts, one.period);
  return change.impulse <= accuracy && change.onset <= accuracy;
}

void raise(std::optional<double>& greatest, double value)
{
  greatest = std::max(greatest.value_or(value), value);
}

// Tells each run how it stands to the larger ones.
void compareWithLarger(Convergence& result, double accuracy)
{
  for (std::size_t i = 0; i < result.runs.size(); ++i)
  {
    BasisRun& run = result.runs[i];
    run.agrees = i + 1 < result.runs.size();
    for (std::size_t j = i + 1; j < result.runs.size(); ++j)
    {
      const BasisRun& larger = result.runs[j];
      run.agrees = run.agrees && agree(run, larger, accuracy);
      if (run.period != larger.period)
      {
        continue;
      }
      if (run.period == 0)
      {
        raise(run.statistics_apart, standardErrorsApart(*run.statistics, *larger.statistics));
        continue;
      }
      const ImpactChange change = compareImpacts(run.impacts, larger.impacts, run.period);
      raise(run.impulse_change, change.impulse);
      raise(run.onset_change, change.onset);
    }
  }
}

// The smallest basis that agrees with all larger ones, if the largest has twice as many coordinates that matter or all
// there are: where added modes have a node at the contact, agreement with the next basis proves nothing.
std::optional<std::size_t> findSettled(const Convergence& result)
{
  for (std::size_t i = 0; i < result.runs.size(); ++i)
  {
    if (result.complete && (result.runs[i].agrees || i + 1 == result.runs.size()))
    {
      return i;
    }
    if (result.runs[i].agrees)
    {
      return result.runs.back().moving_coordinates >= 2 * result.runs[i].moving_coordinates
                 ? std::optional<std::size_t>(i)
                 : std::nullopt;
    }
  }
  return std::nullopt;
}

core::BasisParameters withModes(const core::BasisParameters& basis, int modes)
{
  if (std::holds_alternative<core::ConjoinedBasis>(basis))
  {
    return core::ConjoinedBasis{modes, modes};
  }
  return core::AttachmentBasis{modes};
}

// Every number of modes while they matter one by one, then wider steps.
int nextModes(int modes)
{
  return modes + (modes < 12 ? 1 : modes < 24 ? 2 : modes < 48 ? 4 : 8);
}

std::vector<core::TimedImpact> timed(const std::vector<core::Impact>& impacts, double cycle, std::uint64_t from)
{
  std::vector<core::TimedImpact> result;
  for (const core::Impact& impact : impacts)
  {
    if (impact.interval >= from)
    {
      result.push_back({static_cast<double>(impact.interval) * cycle + impact.offset, impact});
    }
  }
  return result;
}

// Period and impacts of the second half of a run, in which the transient is gone.
void evaluate(BasisRun& run, const core::SwitchedModel& model, const core::DriveStep& step,
              const std::vector<core::Impact>& impacts, std::uint64_t cycles)
{
  const double cycle = two_pi / step.frequency;
  const std::vector<core::TimedImpact> late = timed(impacts, cycle, cycles / 2);
  const core::ResponseRow row = core::evaluateResponse(step, late, model.scales()).row;
  run.period = row.period;
  run.impacts_per_cycle = row.impacts_per_cycle;
  run.impulse_per_cycle = row.impulse_per_cycle;
  run.impulse_mean = row.impacts_per_cycle > 0.0 ? row.impulse_per_cycle / row.impacts_per_cycle : 0.0;
  run.impacts.clear();
  const auto count = static_cast<std::ptrdiff_t>(std::llround(row.impacts_per_cycle * row.period));
  for (auto impact = late.end() - count; impact != late.end(); ++impact)
  {
    const double impulse = impact->impact.impulse;
    run.impulse_min = run.impacts.empty() ? impulse : std::min(run.impulse_min, impulse);
    run.impacts.push_back({std::fmod(impact->onset / cycle, run.period), impulse});
  }
}

// The impacts that follow a cycle of slightly different amplitude.
std::vector<core::Impact> kicked(const std::shared_ptr<const core::SwitchedModel>& model, double frequency,
                                 const ConvergenceOptions& options, double relative_kick)
{
  core::HarmonicSimulation simulation(model);
  ImpactCollector before;
  simulation.setDrive(frequency, options.acceleration);
  simulation.advance(options.cycles, before);
  simulation.setDrive(frequency, options.acceleration * (1.0 + relative_kick));
  simulation.advance(1, before);
  simulation.setDrive(frequency, options.acceleration);
  ImpactCollector after;
  simulation.advance(parting_cycles, after);
  return after.impacts;
}

// The factor by which two motions that begin next to each other part every cycle, if they do.
std::optional<double> findSeparation(const std::shared_ptr<const core::SwitchedModel>& model, double frequency,
                                     const ConvergenceOptions& options)
{
  constexpr double first_cycles = 3.0;
  const double cycle = two_pi / frequency;
  const auto one = timed(kicked(model, frequency, options, 0.0), cycle, 0);
  const auto other = timed(kicked(model, frequency, options, kick), cycle, 0);
  double start = std::numeric_limits<double>::epsilon();
  for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i)
  {
    const double time = one[i].onset / cycle;
    const double distance = std::abs(one[i].onset - other[i].onset) / cycle;
    if (distance > parted)
    {
      return std::pow(std::max(parted / start, 1.0), 1.0 / std::max(time, 1.0));
    }
    if (time < first_cycles)
    {
      start = std::max(start, distance);
    }
  }
  return std::nullopt;
}

BasisRun runBasis(const core::SystemParameters& parameters, int modes, double omega_star,
                  const ConvergenceOptions& options)
{
  const auto model = std::make_shared<const core::SwitchedModel>(parameters);
  const ModelSummary summary = summarize(*model);
  BasisRun run;
  run.modes = modes;
  run.free_frequency_hz = summary.free_frequency_hz;
  run.contact_frequency_hz = summary.contact_frequency_hz;
  run.highest_frequency_hz = summary.contact_frequencies.back();
  run.mapping_loss = *std::max_element(summary.mapping_loss.begin(), summary.mapping_loss.end());
  const Eigen::ArrayXd deflection = model->free().contact_deflection.abs();
  run.coordinates = static_cast<int>(model->free().size());
  run.moving_coordinates = static_cast<int>((deflection > 1.0e-9 * deflection.maxCoeff()).count());

  const double frequency = omega_star * model->scales().frequency;
  core::HarmonicSimulation simulation(model);
  simulation.setDrive(frequency, options.acceleration);
  ImpactCollector collector;
  const double started = processorTime();
  simulation.advance(options.cycles, collector);
  run.cost = (processorTime() - started) / static_cast<double>(options.cycles);
  const auto step = [&]
  {
    const double end = simulation.time();
    return core::DriveStep{frequency, options.acceleration, 0.5 * end, end};
  };
  evaluate(run, *model, step(), collector.impacts, options.cycles);
  if (run.period > 0)
  {
    return run;
  }

  // And one cycle, in which an episode that has begun before comes to its end.
  simulation.advance(options.statistics_cycles + 1, collector);
  evaluate(run, *model, step(), collector.impacts, options.cycles + options.statistics_cycles);
  if (run.period > 0)
  {
    return run;
  }
  std::vector<CountedImpact> counted;
  for (const core::Impact& impact : collector.impacts)
  {
    if (impact.interval >= options.cycles && impact.interval < options.cycles + options.statistics_cycles)
    {
      counted.push_back({impact.interval - options.cycles, impact.impulse});
      run.impulse_min = counted.size() == 1 ? impact.impulse : std::min(run.impulse_min, impact.impulse);
    }
  }
  run.statistics = impactStatistics(counted, options.statistics_cycles);
  run.impacts_per_cycle = run.statistics->impacts_per_cycle.value;
  run.impulse_per_cycle = run.statistics->impulse_per_cycle.value;
  run.impulse_mean = run.statistics->impulse_mean.value;
  run.separation = findSeparation(model, frequency, options);
  return run;
}

// Coordinates of the largest basis; 0 if so many modes cannot be had. Throws where a drive meets an undamped resonance:
// it has all natural frequencies of S0 that a smaller one has, which so need not be computed in vain.
Eigen::Index checkLargestBasis(core::SystemParameters parameters, const ConvergenceOptions& options)
{
  parameters.basis = withModes(parameters.basis, options.most_modes);
  if (!core::findFaults(parameters).empty())
  {
    return 0;
  }
  const auto model = std::make_shared<const core::SwitchedModel>(parameters);
  core::HarmonicSimulation simulation(model);
  for (const double omega_star : options.omega_stars)
  {
    simulation.setDrive(omega_star * model->scales().frequency, options.acceleration);
  }
  return model->free().size();
}

Convergence convergeAt(core::SystemParameters parameters, double omega_star, const ConvergenceOptions& options,
                       Eigen::Index most_coordinates, std::atomic<std::size_t>& runs)
{
  Convergence result;
  result.omega_star = omega_star;
  for (int modes = 1; !result.settled; modes = std::min(nextModes(modes), options.most_modes))
  {
    parameters.basis = withModes(parameters.basis, modes);
    if (!core::findFaults(parameters).empty())
    {
      break;  // so many modes cannot be had
    }
    result.runs.push_back(runBasis(parameters, modes, omega_star, options));
    ++runs;
    // A modal table has no more modes than it lists.
    result.complete = modes < options.most_modes && result.runs.back().coordinates == most_coordinates;
    compareWithLarger(result, options.accuracy);
    result.settled = findSettled(result);
    if (modes >= options.most_modes || result.complete)
    {
      break;
    }
  }
  return result;
}

}  // namespace

ImpactChange compareImpacts(const std::vector<PhasedImpact>& one, const std::vector<PhasedImpact>& other, int period)
{
  ImpactChange least = changeAt(one, other, 0.0, period);
  for (int shift = 1; shift < period; ++shift)
  {
    const ImpactChange change = changeAt(one, other, shift, period);
    if (change.impulse + change.onset < least.impulse + least.onset)
    {
      least = change;
    }
  }
  return least;
}

ImpactStatistics impactStatistics(const std::vector<CountedImpact>& impacts, std::uint64_t cycles)
{
  if (cycles < 2 * batches)
  {
    throw std::invalid_argument("cycles: " + std::to_string(cycles) + "; allowed: at least " +
                                std::to_string(2 * batches));
  }
  struct Sums
  {
    double impacts = 0.0, impulse = 0.0, square = 0.0;
  };
  // What does not fill a batch is left out.
  const std::uint64_t batch_cycles = cycles / batches;
  std::vector<Sums> sums(batches);
  Sums total;
  for (const CountedImpact& impact : impacts)
  {
    const std::uint64_t batch = impact.cycle / batch_cycles;
    if (batch >= batches)
    {
      continue;
    }
    for (Sums* sum : {&sums[batch], &total})
    {
      sum->impacts += 1.0;
      sum->impulse += impact.impulse;
      sum->square += impact.impulse * impact.impulse;
    }
  }
  // The standard error of a quotient of two totals from what each batch deviates by from that quotient.
  constexpr double n = batches;
  const auto standard_error = [&](const auto& deviation, double divisor)
  {
    double square = 0.0;
    for (const Sums& sum : sums)
    {
      square += deviation(sum) * deviation(sum);
    }
    return divisor > 0.0 ? n / divisor * std::sqrt(square / (n * (n - 1.0))) : 0.0;
  };
  const double all_cycles = n * static_cast<double>(batch_cycles);
  const auto length = static_cast<double>(batch_cycles);
  ImpactStatistics result;
  result.impacts_per_cycle.value = total.impacts / all_cycles;
  result.impulse_per_cycle.value = total.impulse / all_cycles;
  result.impacts_per_cycle.error = standard_error(
      [&](const Sums& sum) { return sum.impacts - result.impacts_per_cycle.value * length; }, all_cycles);
  result.impulse_per_cycle.error = standard_error(
      [&](const Sums& sum) { return sum.impulse - result.impulse_per_cycle.value * length; }, all_cycles);
  if (total.impacts > 0.0)
  {
    const double mean = total.impulse / total.impacts;
    const double variance = std::max(0.0, total.square / total.impacts - mean * mean);
    const double spread = std::sqrt(variance);
    result.impulse_mean.value = mean;
    result.impulse_mean.error =
        standard_error([&](const Sums& sum) { return sum.impulse - mean * sum.impacts; }, total.impacts);
    result.impulse_spread.value = spread;
    const double variance_error = standard_error(
        [&](const Sums& sum) { return sum.square - 2.0 * mean * sum.impulse + (mean * mean - variance) * sum.impacts; },
        total.impacts);
    result.impulse_spread.error = spread > 0.0 ? variance_error / (2.0 * spread) : 0.0;
  }
  return result;
}

double standardErrorsApart(const ImpactStatistics& one, const ImpactStatistics& other)
{
  double apart = 0.0;
  for (const auto estimate : estimates)
  {
    const double difference = std::abs((one.*estimate).value - (other.*estimate).value);
    if (difference > 0.0)
    {
      apart = std::max(apart, difference / std::hypot((one.*estimate).error, (other.*estimate).error));
    }
  }
  return apart;
}

std::vector<Convergence> converge(const core::SystemParameters& parameters, const ConvergenceOptions& options,
                                  const std::function<void(const ConvergenceProgress&)>& progress)
{
  const Eigen::Index most_coordinates = checkLargestBasis(parameters, options);
  std::vector<Convergence> results(options.omega_stars.size());
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  std::atomic<std::size_t> runs{0};
  const auto work = [&]
  {
    try
    {
      for (std::size_t index = next++; index < results.size(); index = next++)
      {
        results[index] = convergeAt(parameters, options.omega_stars[index], options, most_coordinates, runs);
        ++done;
      }
    }
    catch (...)
    {
      next = results.size();  // nobody else need go on
      throw;
    }
  };
  std::vector<std::future<void>> workers(std::min<std::size_t>(options.threads, results.size()));
  std::generate(workers.begin(), workers.end(), [&work] { return std::async(std::launch::async, work); });
  for (std::future<void>& worker : workers)
  {
    while (worker.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
    {
      progress({done, runs});
    }
  }
  for (std::future<void>& worker : workers)
  {
    worker.get();
  }
  progress({done, runs});
  return results;
}

}  // namespace vibro_impact::config
