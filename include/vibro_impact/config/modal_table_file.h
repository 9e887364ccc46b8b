#pragma once

#include <string>

#include "vibro_impact/core/parameters.h"

namespace vibro_impact::config
{
/// The modes in a CSV file: a line with the names of the columns, then one line a mode.
///
///   frequency_hz        Hz, 0 for a rigid-body mode
///   contact_deflection  mass-normalised shape at the contact point, kg^-1/2
///   participation       in base motion, kg^1/2
///   damping_ratio       optional, of critical damping
///
/// The columns may be in any order, with space around what is in them; further ones are ignored, as are empty lines and
/// those that begin with #. Throws Error, naming the file, the line and the column, if it cannot be read, a column is
/// missing or twice there, or a cell is no number. Ranges are those of core::findFaults.
core::ModalTableParameters readModalTable(const std::string& path);
/// The same of the text of a file that messages call `path`.
core::ModalTableParameters parseModalTable(const std::string& csv, const std::string& path);

}  // namespace vibro_impact::config
