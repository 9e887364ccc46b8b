#include "vibro_impact/ros/shaker_parameters.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/ros/parameter_reader.h"
#include "vibro_impact/ros/signal_parameters.h"

namespace vibro_impact::graph
{
namespace
{
constexpr double highest_rate = 1.0e9;
constexpr double highest_speed = 1.0e6;
constexpr double longest_wait = 86400.0;
constexpr std::uint32_t most_blocks = 1000000;
constexpr std::uint32_t most_subscribers = 1000;
// A block of more is none that anybody could want.
constexpr double most_samples_per_block = 1.0e6;

}  // namespace

std::uint64_t ShakerParameters::samplesPerBlock() const
{
  return static_cast<std::uint64_t>(std::max(1LL, std::llround(sample_rate / block_rate)));
}

ShakerParameters parseShakerParameters(const XmlRpc::XmlRpcValue& tree, const std::string& name)
{
  ShakerParameters parameters;
  ParameterReader reader(tree, "");
  std::vector<std::string> signal_faults;
  parameters.sample_rate = reader.positive("sample_rate", parameters.sample_rate, highest_rate, " (Hz)");
  const std::string directory = reader.text("signal_directory", "");
  bool recorded = false;
  if (const auto map = reader.map("signal"))
  {
    SignalParameters signal = readSignal(*map, parameters.sample_rate, directory);
    recorded = signal.recorded;
    if (recorded && reader.has("sample_rate"))
    {
      reader.reject("sample_rate", "left out where the signal is a recorded one, which has its own");
    }
    parameters.signal = std::move(signal.drive);
    parameters.sample_rate = signal.sample_rate;
    parameters.remark = std::move(signal.remark);
    signal_faults = std::move(signal.faults);
  }
  const bool has_rate = std::isfinite(parameters.sample_rate) && parameters.sample_rate > 0.0;
  const double rate = has_rate ? parameters.sample_rate : highest_rate;
  const double least = rate / most_samples_per_block;
  // Whoever plays a slow recording need not know how slow: its blocks have one sample then.
  const double most = recorded ? highest_rate : rate;
  parameters.block_rate = reader.number("block_rate", std::clamp(parameters.block_rate, least, rate));
  if (!(parameters.block_rate >= least && parameters.block_rate <= most))
  {
    reader.reject("block_rate", "a number from " + config::formatNumber(least) + " to " + config::formatNumber(most) +
                                    (recorded ? " (Hz)" : ", the sample rate (Hz)"));
  }
  parameters.speed = reader.nonNegative("speed", parameters.speed, highest_speed, "");
  parameters.max_blocks_ahead = reader.count("max_blocks_ahead", parameters.max_blocks_ahead, most_blocks);
  if (parameters.speed == 0.0 && parameters.max_blocks_ahead == 0)
  {
    reader.reject("max_blocks_ahead", "at least 1 where speed is 0");
  }
  parameters.wait_for_subscribers =
      reader.count("wait_for_subscribers", parameters.wait_for_subscribers, most_subscribers);
  parameters.recorder = reader.text("recorder", "");
  parameters.recorded_topics =
      reader.texts("recorded_topics", {"base_excitation", "gap", "contact_force", "impact", "model_info"});
  parameters.timeout = reader.nonNegative("timeout", parameters.timeout, longest_wait, " (s)");
  parameters.linger = reader.nonNegative("linger", parameters.linger, longest_wait, " (s)");
  parameters.progress_period = reader.nonNegative("progress_period", parameters.progress_period, longest_wait, " (s)");
  parameters.queue_size = reader.count("queue_size", parameters.queue_size, most_blocks);
  reader.rejectUnknown();

  std::vector<std::string> faults = reader.faults();
  faults.insert(faults.end(), signal_faults.begin(), signal_faults.end());
  if (!faults.empty())
  {
    throw config::Error(name, faults);
  }
  return parameters;
}

}  // namespace vibro_impact::graph
