#include "vibro_impact/ros/signal_parameters.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "text.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/sampled_excitation.h"
#include "vibro_impact/ros/input_parameters.h"
#include "vibro_impact/ros/parameter_reader.h"
#include "vibro_impact/ros/recorded_acceleration.h"

namespace vibro_impact::graph
{
namespace
{
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double longest_gap = 60.0;

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

core::SineBand readBand(ParameterReader& reader)
{
  core::SineBand band;
  band.from = reader.number("from", nan);
  band.to = reader.number("to", nan);
  static const std::pair<const char*, core::MotionQuantity> quantities[] = {
      {"displacement", core::MotionQuantity::displacement},
      {"velocity", core::MotionQuantity::velocity},
      {"acceleration", core::MotionQuantity::acceleration},
  };
  int given = 0;
  for (const auto& [key, quantity] : quantities)
  {
    const double value = reader.number(key, nan);
    if (reader.has(key))
    {
      band.amplitude = {quantity, value};
      ++given;
    }
  }
  if (given != 1)
  {
    reader.reject("amplitude", given == 0 ? "missing" : "given twice",
                  "one of displacement (m), velocity (m/s) and acceleration (m/s^2)");
  }
  return band;
}

// The list `key`, of whose maps `read` makes the entries of `list`.
template <typename Entry>
void readList(ParameterReader& reader, const std::string& key, const std::function<Entry(ParameterReader&)>& read,
              std::vector<Entry>& list, std::vector<ParameterReader>& parts)
{
  parts = reader.maps(key);
  for (ParameterReader& part : parts)
  {
    list.push_back(read(part));
    part.rejectUnknown();
  }
}

core::DriveParameters readDwells(ParameterReader& reader, std::vector<ParameterReader>& parts)
{
  core::SineDwellParameters parameters;
  readList<core::SineBand>(reader, "bands", readBand, parameters.bands, parts);
  parameters.frequency_step = reader.number("frequency_step", parameters.frequency_step);
  parameters.dwell = reader.number("dwell", nan);
  parameters.ramp_cycles = reader.number("ramp_cycles", parameters.ramp_cycles);
  return parameters;
}

core::DriveParameters readBandedSweep(ParameterReader& reader, std::vector<ParameterReader>& parts)
{
  core::BandedSweepParameters parameters;
  readList<core::SineBand>(reader, "bands", readBand, parameters.bands, parts);
  parameters.rate = reader.number("rate", nan);
  const std::string direction = reader.text("direction", "up");
  parameters.upwards = direction != "down";
  if (direction != "up" && direction != "down")
  {
    reader.reject("direction", "up or down");
  }
  parameters.sweeps = reader.integer("sweeps", parameters.sweeps);
  parameters.soft_start_cycles = reader.number("soft_start_cycles", parameters.soft_start_cycles);
  return parameters;
}

core::SpectrumPoint readPoint(ParameterReader& reader)
{
  return {reader.number("frequency", nan), reader.number("density", nan)};
}

core::DriveParameters readRandom(ParameterReader& reader, std::vector<ParameterReader>& parts)
{
  core::RandomParameters parameters;
  readList<core::SpectrumPoint>(reader, "spectrum", readPoint, parameters.spectrum, parts);
  parameters.duration = reader.number("duration", nan);
  parameters.seed = reader.integer("seed", parameters.seed);
  parameters.soft_start = reader.number("soft_start", parameters.soft_start);
  return parameters;
}

core::DriveParameters readShock(ParameterReader& reader)
{
  core::ShockParameters parameters;
  const std::string shape = reader.text("shape", "");
  if (shape == "terminal_peak_sawtooth")
  {
    parameters.shape = core::ShockShape::terminal_peak_sawtooth;
  }
  else if (shape != "half_sine")
  {
    reader.reject("shape", "half_sine or terminal_peak_sawtooth");
  }
  parameters.peak = reader.number("peak", nan);
  parameters.duration = reader.number("duration", nan);
  parameters.before = reader.number("before", parameters.before);
  parameters.after = reader.number("after", parameters.after);
  parameters.repetitions = reader.integer("repetitions", parameters.repetitions);
  parameters.interval = reader.number("interval", parameters.interval);
  return parameters;
}

// The file `path`, which the key `key` gives.
std::string located(ParameterReader& reader, const std::string& key, const std::string& path,
                    const std::string& directory)
{
  if (directory.empty() && std::filesystem::path(path).is_relative())
  {
    reader.reject(key, "an absolute path, since signal_directory is not given");
  }
  return (std::filesystem::path(directory) / path).string();
}

void use(std::vector<double> acceleration, double sample_period, SignalParameters& signal)
{
  core::SampledParameters parameters;
  parameters.acceleration = std::make_shared<const std::vector<double>>(std::move(acceleration));
  parameters.sample_period = sample_period;
  signal.sample_rate = 1.0 / sample_period;
  signal.drive = parameters;
}

// What readers of files have to say becomes a fault like others.
template <typename Read>
void readFiles(ParameterReader& reader, SignalParameters& signal, const Read& read)
{
  reader.rejectUnknown();
  if (!reader.faults().empty())
  {
    return;
  }
  try
  {
    read();
  }
  catch (const config::Error& error)
  {
    signal.faults.emplace_back(error.what());
  }
}

void readTable(ParameterReader& reader, const std::string& directory, SignalParameters& signal)
{
  const std::string file = reader.text("file", "");
  if (file.empty())
  {
    reader.reject("file", "a table with the columns time (s) and acceleration (m/s^2)");
  }
  const std::string path = located(reader, "file", file, directory);
  readFiles(reader, signal,
            [&]
            {
              config::SampledExcitation excitation = config::readExcitation(path);
              use(std::move(excitation.acceleration), excitation.sample_period, signal);
            });
}

void readBag(ParameterReader& reader, const std::string& directory, SignalParameters& signal)
{
  std::vector<std::string> paths;
  for (const std::string& file : reader.texts("files", {}))
  {
    paths.push_back(located(reader, "files", file, directory));
  }
  if (paths.empty())
  {
    reader.reject("files", "a list of the bags of one recording");
  }
  const std::string topic = reader.text("topic", "");
  if (topic.empty())
  {
    reader.reject("topic", "the name of a topic in the recording");
  }
  const InputParameters input = readInput(reader);
  StreamLimits limits;
  limits.max_bridged_gap = reader.nonNegative("max_bridged_gap", limits.max_bridged_gap, longest_gap, " (s)");
  readFiles(reader, signal,
            [&]
            {
              RecordedAcceleration recording = readRecordedAcceleration(paths, topic, input, limits);
              if (!recording.first_irregularity.empty())
              {
                signal.remark = text("topic ", topic, ": ", recording.bridged, " samples bridged, ", recording.refused,
                                     " refused, the first because ", recording.first_irregularity);
              }
              use(std::move(recording.acceleration), recording.sample_period, signal);
            });
}

// Where the core's names of members are keys of the map, or of the maps in its list `parts`.
void reject(const core::ParameterFault& fault, ParameterReader& reader, std::vector<ParameterReader>& parts)
{
  const std::size_t bracket = fault.key.find('[');
  const std::size_t point = fault.key.find('.');
  if (bracket != std::string::npos && point != std::string::npos)
  {
    parts.at(std::stoul(fault.key.substr(bracket + 1))).reject(fault.key.substr(point + 1), fault.allowed);
  }
  else if (fault.key == "duration" && !reader.has(fault.key))
  {
    reader.reject(fault.key, fault.value, fault.allowed);
  }
  else
  {
    reader.reject(fault.key, fault.allowed);
  }
}

}  // namespace

SignalParameters readSignal(const XmlRpc::XmlRpcValue& map, double sample_rate, const std::string& directory)
{
  using Reading = std::function<core::DriveParameters(ParameterReader&, std::vector<ParameterReader>&)>;
  static const std::map<std::string, Reading> families = {
      {"sine", [](ParameterReader& reader, auto&) { return readSine(reader); }},
      {"stepped_sine", [](ParameterReader& reader, auto&) { return readSteppedSine(reader); }},
      {"sine_dwells", readDwells},
      {"linear_sweep", [](ParameterReader& reader, auto&) { return readSweep(reader, core::SweepLaw::linear); }},
      {"logarithmic_sweep",
       [](ParameterReader& reader, auto&) { return readSweep(reader, core::SweepLaw::logarithmic); }},
      {"banded_sweep", readBandedSweep},
      {"random", readRandom},
      {"shock", [](ParameterReader& reader, auto&) { return readShock(reader); }},
  };
  SignalParameters signal;
  signal.sample_rate = sample_rate;
  ParameterReader reader(map, "signal");
  std::vector<ParameterReader> parts;
  const std::string type = reader.text("type", "");
  const auto family = families.find(type);
  if (family != families.end())
  {
    signal.drive = family->second(reader, parts);
    for (const core::ParameterFault& fault : core::findFaults(signal.drive, sample_rate))
    {
      // The sample rate is no key of the signal, and a list that is none has been rejected already.
      const bool known =
          fault.key == "sample_rate" || (parts.empty() && (fault.key == "bands" || fault.key == "spectrum"));
      if (!known)
      {
        reject(fault, reader, parts);
      }
    }
    reader.rejectUnknown();
  }
  else if (type == "table" || type == "bag")
  {
    signal.recorded = true;
    (type == "table" ? readTable : readBag)(reader, directory, signal);
  }
  else if (reader.faults().empty())
  {
    reader.reject(
        "type",
        "sine, stepped_sine, sine_dwells, linear_sweep, logarithmic_sweep, banded_sweep, random, shock, table "
        "or bag");
  }
  for (const ParameterReader& part : parts)
  {
    reader.addFaults(part);
  }
  signal.faults.insert(signal.faults.end(), reader.faults().begin(), reader.faults().end());
  return signal;
}

}  // namespace vibro_impact::graph
