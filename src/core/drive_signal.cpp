#include "vibro_impact/core/drive_signal.h"

#include <stdexcept>
#include <string>

#include "drive_faults.h"
#include "drive_signals.h"
#include "parameter_faults.h"

namespace vibro_impact::core
{
void DriveSignal::generate(std::uint64_t first, std::size_t count, double* acceleration) const
{
  if (first > samples_ || count > samples_ - first)
  {
    throw std::out_of_range("samples " + std::to_string(first) + " to " + std::to_string(first + count) +
                            " of a drive signal that has " + std::to_string(samples_));
  }
  if (count > 0)
  {
    fill(first, count, acceleration);
  }
}

std::vector<ParameterFault> findFaults(const DriveParameters& parameters, double sample_rate)
{
  DriveFaults faults(sample_rate);
  std::visit([&faults](const auto& family) { findFaults(family, faults); }, parameters);
  return faults.take();
}

std::unique_ptr<const DriveSignal> makeDriveSignal(const DriveParameters& parameters, double sample_rate)
{
  throwIfAny(findFaults(parameters, sample_rate));
  return std::visit([sample_rate](const auto& family) { return makeSignal(family, sample_rate); }, parameters);
}

}  // namespace vibro_impact::core
