// How the cost grows: per sample with the modes, per sweep with frequencies, cycles and cores.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "stopwatch.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/sweep.h"
#include "vibro_impact/core/simulation.h"

namespace
{
using namespace vibro_impact;

constexpr int rounds = 3;

class Nobody : public core::ImpactSink
{
public:
  void onImpact(const core::Impact& /*impact*/) override
  {
  }
};

struct Timed
{
  double size;  // what the cost should be proportional to
  std::function<void()> run;
  double best = std::numeric_limits<double>::infinity();
};

/// All in turn, several times; of each the least time.
void measure(std::vector<Timed>& all, double (*clock)())
{
  for (int round = 0; round < rounds; ++round)
  {
    for (Timed& timed : all)
    {
      const double start = clock();
      timed.run();
      timed.best = std::min(timed.best, clock() - start);
    }
  }
}

/// Time by size, and how that compares with the one before: 1 is linear growth, less is better than that.
void print(const std::string& title, const std::vector<Timed>& all, double unit, const char* unit_name)
{
  std::printf("%s\n  %10s %14s %20s %8s\n", title.c_str(), "size", unit_name, "by size", "ratio");
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    const double each = all[i].best / all[i].size;
    std::printf("  %10g %14.5g %20.5g", all[i].size, all[i].best * unit, each * unit);
    if (i > 0)
    {
      std::printf(" %8.2f", each / (all[i - 1].best / all[i - 1].size));
    }
    std::printf("\n");
  }
  std::fflush(stdout);
}

void growthWithModes(double clearance, const std::string& what)
{
  constexpr double sample_rate = 50'000.0;
  constexpr std::size_t samples = 50'000;
  std::vector<Timed> all;
  std::vector<double> gap(samples);
  std::vector<double> force(samples);
  Nobody sink;
  std::vector<std::vector<double>> accelerations;
  std::vector<std::unique_ptr<core::SampledSimulation>> simulations;
  const std::vector<int> sizes = {2, 4, 8, 16, 32, 64};
  accelerations.reserve(sizes.size());
  for (const int modes : sizes)
  {
    core::SystemParameters parameters = config::loadFile(CONFIG_DIRECTORY "/limiting_case.yaml");
    parameters.contact.clearance = clearance;
    parameters.basis = core::AttachmentBasis{modes};
    const auto model = std::make_shared<const core::SwitchedModel>(parameters);
    std::vector<double>& acceleration = accelerations.emplace_back(samples);
    for (std::size_t i = 0; i < samples; ++i)
    {
      acceleration[i] = -std::cos(1.6 * model->scales().frequency * static_cast<double>(i) / sample_rate);
    }
    core::SampledSimulation* simulation =
        simulations.emplace_back(std::make_unique<core::SampledSimulation>(model, 1.0 / sample_rate)).get();
    all.push_back({static_cast<double>(modes), [&gap, &force, &sink, &acceleration, simulation]()
                   {
                     simulation->reset(sink);
                     simulation->advance(acceleration.data(), samples, gap.data(), force.data(), sink);
                   }});
  }
  measure(all, processTime);
  print("ns per sample over modes per beam, " + what, all, 1.0e9 / samples, "ns/sample");
}

std::function<void()> sweep(const std::shared_ptr<const core::SwitchedModel>& model, int points, std::uint64_t cycles,
                            unsigned threads)
{
  config::SweepOptions options;
  options.from = 0.5;
  options.to = 4.0;
  options.points = points;
  options.cycles = cycles;
  options.threads = threads;
  return [model, options]() { config::sweep(model, options, [](std::size_t) {}); };
}
}  // namespace

int main()
{
  growthWithModes(1.0, "no impacts");
  growthWithModes(0.0, "impacts at the resonance");

  const auto model =
      std::make_shared<const core::SwitchedModel>(config::loadFile(CONFIG_DIRECTORY "/limiting_case.yaml"));
  std::vector<Timed> all;
  for (const int points : {50, 100, 200, 400})
  {
    all.push_back({static_cast<double>(points), sweep(model, points, 200, 1)});
  }
  measure(all, processTime);
  print("ms per sweep over frequencies, 200 cycles each", all, 1.0e3, "ms");

  all.clear();
  for (const int cycles : {100, 200, 400, 800})
  {
    all.push_back({static_cast<double>(cycles), sweep(model, 100, static_cast<std::uint64_t>(cycles), 1)});
  }
  measure(all, processTime);
  print("ms per sweep over cycles, 100 frequencies", all, 1.0e3, "ms");

  all = {{1.0, sweep(model, 400, 400, 1)}, {2.0, sweep(model, 400, 400, 2)}};
  measure(all, wallTime);
  std::printf("sweep of 400 frequencies of 400 cycles: %.0f ms of wall time on one core, %.0f ms on two: %.2f times\n",
              1.0e3 * all[0].best, 1.0e3 * all[1].best, all[0].best / all[1].best);
  return 0;
}
