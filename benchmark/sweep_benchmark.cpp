// How long a direct sweep takes: 400 frequencies of 400 drive cycles each, omega* 0.5 to 4, on one thread.

#include <cstddef>
#include <memory>

#include <benchmark/benchmark.h>

#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/sweep.h"
#include "vibro_impact/core/switched_model.h"

namespace
{
using namespace vibro_impact;

void sweep(benchmark::State& state)
{
  const auto model =
      std::make_shared<const core::SwitchedModel>(config::loadFile(CONFIG_DIRECTORY "/limiting_case.yaml"));
  config::SweepOptions options;
  options.from = 0.5;
  options.to = 4.0;
  options.points = 400;
  options.cycles = 400;
  options.threads = 1;
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(config::sweep(model, options, [](std::size_t) {}).data());
  }
}
}  // namespace

BENCHMARK(sweep)->Name("sweep/limiting_case")->Unit(benchmark::kMillisecond)->Iterations(1)->MeasureProcessCPUTime();

BENCHMARK_MAIN();
