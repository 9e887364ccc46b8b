#include "vibro_impact/ros/input_parameters.h"

#include <array>
#include <cmath>

#include "vibro_impact/config/number.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
namespace
{
constexpr double longest_offset_duration = 60.0;
constexpr double highest_offset = 1.0e9;

InputKind readKind(ParameterReader& reader)
{
  const std::string name = reader.text("input", nameOf(InputKind::block));
  for (const InputKind kind : {InputKind::block, InputKind::accel, InputKind::imu})
  {
    if (name == nameOf(kind))
    {
      return kind;
    }
  }
  reader.reject("input", "block, accel or imu");
  return InputKind::block;
}

Axis readAxis(ParameterReader& reader)
{
  static const std::array<const char*, 3> names = {"x", "y", "z"};
  const std::string name = reader.text("axis", names[Axis().component]);
  for (std::size_t component = 0; component < names.size(); ++component)
  {
    if (name == names[component])
    {
      return {component, 1.0};
    }
    if (name == std::string("-") + names[component])
    {
      return {component, -1.0};
    }
  }
  reader.reject("axis", "x, -x, y, -y, z or -z");
  return {};
}

// A number, or the word `mean`: nothing, as where it is neither and rejected.
std::optional<double> readOffset(ParameterReader& reader, std::optional<double> missing)
{
  const double offset = reader.number("offset", 0.0);
  if (!reader.has("offset"))
  {
    return missing;
  }
  if (std::abs(offset) <= highest_offset)
  {
    return offset;
  }
  if (!reader.isWord("offset", "mean"))
  {
    reader.reject("offset", "the word mean, or a number of at most " + config::formatNumber(highest_offset) +
                                " in magnitude (m/s^2)");
  }
  return std::nullopt;
}

}  // namespace

const char* nameOf(InputKind kind)
{
  switch (kind)
  {
    case InputKind::accel:
      return "accel";
    case InputKind::imu:
      return "imu";
    default:
      return "block";
  }
}

InputParameters readInput(ParameterReader& reader)
{
  InputParameters parameters;
  const std::size_t faults = reader.faults().size();
  parameters.kind = readKind(reader);
  const bool kind_is_known = reader.faults().size() == faults;
  const bool single_samples = parameters.kind != InputKind::block;

  parameters.axis = readAxis(reader);
  parameters.frame_id = reader.text("frame_id", "");
  const double period = reader.number("sample_period", 0.0);
  if (reader.has("sample_period"))
  {
    if (!(period >= StreamRules::min_sample_period && period <= StreamRules::max_sample_period))
    {
      reader.reject("sample_period", "a number from " + config::formatNumber(StreamRules::min_sample_period) + " to " +
                                         config::formatNumber(StreamRules::max_sample_period) + " (s)");
    }
    parameters.grid.sample_period = period;
  }
  // A specific force holds gravity, of which only a mean can tell how much it is along the axis.
  parameters.grid.offset = readOffset(
      reader, parameters.kind == InputKind::imu ? std::nullopt : std::optional<double>(GridParameters().offset));
  parameters.grid.offset_duration =
      reader.positive("offset_duration", parameters.grid.offset_duration, longest_offset_duration, " (s)");

  const auto reject = [&reader](const char* key, const std::string& where)
  {
    if (reader.has(key))
    {
      reader.reject(key, "left out where " + where);
    }
  };
  if (kind_is_known && !single_samples)
  {
    for (const char* key : {"axis", "frame_id", "sample_period", "offset", "offset_duration"})
    {
      reject(key, "input is block");
    }
  }
  if (single_samples)
  {
    reject("max_stamp_jitter", std::string("input is ") + nameOf(parameters.kind));
    if (parameters.grid.offset)
    {
      reject("offset_duration", "offset is a number");
    }
  }
  return parameters;
}

}  // namespace vibro_impact::graph
