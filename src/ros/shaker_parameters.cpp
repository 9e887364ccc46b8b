#include "vibro_impact/ros/shaker_parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/ros/parameter_reader.h"

namespace vibro_impact::graph
{
namespace
{
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

constexpr double highest_rate = 1.0e9;
constexpr double highest_speed = 1.0e6;
constexpr double longest_wait = 86400.0;
constexpr std::uint32_t most_blocks = 1000000;
constexpr std::uint32_t most_subscribers = 1000;
// A block of more is none that anybody could want.
constexpr double most_samples_per_block = 1.0e6;

bool isPositive(double value)
{
  return std::isfinite(value) && value > 0.0;
}

// One of two keys, of which there must be one; the message names both.
std::optional<double> readEither(ParameterReader& reader, const std::string& key, const std::string& other,
                                 const std::string& unit, const std::string& other_unit)
{
  const double value = reader.number(key, nan);
  const double other_value = reader.number(other, nan);
  if (reader.has(key) == reader.has(other))
  {
    reader.reject(key, reader.has(key) ? "left out where there is " + other
                                       : "a number > 0" + unit + ", or " + other + " one" + other_unit);
    return std::nullopt;
  }
  const bool first = reader.has(key);
  if (!isPositive(first ? value : other_value))
  {
    reader.reject(first ? key : other, "a finite number > 0" + (first ? unit : other_unit));
    return std::nullopt;
  }
  return first ? value : other_value;
}

template <typename Parameters>
void readCommon(ParameterReader& reader, Parameters& parameters)
{
  parameters.acceleration = reader.number("acceleration", nan);
  parameters.reference_frequency = reader.number("reference_frequency", parameters.reference_frequency);
  parameters.soft_start_cycles = reader.number("soft_start_cycles", parameters.soft_start_cycles);
}

core::DriveParameters readSine(ParameterReader& reader)
{
  core::SineParameters parameters;
  readCommon(reader, parameters);
  parameters.frequency = reader.number("frequency", nan);
  const double frequency = parameters.reference_frequency * parameters.frequency;
  const std::optional<double> length = readEither(reader, "cycles", "duration", "", " (s)");
  // What has been rejected becomes something that does not bring a second message.
  parameters.cycles = length ? (reader.has("cycles") ? *length : *length * frequency) : 1.0;
  if (!length || !isPositive(parameters.cycles))
  {
    parameters.cycles = std::max(1.0, std::isfinite(parameters.soft_start_cycles) ? parameters.soft_start_cycles : 1.0);
  }
  return parameters;
}

core::DriveParameters readSteppedSine(ParameterReader& reader)
{
  core::SteppedSineParameters parameters;
  readCommon(reader, parameters);
  parameters.start_frequency = reader.number("start_frequency", nan);
  parameters.stop_frequency = reader.number("stop_frequency", nan);
  parameters.frequency_step = reader.number("frequency_step", nan);
  parameters.cycles_per_step = reader.integer("cycles_per_step", -1);
  parameters.rest = reader.number("rest", parameters.rest);
  return parameters;
}

core::DriveParameters readSweep(ParameterReader& reader, core::SweepLaw law)
{
  core::SweptSineParameters parameters;
  parameters.law = law;
  readCommon(reader, parameters);
  parameters.start_frequency = reader.number("start_frequency", nan);
  parameters.stop_frequency = reader.number("stop_frequency", nan);
  const bool linear = law == core::SweepLaw::linear;
  const std::optional<double> length = readEither(
      reader, "rate", "duration", linear ? " (reference_frequency per second)" : " (octaves per minute)", " (s)");
  if (length && reader.has("rate"))
  {
    const double range = linear ? parameters.stop_frequency - parameters.start_frequency
                                : 60.0 * std::log2(parameters.stop_frequency / parameters.start_frequency);
    parameters.duration = std::abs(range) / *length;
  }
  else
  {
    parameters.duration = length.value_or(1.0);
  }
  if (!isPositive(parameters.duration))
  {
    parameters.duration = 1.0;  // of frequencies that are rejected
  }
  return parameters;
}

// The signal's parameters, with what is wrong with them in `faults`.
core::DriveParameters readSignal(const XmlRpc::XmlRpcValue& map, double sample_rate, std::vector<std::string>& faults)
{
  ParameterReader reader(map, "signal");
  const std::string type = reader.text("type", "");
  core::DriveParameters parameters;
  if (type == "sine")
  {
    parameters = readSine(reader);
  }
  else if (type == "stepped_sine")
  {
    parameters = readSteppedSine(reader);
  }
  else if (type == "linear_sweep" || type == "logarithmic_sweep")
  {
    parameters = readSweep(reader, type == "linear_sweep" ? core::SweepLaw::linear : core::SweepLaw::logarithmic);
  }
  else
  {
    if (reader.faults().empty())
    {
      reader.reject("type", "sine, stepped_sine, linear_sweep or logarithmic_sweep");
    }
    faults.insert(faults.end(), reader.faults().begin(), reader.faults().end());
    return parameters;
  }
  for (const core::ParameterFault& fault : core::findFaults(parameters, sample_rate))
  {
    if (fault.key == "sample_rate")
    {
      continue;  // not a key of the signal
    }
    if (fault.key == "duration" && !reader.has(fault.key))
    {
      reader.reject(fault.key, fault.value, fault.allowed);
    }
    else
    {
      reader.reject(fault.key, fault.allowed);
    }
  }
  reader.rejectUnknown();
  faults.insert(faults.end(), reader.faults().begin(), reader.faults().end());
  return parameters;
}

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
  if (const auto signal = reader.map("signal"))
  {
    parameters.signal = readSignal(*signal, parameters.sample_rate, signal_faults);
  }
  parameters.block_rate = reader.number("block_rate", parameters.block_rate);
  const double most = isPositive(parameters.sample_rate) ? parameters.sample_rate : highest_rate;
  const double least = most / most_samples_per_block;
  if (!(parameters.block_rate >= least && parameters.block_rate <= most))
  {
    reader.reject("block_rate", "a number from " + config::formatNumber(least) + " to " + config::formatNumber(most) +
                                    ", the sample rate (Hz)");
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
