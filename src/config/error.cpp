#include "vibro_impact/config/error.h"

namespace vibro_impact::config
{
namespace
{
std::string message(const std::string& name, const std::vector<std::string>& faults)
{
  if (faults.size() == 1)
  {
    return name + ": " + faults[0];
  }
  std::string text = name + ": " + std::to_string(faults.size()) + " faults";
  for (const std::string& fault : faults)
  {
    text += "\n  " + fault;
  }
  return text;
}

}  // namespace

Error::Error(const std::string& name, const std::vector<std::string>& faults)
    : std::runtime_error(message(name, faults))
{
}

}  // namespace vibro_impact::config
