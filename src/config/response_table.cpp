#include "vibro_impact/config/response_table.h"

#include "table.h"

namespace vibro_impact::config
{
namespace
{
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
    {"contact_share", &ResponseRow::contact_share},
    {"stiffness", &ResponseRow::stiffness},
    {"clearance", &ResponseRow::clearance},
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
    {"energy_lost", &ImpactRow::energy_lost},
    {"dissipated", &ImpactRow::dissipated},
    {"mapping_loss", &ImpactRow::mapping_loss},
    {"base_work", &ImpactRow::base_work},
};

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

std::vector<ImpactRow> impactRows(const std::vector<core::Response>& responses)
{
  std::vector<ImpactRow> rows;
  for (const core::Response& response : responses)
  {
    for (const core::TimedImpact& captured : response.captured)
    {
      const core::Impact& impact = captured.impact;
      rows.push_back({response.row.omega_star, impact.number, captured.onset, impact.duration, impact.impulse,
                      impact.peak_force, impact.approach_speed, impact.separation_speed, impact.energy_lost,
                      impact.dissipated, impact.mapping_loss, impact.base_work});
    }
  }
  return rows;
}

OutputFile impactTable(const std::vector<core::Response>& responses)
{
  return {"impacts.csv", writeTable(impact_columns, impactRows(responses))};
}

std::vector<ResponseRow> readResponseTable(const std::string& path)
{
  std::ifstream file = openTextFile(path);
  return readResponseTable(file, path);
}

std::vector<ImpactRow> readImpactTable(const std::string& path)
{
  std::ifstream file = openTextFile(path);
  return readImpactTable(file, path);
}

std::vector<ResponseRow> readResponseTable(std::istream& file, const std::string& path)
{
  return readTable(file, path, response_columns);
}

std::vector<ImpactRow> readImpactTable(std::istream& file, const std::string& path)
{
  return readTable(file, path, impact_columns);
}

}  // namespace vibro_impact::config
