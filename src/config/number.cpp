#include "vibro_impact/config/number.h"

#include <locale.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <locale>
#include <sstream>
#include <system_error>

namespace vibro_impact::config
{
namespace
{
// The "C" locale in this thread, as long as it lives.
class ClassicLocale
{
public:
  ClassicLocale() : before_(uselocale(classic()))
  {
  }
  ~ClassicLocale()
  {
    uselocale(before_);
  }
  ClassicLocale(const ClassicLocale&) = delete;
  ClassicLocale& operator=(const ClassicLocale&) = delete;

private:
  static locale_t classic()
  {
    static const locale_t locale = newlocale(LC_ALL_MASK, "C", nullptr);
    return locale;
  }

  locale_t before_;
};
}  // namespace

std::string formatNumber(double value)
{
  // A history has millions of numbers, and a stream takes ten times as long for each.
  const ClassicLocale guard;
  std::array<char, 32> text{};
  for (int digits = std::numeric_limits<double>::digits10; digits <= std::numeric_limits<double>::max_digits10;
       ++digits)
  {
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    if (std::strtod(text.data(), nullptr) == value)
    {
      break;
    }
  }
  return text.data();
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
