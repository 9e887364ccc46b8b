#include "parameter_faults.h"

#include <locale>
#include <sstream>
#include <stdexcept>

namespace vibro_impact::core
{
std::string text(double value, int digits)
{
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(digits);
  stream << value;
  return stream.str();
}

void throwIfAny(const std::vector<ParameterFault>& faults)
{
  std::string message;
  for (const ParameterFault& fault : faults)
  {
    message += (message.empty() ? "" : "; ") + fault.key + " = " + fault.value + ": must be " + fault.allowed;
  }
  if (!message.empty())
  {
    throw std::invalid_argument(message);
  }
}

}  // namespace vibro_impact::core
