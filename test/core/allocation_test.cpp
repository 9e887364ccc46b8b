// The advance of the model asks for no memory.

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include <gtest/gtest.h>

#include "reference_system.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/simulation.h"

namespace
{
std::size_t allocations = 0;
}

// Eigen's own arrays come from malloc, so that is what has to be counted.
extern "C" void* __libc_malloc(std::size_t);  // NOLINT(readability-identifier-naming): the C library's
extern "C" void* malloc(std::size_t size) noexcept
{
  ++allocations;
  return __libc_malloc(size);
}

using namespace vibro_impact::core;

namespace
{
class Counter : public ImpactSink
{
public:
  void onImpact(const Impact& impact) override
  {
    sum += impact.impulse;
    ++count;
  }
  double sum = 0.0;
  int count = 0;
};
}  // namespace

TEST(Allocations, areCounted)
{
  const std::size_t before = allocations;
  const std::vector<double> values(1000, 1.0);
  EXPECT_GT(allocations, before);
}

TEST(Allocations, noneInTheAdvanceUnderASampledDrive)
{
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{5}), BasisParameters(ConjoinedBasis{3, 2})})
  {
    const auto model = std::make_shared<const SwitchedModel>(limitingCase(1000.0, basis));
    SampledSimulation simulation(model, 2e-5);
    std::vector<double> drive(20000);
    for (std::size_t i = 0; i < drive.size(); ++i)
    {
      drive[i] = 10.0 * std::sin(1.6 * model->scales().frequency * 2e-5 * static_cast<double>(i));
    }
    std::vector<double> gap(drive.size());
    std::vector<double> force(drive.size());
    Counter counter;
    const std::size_t before = allocations;
    simulation.advance(drive.data(), drive.size(), gap.data(), force.data(), counter);
    const std::size_t after = allocations;
    EXPECT_EQ(after - before, 0u);
    EXPECT_GT(counter.count, 100);
  }
}

TEST(Allocations, noneInTheAdvanceAfterAChangeOfTheContact)
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{5});
  SampledSimulation simulation(std::make_shared<const SwitchedModel>(parameters), 2e-5);
  parameters.contact = {0.7 * parameters.contact.stiffness, -1.0e-7};
  const auto worn = std::make_shared<const SwitchedModel>(parameters);
  std::vector<double> drive(20000);
  for (std::size_t i = 0; i < drive.size(); ++i)
  {
    drive[i] = 10.0 * std::sin(1.6 * worn->scales().frequency * 2e-5 * static_cast<double>(i));
  }
  std::vector<double> gap(drive.size());
  std::vector<double> force(drive.size());
  Counter counter;
  simulation.advance(drive.data(), 500, gap.data(), force.data(), counter);
  simulation.setModel(worn, counter);
  const std::size_t before = allocations;
  simulation.advance(drive.data() + 500, drive.size() - 500, gap.data(), force.data(), counter);
  const std::size_t after = allocations;
  EXPECT_EQ(after - before, 0u);
  EXPECT_GT(counter.count, 100);
}

TEST(Allocations, noneInTheAdvanceUnderAHarmonicDrive)
{
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{5}), BasisParameters(ConjoinedBasis{3, 2})})
  {
    const auto model = std::make_shared<const SwitchedModel>(limitingCase(1000.0, basis));
    HarmonicSimulation simulation(model);
    simulation.setDrive(1.6 * model->scales().frequency, 10.0);
    Counter counter;
    const std::size_t before = allocations;
    simulation.advance(200, counter);
    const std::size_t after = allocations;
    EXPECT_EQ(after - before, 0u);
    EXPECT_GT(counter.count, 100);
  }
}

TEST(Allocations, noneInTheAdvanceThatWritesAHistory)
{
  constexpr std::size_t samples_per_cycle = 64;
  constexpr std::uint64_t cycles = 200;
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{5}), BasisParameters(ConjoinedBasis{3, 2})})
  {
    const auto model = std::make_shared<const SwitchedModel>(limitingCase(1000.0, basis));
    HarmonicSimulation simulation(model);
    simulation.setDrive(1.6 * model->scales().frequency, 10.0);
    std::vector<HistorySample> history(cycles * samples_per_cycle);
    Counter counter;
    const std::size_t before = allocations;
    simulation.advance(cycles, counter, samples_per_cycle, history.data());
    const std::size_t after = allocations;
    EXPECT_EQ(after - before, 0u);
    EXPECT_GT(counter.count, 100);
    EXPECT_GT(history.back().time, 0.0);
  }
}
