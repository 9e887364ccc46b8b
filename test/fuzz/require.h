#pragma once

#include <cstdio>
#include <cstdlib>

namespace vibro_impact::fuzz
{
/// Ends the process, so that the fuzzer keeps the input, if what must always hold does not.
inline void require(bool holds, const char* what)
{
  if (!holds)
  {
    std::fprintf(stderr, "does not hold: %s\n", what);
    std::abort();
  }
}

}  // namespace vibro_impact::fuzz
