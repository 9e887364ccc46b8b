#include "vibro_impact/config/response_table.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <type_traits>
#include <variant>

#include "text_file.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"

namespace vibro_impact::config
{
namespace
{
template <typename Row>
struct Column
{
  const char* name;
  std::variant<double Row::*, int Row::*, bool Row::*, std::uint64_t Row::*> member;
};

using core::ResponseRow;

const std::vector<Column<ResponseRow>> response_columns = {
    {"omega_star", &ResponseRow::omega_star},
    {"frequency_hz", &ResponseRow::frequency_hz},
    {"acceleration", &ResponseRow::acceleration},
    {"period", &ResponseRow::period},
    {"steady", &ResponseRow::steady},
    {"impacts", &ResponseRow::impacts},
    {"impacts_per_cycle", &ResponseRow::impacts_per_cycle},
    {"impulse_mean", &ResponseRow::impulse_mean},
    {"impulse_min", &ResponseRow::impulse_min},
    {"impulse_max", &ResponseRow::impulse_max},
    {"impulse_star_mean", &ResponseRow::impulse_star_mean},
    {"impulse_star_min", &ResponseRow::impulse_star_min},
    {"impulse_star_max", &ResponseRow::impulse_star_max},
    {"impulse_per_cycle", &ResponseRow::impulse_per_cycle},
    {"peak_force", &ResponseRow::peak_force},
    {"duration_mean", &ResponseRow::duration_mean},
};

const std::vector<Column<ImpactRow>> impact_columns = {
    {"omega_star", &ImpactRow::omega_star},
    {"number", &ImpactRow::number},
    {"onset_s", &ImpactRow::onset_s},
    {"duration_s", &ImpactRow::duration_s},
    {"impulse", &ImpactRow::impulse},
    {"peak_force", &ImpactRow::peak_force},
    {"approach_speed", &ImpactRow::approach_speed},
    {"separation_speed", &ImpactRow::separation_speed},
};

std::string cell(double value)
{
  return formatNumber(value);
}

template <typename Integer, typename = std::enable_if_t<std::is_integral_v<Integer>>>
std::string cell(Integer value)
{
  return std::to_string(value);
}

bool parseCell(const std::string& text, double& value)
{
  const std::optional<double> number = parseNumber(text);
  value = number.value_or(0.0);
  return number.has_value();
}

template <typename Integer, typename = std::enable_if_t<std::is_integral_v<Integer>>>
bool parseCell(const std::string& text, Integer& value)
{
  const std::optional<std::int64_t> number = parseInteger(text);
  // Not even a running number of impacts comes near the end of a signed one.
  constexpr auto greatest = std::min<std::uint64_t>(std::numeric_limits<Integer>::max(), INT64_MAX);
  if (!number || *number < 0 || *number > static_cast<std::int64_t>(greatest))
  {
    return false;
  }
  value = static_cast<Integer>(*number);
  return true;
}

template <typename Row>
std::string writeTable(const std::vector<Column<Row>>& columns, const std::vector<Row>& rows)
{
  std::string text;
  for (const auto& column : columns)
  {
    text += (text.empty() ? "" : ",") + std::string(column.name);
  }
  for (const Row& row : rows)
  {
    char separator = '\n';
    for (const auto& column : columns)
    {
      text += separator + std::visit([&row](auto member) { return cell(row.*member); }, column.member);
      separator = ',';
    }
  }
  return text + '\n';
}

template <typename Row>
std::vector<Row> readTable(const std::string& path, const std::vector<Column<Row>>& columns)
{
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
  {
    throw Error(path + ": cannot be read: it is a directory");
  }
  errno = 0;
  std::ifstream file(path);
  if (!file)
  {
    throw Error(path + ": cannot be read: " + std::strerror(errno));
  }
  std::string line;
  if (!std::getline(file, line))
  {
    throw Error(path + ": is empty: must be a table that starts with the names of its columns");
  }
  const std::vector<std::string> names = splitCells(line);
  std::vector<std::size_t> positions;
  std::string missing;
  for (const auto& column : columns)
  {
    const auto found = std::find(names.begin(), names.end(), column.name);
    if (found == names.end())
    {
      missing += (missing.empty() ? "" : ", ") + std::string(column.name);
    }
    positions.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  if (!missing.empty())
  {
    throw Error(path + ": line 1: columns are missing: " + missing);
  }

  std::vector<Row> rows;
  for (std::size_t number = 2; std::getline(file, line); ++number)
  {
    const std::string place = path + ": line " + std::to_string(number);
    const std::vector<std::string> cells = splitCells(line);
    if (cells.size() != names.size())
    {
      throw Error(place + ": has " + std::to_string(cells.size()) + " columns: must have " +
                  std::to_string(names.size()));
    }
    Row row;
    for (std::size_t i = 0; i < columns.size(); ++i)
    {
      const std::string& text = cells[positions[i]];
      std::visit(
          [&](auto member)
          {
            if (!parseCell(text, row.*member))
            {
              throw Error(place + ": column " + columns[i].name + " = \"" + text + "\": must be a " +
                          (std::holds_alternative<double Row::*>(columns[i].member) ? "finite" : "whole") + " number");
            }
          },
          columns[i].member);
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

OutputFile responseTable(const std::vector<core::Response>& responses)
{
  std::vector<ResponseRow> rows;
  rows.reserve(responses.size());
  for (const core::Response& response : responses)
  {
    rows.push_back(response.row);
  }
  return {"frf.csv", writeTable(response_columns, rows)};
}

OutputFile impactTable(const std::vector<core::Response>& responses)
{
  std::vector<ImpactRow> rows;
  for (const core::Response& response : responses)
  {
    for (const core::TimedImpact& captured : response.captured)
    {
      const core::Impact& impact = captured.impact;
      rows.push_back({response.row.omega_star, impact.number, captured.onset, impact.duration, impact.impulse,
                      impact.peak_force, impact.approach_speed, impact.separation_speed});
    }
  }
  return {"impacts.csv", writeTable(impact_columns, rows)};
}

std::vector<ResponseRow> readResponseTable(const std::string& path)
{
  return readTable(path, response_columns);
}

std::vector<ImpactRow> readImpactTable(const std::string& path)
{
  return readTable(path, impact_columns);
}

}  // namespace vibro_impact::config
