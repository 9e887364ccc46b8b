// The sums of the monitor without a graph: impacts and the force of their blocks in, statistics out.

#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "vibro_impact/core/response_monitor.h"

namespace core = vibro_impact::core;

namespace
{
constexpr std::size_t block_size = 250;
constexpr double sample_period = 2.0e-5;
constexpr core::StreamTime block_time = 5'000'000;

/// `impacts` per block of 5 ms, one window of a second with five reports in it. `items_per_second` are impacts.
void sumUp(benchmark::State& state)
{
  const std::int64_t impacts = state.range(0);
  core::ResponseMonitor monitor{core::MonitorOptions()};
  std::vector<double> force(block_size, 0.0);
  for (std::size_t i = 0; i < block_size; i += 4)
  {
    force[i] = 1.0;
  }
  core::StreamTime now = 1'700'000'000'000'000'000;
  core::ReleasedImpact impact;
  impact.duration = 2.0e-5;
  std::uint64_t block = 0;
  std::uint64_t reports = 0;
  for ([[maybe_unused]] auto step : state)
  {
    for (std::int64_t i = 0; i < impacts; ++i)
    {
      impact.onset = now + i * (block_time / impacts);
      impact.release = impact.onset + 20'000;
      impact.impulse = 1.0e-6 * static_cast<double>(1 + impact.number % 7);
      monitor.addImpact(impact);
      ++impact.number;
    }
    monitor.addForce({block * block_size, now, sample_period, force.data(), force.size()});
    while (const core::ResponseStatistics* statistics = monitor.next())
    {
      benchmark::DoNotOptimize(statistics->total.impulse);
      ++reports;
    }
    now += block_time;
    ++block;
  }
  if (monitor.impacts().missing() > 0 || monitor.lateImpacts() > 0)
  {
    state.SkipWithError("impacts are missing");
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(monitor.impacts().taken()));
  state.counters["reports"] = static_cast<double>(reports);
  state.counters["real_time_factor"] =
      benchmark::Counter(static_cast<double>(block) * core::seconds(block_time), benchmark::Counter::kIsRate);
}
}  // namespace

BENCHMARK(sumUp)->Name("monitor/impacts_per_block")->Arg(2)->Arg(25)->Arg(250);

BENCHMARK_MAIN();
