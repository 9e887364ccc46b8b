#include <cmath>
#include <stdexcept>
#include <string>

#include "drive_phase.h"
#include "vibro_impact/core/drive_steps.h"

namespace vibro_impact::core
{
DriveStepMeter::DriveStepMeter(const std::vector<FoundStep>& steps, double sample_period)
{
  for (const FoundStep& step : steps)
  {
    const double half_cycle = 0.5 * two_pi / (step.frequency * sample_period);
    const auto margin = static_cast<std::uint64_t>(std::ceil(half_cycle));
    const std::uint64_t length = step.last - step.first - 2 * margin;
    pieces_.push_back(
        {step, step.first + margin,
         SineFitter(step.frequency, sample_period, static_cast<std::size_t>(length), SineFitter::most_harmonics)});
  }
}

void DriveStepMeter::add(std::uint64_t first, const double* samples, std::size_t count)
{
  const std::uint64_t last = first + count;
  while (current_ < pieces_.size() && last > pieces_[current_].fit_first)
  {
    Piece& piece = pieces_[current_];
    const std::uint64_t wanted = piece.fit_first + piece.fitter.added();
    if (first > wanted)
    {
      return;
    }
    if (last > wanted)
    {
      piece.fitter.add(samples + (wanted - first), static_cast<std::size_t>(last - wanted));
    }
    if (!piece.fitter.complete())
    {
      return;
    }
    ++current_;
  }
}

std::vector<MeasuredStep> DriveStepMeter::finish() const
{
  std::vector<MeasuredStep> measured;
  for (const Piece& piece : pieces_)
  {
    if (!piece.fitter.complete())
    {
      throw std::logic_error("the samples of the step from sample " + std::to_string(piece.step.first) + " to " +
                             std::to_string(piece.step.last) + " are not all there");
    }
    measured.push_back({piece.step.first, piece.step.last, piece.fitter.unknownFrequency()});
  }
  return measured;
}

}  // namespace vibro_impact::core
