// Any sequence of single stamped samples, as accelerometers send them: each is refused with a reason or has its place
// on an even grid.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>

#include <fuzzer/FuzzedDataProvider.h>

#include "require.h"
#include "vibro_impact/ros/sample_grid.h"

namespace graph = vibro_impact::graph;
using vibro_impact::fuzz::require;

namespace
{
constexpr double usual_period = 1.0e-3;              // s
constexpr graph::Stamp usual_nanoseconds = 1000000;  // the same

graph::GridParameters parameters(FuzzedDataProvider& provider)
{
  const auto known = provider.ConsumeIntegral<std::uint8_t>();
  graph::GridParameters parameters;
  if ((known & 1U) != 0)
  {
    parameters.sample_period =
        (known & 2U) != 0 ? usual_period : 1.0e-9 * (1.0 + provider.ConsumeIntegral<std::uint32_t>());
  }
  if ((known & 4U) != 0)
  {
    parameters.offset.reset();
    parameters.offset_duration = 0.02;
  }
  return parameters;
}

double anyDouble(FuzzedDataProvider& provider)
{
  const auto bits = provider.ConsumeIntegral<std::uint64_t>();
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

// What holds of the blocks that one sample brings.
class Stream
{
public:
  explicit Stream(const graph::StreamLimits& limits) : limits_(limits)
  {
  }

  void take(const graph::SampleGrid& grid, const graph::SampleGrid::Answer& answer)
  {
    require(answer.refusal.empty() == (answer.refused == 0), "what is refused has a reason");
    require(answer.blocks.empty() || !grid.measuring(), "nothing is on a grid that is not known");
    for (const graph::Samples& block : answer.blocks)
    {
      require(!block.values.empty() && block.sample_period == *grid.samplePeriod(), "a block is one of the grid");
      const bool anew = block.seq == 0;
      require(!last_ || anew || block.seq >= next_, "no number comes twice");
      require(!last_ || anew || block.stamp > *last_, "time goes on");
      for (const double value : block.values)
      {
        // Less its offset, a value between two that were taken.
        require(std::abs(value) <= 2.0 * limits_.max_acceleration, "no value is beyond what was taken");
      }
      next_ = block.seq + block.values.size();
      last_ = block.stamp;
      placed_ = anew ? block.values.size() : placed_ + block.values.size();
    }
    ++taken_;
    require(placed_ <= 2 * taken_ + 2, "there is no more on the grid than was taken");
  }

private:
  graph::StreamLimits limits_;
  std::optional<graph::Stamp> last_;
  std::uint64_t next_ = 0;
  std::size_t placed_ = 0;
  std::size_t taken_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  FuzzedDataProvider provider(data, size);
  const graph::StreamLimits limits;
  graph::SampleGrid grid(parameters(provider), limits, "linear_acceleration.x");
  Stream stream(limits);
  graph::Stamp time = 1000000000;
  while (provider.remaining_bytes() > 0)
  {
    // Most samples come in time, give or take an eighth of a period.
    const auto what = provider.ConsumeIntegral<std::uint8_t>();
    double value = 0.1 * (what % 16);
    time += usual_nanoseconds + (what % 8) * (usual_nanoseconds / 64);
    switch (what >> 3U)
    {
      case 0:
        value = anyDouble(provider);
        break;
      case 1:
        time += provider.ConsumeIntegral<std::int32_t>();
        break;
      case 2:
        time = static_cast<graph::Stamp>(provider.ConsumeIntegral<std::uint32_t>()) * 1000000000;
        break;
      default:
        break;
    }
    time = std::max<graph::Stamp>(time, 0);
    stream.take(grid, grid.take(time, value));
  }
  return 0;
}
