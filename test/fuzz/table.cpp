// Any text as one of the CSV tables that are read: it is refused with a message, or what it gives makes sense.
// The first byte chooses the table.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "require.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/response_table.h"
#include "vibro_impact/config/sampled_excitation.h"

namespace config = vibro_impact::config;
namespace core = vibro_impact::core;
using vibro_impact::fuzz::require;

namespace
{
void readExcitation(std::istream& text)
{
  const config::SampledExcitation excitation = config::readExcitation(text, "input");
  require(excitation.acceleration.size() >= 2, "an excitation has two samples");
  require(std::isfinite(excitation.start), "the start is finite");
  require(std::isfinite(excitation.sample_period) && excitation.sample_period > 0.0, "the period is positive");
  for (const double value : excitation.acceleration)
  {
    require(std::isfinite(value), "samples are finite");
  }
}

void readResponses(std::istream& text)
{
  const std::vector<core::ResponseRow> rows = config::readResponseTable(text, "input");
  std::vector<core::Response> responses(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    responses[i].row = rows[i];
  }
  const std::string written = config::responseTable(responses).text;
  std::istringstream again(written);
  const std::vector<core::ResponseRow> read = config::readResponseTable(again, "written");
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    responses.at(i).row = read.at(i);
  }
  require(config::responseTable(responses).text == written, "what was read writes back the same");
}

void readImpacts(std::istream& text)
{
  for (const config::ImpactRow& row : config::readImpactTable(text, "input"))
  {
    require(std::isfinite(row.onset_s) && std::isfinite(row.impulse), "numbers are finite");
  }
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  if (size == 0)
  {
    return 0;
  }
  std::istringstream text(std::string(data + 1, data + size));
  try
  {
    switch (data[0] % 3)
    {
      case 0:
        readExcitation(text);
        break;
      case 1:
        readResponses(text);
        break;
      default:
        readImpacts(text);
    }
  }
  catch (const config::Error& error)
  {
    require(error.what()[0] != '\0', "a refusal has a message");
  }
  return 0;
}
