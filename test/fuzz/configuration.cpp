// Any text as a configuration: it is refused with a message, or what it gives writes back to the same parameters.

#include <cstddef>
#include <cstdint>
#include <string>

#include "require.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/error.h"

namespace config = vibro_impact::config;
using vibro_impact::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const std::string text(data, data + size);
  std::string written;
  try
  {
    // The name of a file that the text might give is not to be read here.
    written = config::toYaml(config::parse(text, "input", "/nowhere"));
  }
  catch (const config::Error& error)
  {
    require(error.what()[0] != '\0', "a refusal has a message");
    return 0;
  }
  require(config::toYaml(config::parse(written, "written")) == written, "what was parsed writes back the same");
  return 0;
}
