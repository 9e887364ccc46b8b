#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace vibro_impact::config
{
/// The shortest decimal text from which parseNumber() gives the same number, bit for bit, whatever the locale.
std::string formatNumber(double value);

/// The number that `text` is as a whole: decimal, finite, "1.5", "-2", "1e-2". Nothing for anything else: an empty
/// text, space around it, "1.0abc", "0x10", "nan", "inf", "1e999".
std::optional<double> parseNumber(const std::string& text);

/// The same for a whole number in decimal digits with an optional sign; nothing for "5.0" or one that does not fit.
std::optional<std::int64_t> parseInteger(const std::string& text);

}  // namespace vibro_impact::config
