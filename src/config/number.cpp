#include "vibro_impact/config/number.h"

#include <charconv>
#include <limits>
#include <locale>
#include <sstream>
#include <system_error>

namespace vibro_impact::config
{
std::string formatNumber(double value)
{
  std::string text;
  for (int digits = std::numeric_limits<double>::digits10; digits <= std::numeric_limits<double>::max_digits10;
       ++digits)
  {
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    stream.precision(digits);
    stream << value;
    text = stream.str();
    if (parseNumber(text) == value)
    {
      break;
    }
  }
  return text;
}

std::optional<double> parseNumber(const std::string& text)
{
  // In the classic locale a stream reads decimal numbers only: no hexadecimals, no infinities, no digit groups.
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = 0.0;
  if (!(stream >> std::noskipws >> value) || stream.peek() != std::istringstream::traits_type::eof())
  {
    return std::nullopt;
  }
  return value;
}

std::optional<std::int64_t> parseInteger(const std::string& text)
{
  const char* first = text.data();
  const char* const last = first + text.size();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-')
  {
    ++first;
  }
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc() || end != last)
  {
    return std::nullopt;
  }
  return value;
}

}  // namespace vibro_impact::config
