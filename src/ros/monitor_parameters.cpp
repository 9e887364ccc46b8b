#include "vibro_impact/ros/monitor_parameters.h"

#include <vibro_impact/Alarm.h>

#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/config/spelling.h"
#include "vibro_impact/ros/parameter_reader.h"

namespace vibro_impact::graph
{
namespace
{
constexpr double longest_window = 600.0;
constexpr double shortest_window = 1.0e-3;
/// Every impact is added once for each report whose window it lies in.
constexpr double most_reports_in_window = 100.0;
constexpr double longest_wait = 3600.0;
constexpr double longest_delay = 1.0e6;
constexpr double highest_frequency = 1.0e6;
constexpr double greatest = 1.0e9;
constexpr std::uint32_t longest_queue = 1000000;
constexpr std::uint32_t most_classes = 1000;

using Faults = std::vector<std::string>;

void takeFaults(ParameterReader& reader, Faults& faults)
{
  reader.rejectUnknown();
  faults.insert(faults.end(), reader.faults().begin(), reader.faults().end());
}

std::optional<XmlRpc::XmlRpcValue> optionalMap(ParameterReader& reader, const std::string& key)
{
  if (reader.has(key))
  {
    return reader.map(key);
  }
  reader.take({key});  // is known, even so
  return std::nullopt;
}

void readWindow(ParameterReader& reader, core::MonitorOptions& options)
{
  // All three before any is judged: a key that nobody has asked for counts as unknown.
  const double window = reader.number("window", core::seconds(options.window));
  const double period = reader.number("report_period", core::seconds(options.report_period));
  const double settling_time =
      reader.nonNegative("settling_time", core::seconds(options.settling_time), longest_wait, " (s)");
  if (!(window >= shortest_window && window <= longest_window))
  {
    reader.reject("window", "a number >= " + config::formatNumber(shortest_window) +
                                " and <= " + config::formatNumber(longest_window) + " (s)");
    return;
  }
  const double shortest = window / most_reports_in_window;
  if (!(period >= shortest && period <= longest_wait))
  {
    reader.reject("report_period", config::formatNumber(period),
                  "a number >= " + config::formatNumber(shortest) +
                      ", a hundredth of window, and <= " + config::formatNumber(longest_wait) + " (s)");
    return;
  }
  options.window = core::nanoseconds(window);
  options.report_period = core::nanoseconds(period);
  options.settling_time = core::nanoseconds(settling_time);
}

core::ImpulseHistogram readHistogram(const XmlRpc::XmlRpcValue& map, Faults& faults)
{
  ParameterReader reader(map, "histogram");
  const double from = reader.positive("from", 1.0e-9, greatest, " (N s)");
  const double to = reader.positive("to", 100.0, greatest, " (N s)");
  const std::uint32_t classes = reader.count("classes", 44, most_classes);
  if (classes == 0)
  {
    reader.reject("classes", "a whole number from 1 to " + std::to_string(most_classes));
  }
  if (from >= to)
  {
    reader.reject("to", config::formatNumber(to), "greater than histogram.from");
  }
  const bool good = reader.faults().empty();
  takeFaults(reader, faults);
  return good ? core::ImpulseHistogram(from, to, classes) : core::ImpulseHistogram(1.0, 2.0, 1);
}

core::ArchardWear readWear(const XmlRpc::XmlRpcValue& map, std::string& source, Faults& faults)
{
  ParameterReader reader(map, "wear");
  core::ArchardWear wear;
  wear.coefficient = reader.nonNegative("coefficient", -1.0, greatest, " (m^2/N)");
  source = reader.text("source", "");
  if (source.empty())
  {
    reader.reject("source", "where the coefficient comes from, in words");
  }
  wear.area = reader.positive("area", -1.0, greatest, " (m^2)");
  wear.sliding_speed = reader.nonNegative("sliding_speed", 0.0, greatest, " (m/s)");
  wear.sliding_distance = reader.nonNegative("sliding_distance", 0.0, greatest, " (m)");
  if (reader.has("sliding_speed") == reader.has("sliding_distance"))
  {
    reader.reject("sliding", reader.has("sliding_speed") ? "two of them" : "none",
                  "either sliding_speed (m/s) or sliding_distance (m in each impact)");
  }
  takeFaults(reader, faults);
  return wear;
}

const core::Quantity* readQuantity(ParameterReader& reader)
{
  const std::string name = reader.text("quantity", "");
  const core::Quantity* quantity = core::findQuantity(name);
  if (quantity == nullptr)
  {
    std::string names;
    std::vector<std::string> known;
    for (const core::Quantity& one : core::quantities())
    {
      names += (names.empty() ? "" : ", ") + std::string(one.name);
      known.emplace_back(one.name);
    }
    const auto meant = config::nearest(name, known);
    reader.reject("quantity", "one of " + names + (meant ? "; did you mean " + *meant + "?" : ""));
  }
  return quantity;
}

AlarmParameters readAlarm(const std::string& name, const XmlRpc::XmlRpcValue& map, Faults& faults)
{
  const std::string path = "alarms." + name;
  ParameterReader reader(map, path);
  AlarmParameters alarm;
  alarm.name = name;
  alarm.quantity = readQuantity(reader);
  const auto limit = [&reader](const char* key)
  {
    const double value = reader.number(key, 2.0 * greatest);
    if (!(value >= -greatest && value <= greatest))
    {
      reader.reject(key, "a number in the unit of the quantity");
    }
    return value;
  };
  alarm.limits.raise_at = limit("raise_at");
  alarm.limits.clear_at = limit("clear_at");
  if (alarm.limits.raise_at == alarm.limits.clear_at && reader.faults().empty())
  {
    reader.reject("clear_at", config::formatNumber(alarm.limits.clear_at),
                  "unlike raise_at: less for an alarm above, greater for one below");
  }
  alarm.limits.on_delay = core::nanoseconds(reader.nonNegative("on_delay", 0.0, longest_delay, " (s)"));
  alarm.limits.off_delay = core::nanoseconds(reader.nonNegative("off_delay", 0.0, longest_delay, " (s)"));
  const std::string severity = reader.text("severity", "warn");
  if (severity != "warn" && severity != "error")
  {
    reader.reject("severity", "warn or error");
  }
  alarm.severity = severity == "error" ? std::uint8_t{Alarm::ERROR} : std::uint8_t{Alarm::WARN};
  takeFaults(reader, faults);
  return alarm;
}

std::vector<AlarmParameters> readAlarms(const XmlRpc::XmlRpcValue& map, Faults& faults)
{
  std::vector<AlarmParameters> alarms;
  ParameterReader reader(map, "alarms");
  for (const auto& entry : map)
  {
    if (const auto alarm = reader.map(entry.first))
    {
      alarms.push_back(readAlarm(entry.first, *alarm, faults));
    }
  }
  takeFaults(reader, faults);
  return alarms;
}

WearFeedbackParameters readWearFeedback(const XmlRpc::XmlRpcValue& map, Faults& faults)
{
  ParameterReader reader(map, "wear_feedback");
  WearFeedbackParameters feedback;
  feedback.simulator = reader.text("simulator", "simulator");
  feedback.limits.interval =
      core::nanoseconds(reader.positive("interval", core::seconds(feedback.limits.interval), longest_delay, " (s)"));
  feedback.limits.greatest_step = reader.positive("greatest_step", feedback.limits.greatest_step, greatest, " (m)");
  takeFaults(reader, faults);
  return feedback;
}
}  // namespace

MonitorParameters parseMonitorParameters(const XmlRpc::XmlRpcValue& tree, const std::string& name)
{
  MonitorParameters parameters;
  Faults faults;
  ParameterReader reader(tree, "");
  parameters.silence = reader.positive("silence", parameters.silence, longest_wait, " (s)");
  parameters.diagnostic_period =
      reader.positive("diagnostic_period", parameters.diagnostic_period, longest_wait, " (s)");
  parameters.queue_size = reader.count("queue_size", parameters.queue_size, longest_queue);
  readWindow(reader, parameters.options);
  parameters.options.drive_frequency = reader.nonNegative("drive_frequency", 0.0, highest_frequency, " (Hz)");
  parameters.options.period_tolerance =
      reader.positive("period_tolerance", parameters.options.period_tolerance, 0.5, "");
  if (const auto map = optionalMap(reader, "histogram"))
  {
    parameters.options.histogram = readHistogram(*map, faults);
  }
  if (const auto map = optionalMap(reader, "wear"))
  {
    parameters.options.wear = readWear(*map, parameters.wear_source, faults);
  }
  if (const auto map = optionalMap(reader, "alarms"))
  {
    parameters.alarms = readAlarms(*map, faults);
  }
  if (const auto map = optionalMap(reader, "wear_feedback"))
  {
    parameters.wear_feedback = readWearFeedback(*map, faults);
    if (!reader.has("wear"))
    {
      reader.reject("wear", "a map where there is wear_feedback");
    }
  }
  takeFaults(reader, faults);
  if (!faults.empty())
  {
    throw config::Error(name, faults);
  }
  return parameters;
}

MonitorParameters readMonitorParameters(const ros::NodeHandle& private_node)
{
  XmlRpc::XmlRpcValue tree;
  private_node.getParam(private_node.getNamespace(), tree);
  return parseMonitorParameters(tree, private_node.getNamespace());
}

}  // namespace vibro_impact::graph
