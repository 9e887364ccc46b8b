#pragma once

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "text_file.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"

namespace vibro_impact::config
{
/// A column of a CSV table, and the member of its rows that it shows. Truth is 1 or 0; what is not there is an empty
/// cell.
template <typename Row>
struct Column
{
  const char* name;
  std::variant<double Row::*, int Row::*, bool Row::*, std::uint64_t Row::*, std::optional<double> Row::*> member;
};

inline std::string cell(double value)
{
  return formatNumber(value);
}

inline std::string cell(const std::optional<double>& value)
{
  return value ? formatNumber(*value) : std::string();
}

template <typename Integer, typename = std::enable_if_t<std::is_integral_v<Integer>>>
std::string cell(Integer value)
{
  return std::to_string(value);
}

inline bool parseCell(const std::string& text, double& value)
{
  const std::optional<double> number = parseNumber(text);
  value = number.value_or(0.0);
  return number.has_value();
}

inline bool parseCell(const std::string& text, std::optional<double>& value)
{
  value = parseNumber(text);
  return value.has_value() || text.empty();
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

/// Comma-separated text: the names of the columns, then a line for each row; every number reads back exactly.
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

/// Reads a table back. Columns are found by name; further ones are ignored. Throws Error if the file called `path`
/// cannot be read, lacks a column or holds a row that is too short, too long or not of numbers; the message names file,
/// line and column.
template <typename Row>
std::vector<Row> readTable(std::istream& file, const std::string& path, const std::vector<Column<Row>>& columns)
{
  std::string line;
  if (!std::getline(file, line))
  {
    requireWhollyRead(file, path);
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
                          (std::is_integral_v<std::decay_t<decltype(row.*member)>> ? "whole" : "finite") + " number");
            }
          },
          columns[i].member);
    }
    rows.push_back(row);
  }
  requireWhollyRead(file, path);
  return rows;
}

}  // namespace vibro_impact::config
