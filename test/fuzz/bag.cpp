// Any bytes as a bag: it is refused with a message of one line, or simulated and extracted from.

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include <console_bridge/console.h>

#include "require.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/recording_simulation.h"
#include "vibro_impact/ros/response_extraction.h"

namespace config = vibro_impact::config;
namespace graph = vibro_impact::graph;
using vibro_impact::fuzz::require;

namespace
{
// A file without a name that is as long as the process.
std::string fileOf(const std::uint8_t* data, std::size_t size)
{
  static const int file = memfd_create("bag", 0);
  require(file >= 0 && ftruncate(file, 0) == 0 && pwrite(file, data, size, 0) == static_cast<ssize_t>(size),
          "the file can be written");
  return "/proc/self/fd/" + std::to_string(file);
}

template <typename Action>
void attempt(const Action& action)
{
  try
  {
    action();
  }
  catch (const config::Error& error)
  {
    require(error.what()[0] != '\0', "a refusal has a message");
  }
}

// A recording of any period and frequency would take any time to simulate.
class Limited : public graph::RecordingSink
{
public:
  void onExcitation(const vibro_impact::BaseExcitation& block) override
  {
    check(block.acceleration.size());
  }
  void onGap(const graph::BlockHead& block, const std::vector<double>& gap) override
  {
    require(block.samples == gap.size(), "a block has as many samples as it says");
    check(gap.size());
  }
  void onContactForce(const graph::BlockHead& block, const std::vector<double>& force) override
  {
    require(block.samples == force.size(), "a block has as many samples as it says");
    check(force.size());
  }
  void onImpact(const vibro_impact::Impact& /*impact*/) override
  {
  }
  void onStreamStart(const vibro_impact::StreamStart& /*start*/) override
  {
  }
  void onModelInfo(const vibro_impact::ModelInfo& /*info*/) override
  {
  }

private:
  static void check(std::size_t samples)
  {
    require(samples < (std::size_t{1} << 20), "no block is longer than its bag");
  }
};
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  console_bridge::noOutputHandler();
  const std::string path = fileOf(data, size);
  attempt(
      [&path]
      {
        const graph::RecordedRun recording({path}, "", graph::RecordedContents::excitation);
        Limited sink;
        recording.read(sink);
        graph::recordedModel(recording);
      });
  attempt(
      [&path]
      {
        const graph::RecordedRun recording({path});
        graph::extractResponses(recording, {true, {}, {}});
      });
  return 0;
}
