#include "vibro_impact/core/drive_signal.h"

#include <stdexcept>
#include <string>
#include <type_traits>

#include "drive_faults.h"
#include "drive_signals.h"
#include "parameter_faults.h"

namespace vibro_impact::core
{
namespace
{
template <typename Family, typename = void>
struct HasReference : std::false_type
{
};

template <typename Family>
struct HasReference<Family, std::void_t<decltype(Family::reference_frequency)>> : std::true_type
{
};

}  // namespace

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

double referenceFrequency(const DriveParameters& parameters)
{
  return std::visit(
      [](const auto& family)
      {
        if constexpr (HasReference<std::decay_t<decltype(family)>>::value)
        {
          return family.reference_frequency;
        }
        return 1.0;
      },
      parameters);
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
