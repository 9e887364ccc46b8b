#include "vibro_impact/ros/parameter_reader.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "vibro_impact/config/number.h"
#include "vibro_impact/config/spelling.h"

namespace vibro_impact::graph
{
namespace
{
using XmlRpc::XmlRpcValue;

std::string quoted(const std::string& text)
{
  return '"' + text + '"';
}

// How a value stands on the parameter server.
std::string shown(const XmlRpcValue& value)
{
  switch (value.getType())
  {
    case XmlRpcValue::TypeBoolean:
      return static_cast<const bool&>(value) ? "= true" : "= false";
    case XmlRpcValue::TypeInt:
      return "= " + std::to_string(static_cast<const int&>(value));
    case XmlRpcValue::TypeDouble:
      return "= " + config::formatNumber(static_cast<const double&>(value));
    case XmlRpcValue::TypeString:
    {
      const auto& text = static_cast<const std::string&>(value);
      return "= " + (config::parseNumber(text) ? text : quoted(text));
    }
    case XmlRpcValue::TypeArray:
      return "is a list";
    case XmlRpcValue::TypeStruct:
      return "is a map";
    default:
      return "is binary";
  }
}

}  // namespace

ParameterReader::ParameterReader(const XmlRpcValue& map, std::string path) : path_(std::move(path))
{
  map_.begin();  // makes it a map
  if (map.getType() == XmlRpcValue::TypeStruct)
  {
    map_ = map;
  }
}

bool ParameterReader::has(const std::string& key) const
{
  return map_.hasMember(key);
}

bool ParameterReader::isWord(const std::string& key, const std::string& word) const
{
  return has(key) && map_[key].getType() == XmlRpcValue::TypeString &&
         static_cast<const std::string&>(map_[key]) == word;
}

double ParameterReader::number(const std::string& key, double missing)
{
  const XmlRpcValue* value = find(key);
  if (value == nullptr)
  {
    return missing;
  }
  switch (value->getType())
  {
    case XmlRpcValue::TypeInt:
      return static_cast<const int&>(*value);
    case XmlRpcValue::TypeDouble:
      return static_cast<const double&>(*value);
    case XmlRpcValue::TypeString:
      return config::parseNumber(static_cast<const std::string&>(*value))
          .value_or(std::numeric_limits<double>::quiet_NaN());
    default:
      return std::numeric_limits<double>::quiet_NaN();
  }
}

std::int64_t ParameterReader::integer(const std::string& key, std::int64_t missing)
{
  const XmlRpcValue* value = find(key);
  if (value == nullptr)
  {
    return missing;
  }
  switch (value->getType())
  {
    case XmlRpcValue::TypeInt:
      return static_cast<const int&>(*value);
    case XmlRpcValue::TypeString:
      return config::parseInteger(static_cast<const std::string&>(*value)).value_or(-1);
    default:
      return -1;
  }
}

double ParameterReader::positive(const std::string& key, double missing, double most, const std::string& unit)
{
  const double value = number(key, missing);
  if (!(value > 0.0 && value <= most))
  {
    reject(key, "a number > 0 and <= " + config::formatNumber(most) + unit);
  }
  return value;
}

double ParameterReader::nonNegative(const std::string& key, double missing, double most, const std::string& unit)
{
  const double value = number(key, missing);
  if (!(value >= 0.0 && value <= most))
  {
    reject(key, "a number >= 0 and <= " + config::formatNumber(most) + unit);
  }
  return value;
}

std::uint32_t ParameterReader::count(const std::string& key, std::uint32_t missing, std::uint32_t most)
{
  const std::int64_t value = integer(key, missing);
  if (value < 0 || value > most)
  {
    reject(key, "a whole number from 0 to " + std::to_string(most));
    return missing;
  }
  return static_cast<std::uint32_t>(value);
}

std::string ParameterReader::text(const std::string& key, const std::string& missing)
{
  const XmlRpcValue* value = find(key);
  if (value == nullptr)
  {
    return missing;
  }
  if (value->getType() != XmlRpcValue::TypeString)
  {
    reject(key, "a text");
    return missing;
  }
  return static_cast<const std::string&>(*value);
}

std::vector<std::string> ParameterReader::texts(const std::string& key, const std::vector<std::string>& missing)
{
  const XmlRpcValue* value = find(key);
  if (value == nullptr)
  {
    return missing;
  }
  std::vector<std::string> list;
  bool good = value->getType() == XmlRpcValue::TypeArray;
  for (int i = 0; good && i < value->size(); ++i)
  {
    const XmlRpcValue& entry = (*value)[i];
    good = entry.getType() == XmlRpcValue::TypeString;
    if (good)
    {
      list.push_back(static_cast<const std::string&>(entry));
    }
  }
  if (!good)
  {
    reject(key, "a list of texts");
    return missing;
  }
  return list;
}

std::optional<XmlRpcValue> ParameterReader::map(const std::string& key)
{
  const XmlRpcValue* value = find(key);
  if (value != nullptr && value->getType() == XmlRpcValue::TypeStruct)
  {
    return *value;
  }
  reject(key, "a map");
  return std::nullopt;
}

std::vector<ParameterReader> ParameterReader::maps(const std::string& key)
{
  const XmlRpcValue* value = find(key);
  std::vector<ParameterReader> readers;
  bool good = value != nullptr && value->getType() == XmlRpcValue::TypeArray && value->size() > 0;
  for (int i = 0; good && i < value->size(); ++i)
  {
    good = (*value)[i].getType() == XmlRpcValue::TypeStruct;
    readers.emplace_back((*value)[i], below(key) + "[" + std::to_string(i) + "]");
  }
  if (!good)
  {
    reject(key, "a list of maps, at least one");
    return {};
  }
  return readers;
}

XmlRpcValue ParameterReader::take(const std::vector<std::string>& keys)
{
  XmlRpcValue taken;
  taken.begin();  // makes it a map, even if it stays empty
  for (const std::string& key : keys)
  {
    if (const XmlRpcValue* value = find(key))
    {
      taken[key] = *value;
    }
  }
  return taken;
}

void ParameterReader::reject(const std::string& key, const std::string& allowed)
{
  faults_.push_back(below(key) + " " + (has(key) ? shown(map_[key]) : "is missing") + ": must be " + allowed);
}

void ParameterReader::reject(const std::string& quantity, const std::string& value, const std::string& allowed)
{
  faults_.push_back(below(quantity) + " = " + value + ": must be " + allowed);
}

void ParameterReader::rejectUnknown()
{
  for (const auto& entry : map_)
  {
    if (std::find(known_.begin(), known_.end(), entry.first) == known_.end())
    {
      std::string names;
      for (const std::string& name : known_)
      {
        names += (names.empty() ? "" : ", ") + name;
      }
      const std::optional<std::string> meant = config::nearest(entry.first, known_);
      faults_.push_back(below(quoted(entry.first)) +
                        " is unknown: " + (meant ? "did you mean " + *meant + "?" : "must be one of " + names));
    }
  }
}

const XmlRpcValue* ParameterReader::find(const std::string& key)
{
  known_.push_back(key);
  return has(key) ? &map_[key] : nullptr;
}

void ParameterReader::addFaults(const ParameterReader& part)
{
  faults_.insert(faults_.end(), part.faults_.begin(), part.faults_.end());
}

std::string ParameterReader::below(const std::string& key) const
{
  return path_.empty() ? key : path_ + "." + key;
}

}  // namespace vibro_impact::graph
