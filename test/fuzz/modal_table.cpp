// Any text as the CSV file of a modal table: it is refused with a message, or all its columns have a value in each row.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "require.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/modal_table_file.h"

namespace config = vibro_impact::config;
using vibro_impact::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const std::string text(data, data + size);
  try
  {
    const vibro_impact::core::ModalTableParameters table = config::parseModalTable(text, "input");
    const std::size_t modes = table.frequency_hz.size();
    require(modes > 0, "a table has modes");
    require(table.contact_deflection.size() == modes, "every mode has a deflection");
    require(table.participation.size() == modes, "every mode has a participation");
    require(table.damping_ratio.empty() || table.damping_ratio.size() == modes, "all modes have a damping or none");
    for (const auto* column :
         {&table.frequency_hz, &table.contact_deflection, &table.participation, &table.damping_ratio})
    {
      for (const double value : *column)
      {
        require(std::isfinite(value), "numbers are finite");
      }
    }
  }
  catch (const config::Error& error)
  {
    require(error.what()[0] != '\0', "a refusal has a message");
  }
  return 0;
}
