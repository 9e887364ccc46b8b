#include "vibro_impact/ros/simulator_parameters.h"

#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"

namespace vibro_impact::graph
{
namespace
{
using XmlRpc::XmlRpcValue;

/// Interval that a number must lie in; open at its lower end if `above`.
struct Range
{
  bool above;
  double least;
  double greatest;

  bool holds(double value) const
  {
    return (above ? value > least : value >= least) && value <= greatest;
  }
  std::string text() const
  {
    return (above ? "(" : "[") + config::formatNumber(least) + ", " + config::formatNumber(greatest) + "]";
  }
};

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

/// With a point or an exponent, so that it does not become an integer on the way.
std::string decimal(double value)
{
  const std::string text = config::formatNumber(value);
  return text.find_first_not_of("+-0123456789") == std::string::npos ? text + ".0" : text;
}

std::optional<double> number(const XmlRpcValue& value)
{
  switch (value.getType())
  {
    case XmlRpcValue::TypeInt:
      return static_cast<const int&>(value);
    case XmlRpcValue::TypeDouble:
      return static_cast<const double&>(value);
    case XmlRpcValue::TypeString:
      return config::parseNumber(static_cast<const std::string&>(value));
    default:
      return std::nullopt;
  }
}

/// Takes the parameters out of a tree one by one; what remains is unknown.
class Reader
{
public:
  explicit Reader(const XmlRpcValue& tree)
  {
    if (tree.getType() == XmlRpcValue::TypeStruct)
    {
      tree_ = tree;
    }
    for (const auto& entry : tree_)
    {
      unknown_.insert(entry.first);
    }
  }

  void read(const char* key, const Range& range, const char* unit, double& value)
  {
    known_.push_back(key);
    if (unknown_.erase(key) == 0)
    {
      return;
    }
    const XmlRpcValue& found = tree_[key];
    const std::optional<double> given = number(found);
    if (!given || !range.holds(*given))
    {
      reject(key, found, "a number in " + range.text() + unit);
      return;
    }
    value = *given;
  }

  void read(const char* key, const Range& range, std::uint32_t& value)
  {
    known_.push_back(key);
    if (unknown_.erase(key) == 0)
    {
      return;
    }
    const XmlRpcValue& found = tree_[key];
    const std::optional<double> given = number(found);
    if (!given || found.getType() == XmlRpcValue::TypeDouble || !range.holds(*given) ||
        *given != static_cast<double>(static_cast<std::uint32_t>(*given)))
    {
      reject(key, found, "a whole number in " + range.text());
      return;
    }
    value = static_cast<std::uint32_t>(*given);
  }

  /// Those of the model, for which the configuration's own loader answers.
  XmlRpcValue take(const std::vector<const char*>& keys)
  {
    XmlRpcValue result;
    result.begin();  // makes it a map, even if it stays empty
    for (const char* key : keys)
    {
      known_.push_back(key);
      if (unknown_.erase(key) != 0)
      {
        result[key] = tree_[key];
      }
    }
    return result;
  }

  std::vector<std::string> faults() const
  {
    std::vector<std::string> faults = faults_;
    for (const std::string& key : unknown_)
    {
      std::string names;
      for (const char* name : known_)
      {
        names += (names.empty() ? "" : ", ") + std::string(name);
      }
      faults.push_back(quoted(key) + " is unknown: must be one of " + names);
    }
    return faults;
  }

private:
  void reject(const char* key, const XmlRpcValue& value, const std::string& allowed)
  {
    faults_.push_back(std::string(key) + " = " + toYaml(value) + ": must be " + allowed);
  }

  XmlRpcValue tree_;
  std::set<std::string> unknown_;
  std::vector<const char*> known_;
  std::vector<std::string> faults_;
};
}  // namespace

SimulatorParameters parseSimulatorParameters(const XmlRpcValue& tree, const std::string& name)
{
  SimulatorParameters parameters;
  Reader reader(tree);
  reader.read("max_acceleration", {true, 0.0, 1.0e9}, " m/s^2", parameters.limits.max_acceleration);
  reader.read("max_bridged_gap", {false, 0.0, 60.0}, " s", parameters.limits.max_bridged_gap);
  reader.read("max_step_back", {false, 0.0, 60.0}, " s", parameters.limits.max_step_back);
  reader.read("max_stamp_jitter", {true, 0.0, 60.0}, " s", parameters.limits.max_stamp_jitter);
  reader.read("mirror_rate", {true, 0.0, 1.0e4}, " Hz", parameters.mirror_rate);
  reader.read("queue_size", {false, 0.0, 1.0e6}, parameters.queue_size);
  reader.read("max_input_age", {true, 0.0, 3600.0}, " s", parameters.max_input_age);
  reader.read("diagnostic_period", {true, 0.0, 3600.0}, " s", parameters.diagnostic_period);
  const XmlRpcValue model = reader.take({"beam1", "beam2", "contact", "damping", "basis"});

  std::string message;
  for (const std::string& fault : reader.faults())
  {
    message += (message.empty() ? "" : "\n") + name + ": " + fault;
  }
  try
  {
    parameters.system = config::parse(toYaml(model), name);
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
