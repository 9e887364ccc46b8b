#pragma once

#include <string>

#include "vibro_impact/core/parameters.h"

namespace vibro_impact::config
{
/// The parameters that a configuration in YAML text gives. Its keys, all of them required except the basis:
///
///   beam1: {youngs_modulus, density, length, height, width, contact_location}      Pa, kg/m^3, m
///   beam2: the same, or the word `rigid`
///   contact: {stiffness, clearance}                                                N/m, m
///   damping: {free, contact}                                                       ratio of critical
///   basis: {type: conjoined, modes_free, modes_contact} or {type: attachment, modes_per_beam}
///
/// Without `basis` it is the default of core::SystemParameters. A text that is wholly a number counts as one.
/// Throws Error if a key is missing, unknown, given twice, of a wrong type or out of range (see core::findFaults): one
/// message with all faults, a line for each, with key, value and what is allowed. `name` is how the message calls the
/// text.
core::SystemParameters parse(const std::string& yaml, const std::string& name);

/// The same from a file. Throws Error, naming the path, also if it cannot be read.
core::SystemParameters loadFile(const std::string& path);

/// The complete configuration as YAML text; parse() gives exactly the same parameters back.
std::string toYaml(const core::SystemParameters& parameters);

}  // namespace vibro_impact::config
