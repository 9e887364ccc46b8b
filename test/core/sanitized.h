#pragma once

namespace vibro_impact::core
{
/// Whether sanitizers watch, which makes a test take ten times as long. They look for faults of the code, and a part of
/// the repetitions passes through the same code; what all of them are to show, the build without sanitizers tests in
/// full.
#ifdef VIBRO_IMPACT_SANITIZE
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

}  // namespace vibro_impact::core
