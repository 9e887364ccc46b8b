#pragma once

#include <memory>

#include "drive_faults.h"
#include "vibro_impact/core/drive_signal.h"

namespace vibro_impact::core
{
// Each family of drive signals: what is wrong with its parameters, and the signal that they make if nothing is.

void findFaults(const SineParameters& parameters, DriveFaults& faults);
void findFaults(const SteppedSineParameters& parameters, DriveFaults& faults);
void findFaults(const SweptSineParameters& parameters, DriveFaults& faults);

std::unique_ptr<const DriveSignal> makeSignal(const SineParameters& parameters, double sample_rate);
std::unique_ptr<const DriveSignal> makeSignal(const SteppedSineParameters& parameters, double sample_rate);
std::unique_ptr<const DriveSignal> makeSignal(const SweptSineParameters& parameters, double sample_rate);

}  // namespace vibro_impact::core
