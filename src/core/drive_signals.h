#pragma once

#include <memory>

#include "drive_faults.h"
#include "vibro_impact/core/drive_signal.h"

namespace vibro_impact::core
{
// Each family of drive signals: what is wrong with its parameters, and the signal that they make if nothing is.

void findFaults(const SineParameters& parameters, DriveFaults& faults);
void findFaults(const SteppedSineParameters& parameters, DriveFaults& faults);
void findFaults(const SineDwellParameters& parameters, DriveFaults& faults);
void findFaults(const SweptSineParameters& parameters, DriveFaults& faults);
void findFaults(const BandedSweepParameters& parameters, DriveFaults& faults);
void findFaults(const RandomParameters& parameters, DriveFaults& faults);
void findFaults(const ShockParameters& parameters, DriveFaults& faults);
void findFaults(const SampledParameters& parameters, DriveFaults& faults);

std::unique_ptr<const DriveSignal> makeSignal(const SineParameters& parameters, double sample_rate);
std::unique_ptr<const DriveSignal> makeSignal(const SteppedSineParameters& parameters, double sample_rate);
std::unique_ptr<const DriveSignal> makeSignal(const SineDwellParameters& parameters, double sample_rate);
std::unique_ptr<const DriveSignal> makeSignal(const SweptSineParameters& parameters, double sample_rate);
std::unique_ptr<const DriveSignal> makeSignal(const BandedSweepParameters& parameters, double sample_rate);
std::unique_ptr<const DriveSignal> makeSignal(const RandomParameters& parameters, double sample_rate);
std::unique_ptr<const DriveSignal> makeSignal(const ShockParameters& parameters, double sample_rate);
std::unique_ptr<const DriveSignal> makeSignal(const SampledParameters& parameters, double sample_rate);

}  // namespace vibro_impact::core
