#include "vibro_impact/config/modal_table_file.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include "text_file.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/config/spelling.h"

namespace vibro_impact::config
{
namespace
{
using core::ModalTableParameters;

struct Column
{
  const char* name;
  std::vector<double> ModalTableParameters::*member;
  bool optional;
};

constexpr Column columns[] = {
    {"frequency_hz", &ModalTableParameters::frequency_hz, false},
    {"contact_deflection", &ModalTableParameters::contact_deflection, false},
    {"participation", &ModalTableParameters::participation, false},
    {"damping_ratio", &ModalTableParameters::damping_ratio, true},
};

/// Ten thousand modes with a few columns more than needed.
constexpr std::size_t largest_file = 1 << 22;

std::string trimmed(const std::string& text)
{
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string> cellsOf(const std::string& line)
{
  std::vector<std::string> cells = splitCells(line);
  std::transform(cells.begin(), cells.end(), cells.begin(), trimmed);
  return cells;
}

/// Where in a line each of `columns` is; names.size() for one that is not there.
std::vector<std::size_t> locate(const std::vector<std::string>& names, const std::string& place)
{
  std::vector<std::size_t> positions;
  std::vector<std::string> known;
  std::string missing;
  for (const Column& column : columns)
  {
    const auto found = std::find(names.begin(), names.end(), column.name);
    if (std::count(names.begin(), names.end(), column.name) > 1)
    {
      throw Error(place + "column " + column.name + " is there more than once");
    }
    if (found == names.end() && !column.optional)
    {
      missing += (missing.empty() ? "" : ", ") + std::string(column.name);
    }
    positions.push_back(static_cast<std::size_t>(found - names.begin()));
    known.emplace_back(column.name);
  }
  if (!missing.empty())
  {
    throw Error(place + "columns are missing: " + missing +
                ": must have frequency_hz, contact_deflection, participation and may have damping_ratio");
  }
  for (const std::string& name : names)
  {
    const bool wanted = std::find(known.begin(), known.end(), name) != known.end();
    if (const auto meant = nearest(name, known); !wanted && meant)
    {
      throw Error(place + "column \"" + name + "\" is unknown: did you mean " + *meant + "?");
    }
  }
  return positions;
}

}  // namespace

core::ModalTableParameters readModalTable(const std::string& path)
{
  return parseModalTable(readTextFile(path, largest_file, "no modal table is"), path);
}

core::ModalTableParameters parseModalTable(const std::string& csv, const std::string& path)
{
  std::istringstream text(csv);
  core::ModalTableParameters table;
  std::vector<std::string> names;
  std::vector<std::size_t> positions;
  std::string line;
  for (std::size_t number = 1; std::getline(text, line); ++number)
  {
    if (number == 1 && line.compare(0, 3, "\xEF\xBB\xBF") == 0)  // spreadsheets mark UTF-8 so
    {
      line.erase(0, 3);
    }
    const std::string place = path + ": line " + std::to_string(number) + ": ";
    const std::vector<std::string> cells = cellsOf(line);
    if ((cells.size() == 1 && cells.front().empty()) || cells.front().compare(0, 1, "#") == 0)
    {
      continue;
    }
    if (names.empty())
    {
      names = cells;
      positions = locate(names, place);
      continue;
    }
    if (cells.size() != names.size())
    {
      throw Error(place + "has " + std::to_string(cells.size()) + " columns: must have " +
                  std::to_string(names.size()) + ", as the first line");
    }
    for (std::size_t i = 0; i < positions.size(); ++i)
    {
      if (positions[i] < cells.size())
      {
        const std::string& cell = cells[positions[i]];
        const std::optional<double> value = parseNumber(cell);
        if (!value)
        {
          throw Error(place + "column " + columns[i].name + " = \"" + cell + "\": must be a finite number");
        }
        (table.*columns[i].member).push_back(*value);
      }
    }
  }
  if (table.frequency_hz.empty())
  {
    throw Error(path + ": holds no modes: must be a line with the names of the columns, then one line a mode");
  }
  return table;
}

}  // namespace vibro_impact::config
