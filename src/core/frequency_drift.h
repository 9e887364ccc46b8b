#pragma once

#include <vector>

#include "drive_cycles.h"
#include "phase_lines.h"

namespace vibro_impact::core
{
/// Which lines have a constant frequency, and are not pieces of a sweep; one answer a line. `cycles` and `lines` as
/// phaseLines() left and gave them.
///
/// Were a line a piece of a sweep, its frequency would drift as fast as it changes from the line before to the line
/// after; the log likelihood ratio of no drift against that one decides. Short lines are undecided by themselves: their
/// neighbours, ever more distant ones, are asked as well, and are believed more readily when they speak of a sweep, for
/// a sweep is never alone.
std::vector<bool> constantLines(const std::vector<DriveCycle>& cycles, const std::vector<PhaseLine>& lines);

}  // namespace vibro_impact::core
