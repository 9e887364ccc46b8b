#pragma once

#include <limits>
#include <string>
#include <vector>

#include "vibro_impact/core/parameters.h"

namespace vibro_impact::core
{
/// A number as a message shows it, whatever the locale.
std::string text(double value, int digits = std::numeric_limits<double>::digits10);

/// Throws std::invalid_argument if there are any faults; the message names each parameter, its value and what is
/// allowed.
void throwIfAny(const std::vector<ParameterFault>& faults);

}  // namespace vibro_impact::core
