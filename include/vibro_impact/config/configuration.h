#pragma once

#include <string>

#include "vibro_impact/core/parameters.h"

namespace vibro_impact::config
{
/// The parameters that a configuration in YAML text gives. Its keys, all of them required but those in parentheses:
///
///   beam1, beam2: the word `rigid`, a beam or a modal table                        SI units; doc/structures/
///     beam: {youngs_modulus, density, length, CROSS_SECTION, contact_location, (ends), (rigid_body)}
///       CROSS_SECTION, one of:  height, width;  rectangle: {height, width};
///                               tube: {outer_diameter, wall_thickness, (added_mass_per_length)};
///                               section: {bending_stiffness, mass_per_length}, without youngs_modulus and density
///       ends: [FIRST, SECOND], each pinned, clamped or free; pinned without it
///       rigid_body: {length, mass, rotary_inertia}
///     modal table: {modal_table: {file, (static_receptance)}}, or the columns of the file as lists:
///                  {modal_table: {frequency_hz, contact_deflection, participation, (damping_ratio), ...}}
///   contact: {stiffness, clearance}                                                N/m, m
///   damping: {free, contact}                                                       ratio of critical
///   (basis): {type: conjoined, modes_free, modes_contact} or {type: attachment, modes_per_beam}
///
/// Without `basis` it is the default of core::SystemParameters. A text that is wholly a number counts as one. The file
/// of a modal table (readModalTable()) is relative to `directory`; where that is empty its path must be absolute.
/// Throws Error if a key is missing, unknown, given twice, of a wrong type or out of range (see core::findFaults): one
/// message with all faults, a line for each, with key, value and what is allowed. `name` is how the message calls the
/// text.
core::SystemParameters parse(const std::string& yaml, const std::string& name, const std::string& directory = "");

/// The same from a file, `directory` being the one that it is in. Throws Error, naming the path, also if it cannot be
/// read.
core::SystemParameters loadFile(const std::string& path);

/// The complete configuration as YAML text, which needs no other file; parse() gives exactly the same parameters back.
std::string toYaml(const core::SystemParameters& parameters);

}  // namespace vibro_impact::config
