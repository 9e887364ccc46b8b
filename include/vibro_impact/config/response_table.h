#pragma once

#include <cstdint>
#include <istream>
#include <string>
#include <vector>

#include "vibro_impact/config/output_directory.h"
#include "vibro_impact/core/response.h"

namespace vibro_impact::config
{
/// One row of impacts.csv: a captured impact. Column names are the members' names.
struct ImpactRow
{
  double omega_star = 0.0;        ///< drive frequency over the lowest natural frequency of beam 1, 1
  std::uint64_t number = 0;       ///< Impact::number
  double onset_s = 0.0;           ///< TimedImpact::onset, s
  double duration_s = 0.0;        ///< s
  double impulse = 0.0;           ///< N s
  double peak_force = 0.0;        ///< N
  double approach_speed = 0.0;    ///< m/s
  double separation_speed = 0.0;  ///< m/s
  double energy_lost = 0.0;       ///< dissipated + mapping_loss, J
  double dissipated = 0.0;        ///< J
  double mapping_loss = 0.0;      ///< J
  double base_work = 0.0;         ///< J
};

/// frf.csv: comma-separated text with one row per response, in their order, under the names of ResponseRow's members;
/// truth is 1 or 0, and every number reads back exactly.
OutputFile responseTable(const std::vector<core::Response>& responses);

/// One row per captured impact, in the order of the responses.
std::vector<ImpactRow> impactRows(const std::vector<core::Response>& responses);

/// impacts.csv: these rows.
OutputFile impactTable(const std::vector<core::Response>& responses);

/// Read a table back. Columns are found by name; further ones are ignored. Throws Error if the file cannot be read,
/// lacks a column or holds a row that is too short, too long or not of numbers; the message names file, line and
/// column.
std::vector<core::ResponseRow> readResponseTable(const std::string& path);
std::vector<ImpactRow> readImpactTable(const std::string& path);
/// The same of an open file that messages call `path`.
std::vector<core::ResponseRow> readResponseTable(std::istream& file, const std::string& path);
std::vector<ImpactRow> readImpactTable(std::istream& file, const std::string& path);

}  // namespace vibro_impact::config
