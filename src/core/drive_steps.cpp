#include "vibro_impact/core/drive_steps.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "amplitude_stretches.h"
#include "drive_cycles.h"
#include "drive_phase.h"
#include "frequency_drift.h"
#include "phase_lines.h"

namespace vibro_impact::core
{
namespace
{
// A step and the line through its phases.
struct Candidate
{
  FoundStep step;
  PhaseLine line;
};

// Where a drive that is continuous in phase goes over from one step to the next, the lines through their phases meet:
// moves the boundary there, unless that is more than a cycle or two from where it was found.
void joinSteps(Candidate& left, Candidate& right)
{
  const double left_end = static_cast<double>(left.step.last);
  const double right_start = static_cast<double>(right.step.first);
  const double cycle = two_pi / std::min(left.line.slope, right.line.slope);
  const double difference = left.line.slope - right.line.slope;
  const double middle = 0.5 * (left_end + right_start);
  const double meeting = middle + (right.line.at(middle) - left.line.at(middle)) / difference;
  const bool near = right_start - left_end < 3.0 * cycle && std::abs(meeting - left_end) < 2.0 * cycle &&
                    std::abs(meeting - right_start) < 2.0 * cycle;
  const bool enough = meeting > static_cast<double>(left.step.first) + 2.0 * cycle &&
                      meeting < static_cast<double>(right.step.last) - 2.0 * cycle;
  if (near && enough)
  {
    left.step.last = right.step.first = static_cast<std::uint64_t>(std::ceil(meeting));
  }
}

// Adds a candidate to those before it, or takes the last of them away: a short stretch of hardly another frequency and
// amplitude beside a long one is the end of its soft start, not a step.
void append(const Candidate& candidate, double sample_period, double amplitude_tolerance,
            std::vector<Candidate>& candidates)
{
  if (!candidates.empty())
  {
    const FoundStep& before = candidates.back().step;
    const FoundStep& step = candidate.step;
    const bool close = std::abs(step.frequency - before.frequency) < 1.0e-3 * step.frequency &&
                       std::abs(step.amplitude - before.amplitude) < amplitude_tolerance * step.amplitude &&
                       static_cast<double>(step.first - before.last) * step.frequency * sample_period < two_pi;
    if (close && 4 * (step.last - step.first) < before.last - before.first)
    {
      return;
    }
    if (close && 4 * (before.last - before.first) < step.last - step.first)
    {
      candidates.pop_back();
    }
  }
  candidates.push_back(candidate);
}

// Appends the steps that the cycles of one run make.
void searchRun(std::vector<DriveCycle> run, double sample_period, const StepSearchOptions& options,
               std::vector<FoundStep>& steps)
{
  if (run.size() < static_cast<std::size_t>(options.shortest_step))
  {
    return;
  }
  const std::vector<PhaseLine> lines = phaseLines(run);
  const std::vector<bool> constant = constantLines(run, lines);
  const AmplitudeStretches stretches(run, options);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < lines.size(); ++i)
  {
    for (const AmplitudeStretch& stretch : constant[i] ? stretches.within(lines[i]) : std::vector<AmplitudeStretch>())
    {
      Candidate candidate;
      candidate.line = lineThrough(run, stretch.first, stretch.last);
      candidate.step.first = run[stretch.first].first;
      candidate.step.last = run[stretch.last - 1].last;
      candidate.step.frequency = candidate.line.slope / sample_period;
      candidate.step.amplitude = stretches.medianAmplitude(stretch);
      append(candidate, sample_period, options.amplitude_tolerance, candidates);
    }
  }
  for (std::size_t i = 0; i + 1 < candidates.size(); ++i)
  {
    joinSteps(candidates[i], candidates[i + 1]);
  }
  for (const Candidate& candidate : candidates)
  {
    steps.push_back(candidate.step);
  }
}
}  // namespace

struct DriveStepFinder::Implementation
{
  Implementation(double period, const StepSearchOptions& search_options)
      : sample_period(period), options(search_options), follower(period, search_options)
  {
  }

  double sample_period;
  StepSearchOptions options;
  DriveCycleFollower follower;
};

DriveStepFinder::DriveStepFinder(double sample_period, const StepSearchOptions& options)
{
  const auto require = [](bool fulfilled, const char* name, double value, const char* allowed)
  {
    if (!fulfilled)
    {
      std::ostringstream text;
      text << "step search: " << name << " is " << value << ", must be " << allowed;
      throw std::invalid_argument(text.str());
    }
  };
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  require(positive(sample_period), "sample_period", sample_period, "> 0");
  require(options.shortest_step >= 4, "shortest_step", options.shortest_step, ">= 4");
  require(options.amplitude_tolerance > 0.0 && options.amplitude_tolerance < 1.0, "amplitude_tolerance",
          options.amplitude_tolerance, "in (0, 1)");
  require(positive(options.lowest_frequency) && options.lowest_frequency * sample_period > 1.0e-9 &&
              options.lowest_frequency * sample_period < 0.1,
          "lowest_frequency", options.lowest_frequency, "> 0 and less than a tenth of the sample rate");
  require(positive(options.largest_residual), "largest_residual", options.largest_residual, "> 0");
  implementation_ = std::make_unique<Implementation>(sample_period, options);
}

DriveStepFinder::~DriveStepFinder() = default;
DriveStepFinder::DriveStepFinder(DriveStepFinder&&) noexcept = default;
DriveStepFinder& DriveStepFinder::operator=(DriveStepFinder&&) noexcept = default;

void DriveStepFinder::add(std::uint64_t first, const double* samples, std::size_t count)
{
  implementation_->follower.add(first, samples, count);
}

std::vector<FoundStep> DriveStepFinder::finish()
{
  const DriveCycleFollower& follower = implementation_->follower;
  std::vector<FoundStep> steps;
  for (std::size_t i = 0; i < follower.runs(); ++i)
  {
    searchRun(follower.run(i), implementation_->sample_period, implementation_->options, steps);
  }
  return steps;
}

std::vector<MeasuredStep> findDriveSteps(const double* samples, std::size_t count, double sample_period,
                                         const StepSearchOptions& options)
{
  DriveStepFinder finder(sample_period, options);
  finder.add(0, samples, count);
  DriveStepMeter meter(finder.finish(), sample_period);
  meter.add(0, samples, count);
  return meter.finish();
}

DriveStep driveStep(const MeasuredStep& step, double sample_period)
{
  return {step.fit.frequency, step.fit.amplitude, static_cast<double>(step.first) * sample_period,
          static_cast<double>(step.last) * sample_period};
}
}  // namespace vibro_impact::core
