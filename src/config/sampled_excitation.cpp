#include "vibro_impact/config/sampled_excitation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

#include "table.h"

namespace vibro_impact::config
{
namespace
{
// Times with few decimals are off by this share of a step, if not more.
constexpr double spacing_tolerance = 0.05;

struct Row
{
  double time = 0.0;
  double acceleration = 0.0;
};

const std::vector<Column<Row>> columns = {
    {"time", &Row::time},
    {"acceleration", &Row::acceleration},
};

std::string rounded(double value)
{
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(6);
  stream << value;
  return stream.str();
}

[[noreturn]] void fail(const std::string& path, std::size_t row, double time, const std::string& reason)
{
  // The names of the columns are line 1.
  throw Error(path + ": line " + std::to_string(row + 2) + ": column time = " + formatNumber(time) + ": " + reason);
}

double medianStep(const std::vector<Row>& rows)
{
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows.size(); ++i)
  {
    steps.push_back(rows[i].time - rows[i - 1].time);
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// The shortest decimal number that is `period` within the rounding of the times at both ends.
double shortest(double period, double first, double last, double steps)
{
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(first), std::abs(last));
  for (int digits = 1; digits <= std::numeric_limits<double>::max_digits10; ++digits)
  {
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    stream.precision(digits);
    stream << period;
    const double candidate = parseNumber(stream.str()).value_or(period);
    if (std::abs(first + steps * candidate - last) <= rounding)
    {
      return candidate;
    }
  }
  return period;
}

}  // namespace

SampledExcitation readExcitation(const std::string& path)
{
  std::ifstream file = openTextFile(path);
  return readExcitation(file, path);
}

SampledExcitation readExcitation(std::istream& file, const std::string& path)
{
  const std::vector<Row> rows = readTable(file, path, columns);
  if (rows.size() < 2)
  {
    throw Error(path + ": holds " + std::to_string(rows.size()) + (rows.size() == 1 ? " sample" : " samples") +
                ": must hold at least 2");
  }
  const double typical = medianStep(rows);
  for (std::size_t i = 1; i < rows.size(); ++i)
  {
    const double step = rows[i].time - rows[i - 1].time;
    if (step <= 0.0)
    {
      fail(path, i, rows[i].time, "must be later than the line before it, " + formatNumber(rows[i - 1].time));
    }
    if (std::abs(step - typical) > spacing_tolerance * typical)
    {
      fail(path, i, rows[i].time,
           rounded(step) + " s after the line before it: must be equally spaced, by about " + rounded(typical) + " s");
    }
  }
  const double steps = static_cast<double>(rows.size() - 1);
  const double first = rows.front().time;
  const double period = (rows.back().time - first) / steps;
  for (std::size_t i = 1; i < rows.size(); ++i)
  {
    const double equal = first + static_cast<double>(i) * period;
    if (std::abs(rows[i].time - equal) > spacing_tolerance * period)
    {
      fail(path, i, rows[i].time,
           "must be equally spaced: with " + rounded(period) + " s from line to line it would be " +
               formatNumber(equal));
    }
  }
  SampledExcitation excitation;
  excitation.start = first;
  excitation.sample_period = shortest(period, first, rows.back().time, steps);
  for (const Row& row : rows)
  {
    excitation.acceleration.push_back(row.acceleration);
  }
  return excitation;
}

}  // namespace vibro_impact::config
