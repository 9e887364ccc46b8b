// The longest advance of one block: ten simulated minutes of chaotic response from rest, 5 ms blocks at 50 kHz.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "stopwatch.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/simulation.h"

namespace
{
using namespace vibro_impact;

constexpr double sample_rate = 50'000.0;
constexpr std::size_t block = 250;
constexpr std::size_t blocks = 120'000;
constexpr double block_time = static_cast<double>(block) / sample_rate;

class ImpactCounter : public core::ImpactSink
{
public:
  void onImpact(const core::Impact& /*impact*/) override
  {
    ++impacts;
  }
  std::uint64_t impacts = 0;
};

struct Times
{
  std::vector<double> processor;  // s, one per block
  std::vector<double> wall;
  std::uint64_t impacts = 0;
};

Times run(const std::shared_ptr<const core::SwitchedModel>& model, double frequency)
{
  core::SampledSimulation simulation(model, 1.0 / sample_rate);
  ImpactCounter sink;
  std::array<double, block> acceleration{};
  std::array<double, block> gap{};
  std::array<double, block> force{};
  Times times;
  times.processor.reserve(blocks);
  times.wall.reserve(blocks);
  for (std::size_t b = 0; b < blocks; ++b)
  {
    for (std::size_t i = 0; i < block; ++i)
    {
      acceleration[i] = -std::cos(frequency * static_cast<double>(b * block + i) / sample_rate);
    }
    const double processor = threadTime();
    const double wall = wallTime();
    simulation.advance(acceleration.data(), block, gap.data(), force.data(), sink);
    times.wall.push_back(wallTime() - wall);
    times.processor.push_back(threadTime() - processor);
  }
  times.impacts = sink.impacts;
  return times;
}

void print(const char* what, std::vector<double> times)
{
  std::sort(times.begin(), times.end());
  const auto quantile = [&](double q) {
    return 1.0e6 * times[std::min(times.size() - 1, static_cast<std::size_t>(q * static_cast<double>(times.size())))];
  };
  const double longest = quantile(1.0);
  std::printf("  %-36s %8.1f %8.1f %8.1f %9.4f  %s\n", what, quantile(0.5), quantile(0.999), longest,
              1.0e-6 * longest / block_time, 1.0e-6 * longest < 0.1 * block_time ? "yes" : "no");
}

void measure(const std::string& file, int modes_per_beam, double omega_star)
{
  core::SystemParameters parameters = config::loadFile(CONFIG_DIRECTORY "/" + file);
  parameters.basis = core::AttachmentBasis{modes_per_beam};
  const auto model = std::make_shared<const core::SwitchedModel>(parameters);
  const double frequency = omega_star * model->scales().frequency;

  core::HarmonicSimulation harmonic(model);
  const int period = core::harmonicResponse(harmonic, frequency, 1.0, 2000).row.period;

  // What others do on the machine seldom falls on the same block three times.
  constexpr int runs = 3;
  Times first = run(model, frequency);
  std::vector<double> least = first.processor;
  for (int i = 1; i < runs; ++i)
  {
    const Times again = run(model, frequency);
    std::transform(least.begin(), least.end(), again.processor.begin(), least.begin(),
                   [](double a, double b) { return std::min(a, b); });
  }
  std::printf("%s, %d modes per beam, omega* %g: %llu impacts, %s\n", file.c_str(), modes_per_beam, omega_star,
              static_cast<unsigned long long>(first.impacts),
              period == 0 ? "no period up to 16 cycles" : ("period " + std::to_string(period)).c_str());
  print("processor time, least of three runs", least);
  print("processor time, first run", first.processor);
  print("wall time, first run", first.wall);
  const auto longest = std::max_element(least.begin(), least.end());
  std::printf("  the longest block is number %td\n", longest - least.begin());
  std::fflush(stdout);
}
}  // namespace

int main()
{
  std::printf("%-38s %8s %8s %8s %9s  %s\n", "us per block of 5 ms", "p50", "p99.9", "maximum", "of block",
              "under a tenth?");
  measure("limiting_case.yaml", 5, 2.17);
  measure("table1.yaml", 5, 2.4);
  measure("table1.yaml", 16, 2.4);
  return 0;
}
