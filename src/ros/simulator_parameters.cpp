#include "vibro_impact/ros/simulator_parameters.h"

#include <cstdint>

#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/ros/parameter_reader.h"

namespace vibro_impact::graph
{
namespace
{
using XmlRpc::XmlRpcValue;

constexpr double highest_acceleration = 1.0e9;
constexpr double longest_time = 60.0;
constexpr double longest_wait = 3600.0;
constexpr double highest_mirror_rate = 1.0e4;
constexpr double highest_motion_rate = 1.0e9;
constexpr double highest_threshold = 1.0e9;
constexpr std::uint32_t longest_queue = 1000000;

std::string quoted(const std::string& text)
{
  static const char digits[] = "0123456789abcdef";
  std::string result = "\"";
  for (const char character : text)
  {
    const auto code = static_cast<unsigned char>(character);
    if (character == '"' || character == '\\')
    {
      result += '\\';
      result += character;
    }
    else if (code < 0x20)
    {
      result += {'\\', 'x', digits[code >> 4], digits[code & 15]};
    }
    else
    {
      result += character;
    }
  }
  return result + '"';
}

void readThresholds(ParameterReader& reader, DiagnosticThresholds& thresholds)
{
  const auto read = [&reader](const char* key, double& value, double most, const char* unit)
  { value = reader.nonNegative(key, value, most, unit); };
  thresholds.max_input_age = reader.positive("max_input_age", thresholds.max_input_age, longest_wait, " (s)");
  read("warn_lost_samples", thresholds.warn_lost_samples, highest_threshold, "");
  read("warn_real_time_factor", thresholds.warn_real_time_factor, highest_threshold, "");
  read("error_real_time_factor", thresholds.error_real_time_factor, highest_threshold, "");
  read("warn_block_load", thresholds.warn_block_load, highest_threshold, "");
  read("warn_queue_share", thresholds.warn_queue_share, 1.0, "");
  read("warn_energy_closure", thresholds.warn_energy_closure, highest_threshold, "");
}

/// With a point or an exponent, so that it does not become an integer on the way.
std::string decimal(double value)
{
  const std::string text = config::formatNumber(value);
  return text.find_first_not_of("+-0123456789") == std::string::npos ? text + ".0" : text;
}

}  // namespace

SimulatorParameters parseSimulatorParameters(const XmlRpcValue& tree, const std::string& name)
{
  SimulatorParameters parameters;
  StreamLimits& limits = parameters.limits;
  ParameterReader reader(tree, "");
  const XmlRpcValue model = reader.take({"beam1", "beam2", "contact", "damping", "basis"});
  const std::string directory = reader.text("configuration_directory", "");
  parameters.input = readInput(reader);
  limits.max_acceleration =
      reader.positive("max_acceleration", limits.max_acceleration, highest_acceleration, " (m/s^2)");
  limits.max_bridged_gap = reader.nonNegative("max_bridged_gap", limits.max_bridged_gap, longest_time, " (s)");
  limits.max_step_back = reader.nonNegative("max_step_back", limits.max_step_back, longest_time, " (s)");
  limits.max_stamp_jitter = reader.positive("max_stamp_jitter", limits.max_stamp_jitter, longest_time, " (s)");
  parameters.mirror_rate = reader.positive("mirror_rate", parameters.mirror_rate, highest_mirror_rate, " (Hz)");
  parameters.motion_rate = reader.nonNegative("motion_rate", parameters.motion_rate, highest_motion_rate, " (Hz)");
  parameters.queue_size = reader.count("queue_size", parameters.queue_size, longest_queue);
  readThresholds(reader, parameters.thresholds);
  parameters.diagnostic_period =
      reader.positive("diagnostic_period", parameters.diagnostic_period, longest_wait, " (s)");
  reader.rejectUnknown();

  std::string message;
  if (!reader.faults().empty())
  {
    message = config::Error(name, reader.faults()).what();
  }
  try
  {
    parameters.system = config::parse(toYaml(model), name, directory);
  }
  catch (const config::Error& error)
  {
    message += (message.empty() ? "" : "\n") + std::string(error.what());
  }
  if (!message.empty())
  {
    throw config::Error(message);
  }
  return parameters;
}

std::string toYaml(const XmlRpcValue& value)
{
  switch (value.getType())
  {
    case XmlRpcValue::TypeBoolean:
      return static_cast<const bool&>(value) ? "true" : "false";
    case XmlRpcValue::TypeInt:
      return std::to_string(static_cast<const int&>(value));
    case XmlRpcValue::TypeDouble:
      return decimal(static_cast<const double&>(value));
    case XmlRpcValue::TypeString:
      return quoted(static_cast<const std::string&>(value));
    case XmlRpcValue::TypeArray:
    {
      std::string text;
      for (int i = 0; i < value.size(); ++i)
      {
        text += (i == 0 ? "" : ", ") + toYaml(value[i]);
      }
      return "[" + text + "]";
    }
    case XmlRpcValue::TypeStruct:
    {
      std::string text;
      for (const auto& entry : value)
      {
        text += (text.empty() ? "" : ", ") + quoted(entry.first) + ": " + toYaml(entry.second);
      }
      return "{" + text + "}";
    }
    case XmlRpcValue::TypeBase64:
      return "\"binary data\"";
    case XmlRpcValue::TypeDateTime:
      return "\"a date\"";
    default:
      return "null";
  }
}

}  // namespace vibro_impact::graph
