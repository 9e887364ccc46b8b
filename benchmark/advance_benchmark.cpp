// How fast the motion is advanced under a sampled drive, as the simulator does it: blocks of 250 samples at 50 kHz.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "vibro_impact/config/configuration.h"
#include "vibro_impact/core/simulation.h"
#include "vibro_impact/core/switched_model.h"

namespace
{
using namespace vibro_impact;

constexpr double two_pi = 6.28318530717958647693;
constexpr std::size_t sample_rate = 50'000;
constexpr std::size_t block = 250;  // a divisor of the sample rate

class ImpactCounter : public core::ImpactSink
{
public:
  void onImpact(const core::Impact&) override
  {
    ++impacts_;
  }
  std::uint64_t impacts() const
  {
    return impacts_;
  }

private:
  std::uint64_t impacts_ = 0;
};

/// The shipped configuration `file`, with `modes_per_beam` in the attachment basis, at a resonance, omega* = 1.6 but
/// for a fraction of a hertz: a second of the drive holds whole cycles, and is repeated. Counters are by seconds of CPU
/// time.
void advance(benchmark::State& state, const std::string& file, int modes_per_beam)
{
  core::SystemParameters parameters = config::loadFile(CONFIG_DIRECTORY "/" + file);
  parameters.basis = core::AttachmentBasis{modes_per_beam};
  const auto model = std::make_shared<const core::SwitchedModel>(parameters);
  core::SampledSimulation simulation(model, 1.0 / sample_rate);
  ImpactCounter sink;

  const double cycles = std::round(1.6 * model->scales().frequency / two_pi);
  std::vector<double> acceleration(sample_rate);
  for (std::size_t i = 0; i < acceleration.size(); ++i)
  {
    acceleration[i] = -std::cos(two_pi * cycles * static_cast<double>(i) / sample_rate);
  }
  std::vector<double> gap(acceleration.size());
  std::vector<double> force(acceleration.size());
  simulation.advance(acceleration.data(), acceleration.size(), gap.data(), force.data(), sink);  // the transient

  const std::uint64_t samples_before = simulation.samples();
  const std::uint64_t impacts_before = sink.impacts();
  for (auto _ : state)
  {
    const std::size_t start = simulation.samples() % sample_rate;
    simulation.advance(&acceleration[start], block, gap.data(), force.data(), sink);
    benchmark::DoNotOptimize(force.data());
  }
  const double seconds = static_cast<double>(simulation.samples() - samples_before) / sample_rate;
  const auto impacts = static_cast<double>(sink.impacts() - impacts_before);
  state.counters["real_time_factor"] = benchmark::Counter(seconds, benchmark::Counter::kIsRate);
  state.counters["impacts"] = benchmark::Counter(impacts, benchmark::Counter::kIsRate);
}
}  // namespace

BENCHMARK_CAPTURE(advance, limiting_case, "limiting_case.yaml", 5);
BENCHMARK_CAPTURE(advance, table1, "table1.yaml", 5);
BENCHMARK_CAPTURE(advance, table1_as_shipped, "table1.yaml", 16);

BENCHMARK_MAIN();
