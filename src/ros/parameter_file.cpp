#include "vibro_impact/ros/parameter_file.h"

#include <filesystem>
#include <limits>

#include <yaml-cpp/yaml.h>

#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"

namespace vibro_impact::graph
{
namespace
{
using XmlRpc::XmlRpcValue;

// Larger files are none that anybody has written.
constexpr std::uintmax_t largest_file = 10'000'000;

XmlRpcValue scalar(const YAML::Node& node)
{
  const std::string& text = node.Scalar();
  if (node.Tag() == "!")  // quoted
  {
    return text;
  }
  if (text == "true" || text == "false")
  {
    return text == "true";
  }
  const auto whole = config::parseInteger(text);
  if (whole && *whole >= std::numeric_limits<int>::min() && *whole <= std::numeric_limits<int>::max())
  {
    return static_cast<int>(*whole);
  }
  const auto number = config::parseNumber(text);
  return number ? XmlRpcValue(*number) : XmlRpcValue(text);
}

XmlRpcValue toParameter(const YAML::Node& node)
{
  XmlRpcValue value;
  switch (node.Type())
  {
    case YAML::NodeType::Scalar:
      return scalar(node);
    case YAML::NodeType::Sequence:
      value.setSize(static_cast<int>(node.size()));
      for (std::size_t i = 0; i < node.size(); ++i)
      {
        value[static_cast<int>(i)] = toParameter(node[i]);
      }
      return value;
    case YAML::NodeType::Map:
      value.begin();  // makes it a map, even if it stays empty
      for (const auto& entry : node)
      {
        value[entry.first.as<std::string>()] = toParameter(entry.second);
      }
      return value;
    default:
      return std::string();
  }
}

}  // namespace

XmlRpcValue readParameterFile(const std::string& path)
{
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (failure)
  {
    throw config::Error(path + ": " + failure.message());
  }
  if (size > largest_file)
  {
    throw config::Error(path + ": has " + std::to_string(size) + " bytes, which no file of parameters has");
  }
  try
  {
    const YAML::Node root = YAML::LoadFile(path);
    if (!root.IsMap())
    {
      throw config::Error(path + ": must be a map of parameters");
    }
    return toParameter(root);
  }
  catch (const YAML::Exception& error)
  {
    throw config::Error(path + ": " + error.what());
  }
}

ShakerParameters loadShakerParameters(const std::string& path)
{
  XmlRpcValue tree = readParameterFile(path);
  tree["signal_directory"] = std::filesystem::absolute(path).parent_path().string();
  return parseShakerParameters(tree, path);
}

}  // namespace vibro_impact::graph
