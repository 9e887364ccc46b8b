// Sines of constant frequency, one after the other.

#include <algorithm>
#include <cmath>
#include <utility>

#include "drive_phase.h"
#include "drive_signals.h"
#include "vibro_impact/core/quotient.h"

namespace vibro_impact::core
{
namespace
{
// Longer signals are mistakes.
constexpr double most_steps = 1.0e+6;

// A stop frequency that is missed by no more than rounding is met, in steps.
constexpr double step_tolerance = 1.0e-6;

// Samples between two exact evaluations of the phase; in between, the rounding of a few hundred cycles is below 1e-13.
constexpr std::uint64_t anchor_distance = 1024;

// From one frequency to the other, both included where the last step meets it.
double stepCount(double from, double to, double step)
{
  return std::floor(std::abs(to - from) / step + step_tolerance) + 1.0;
}

double stepCount(const SteppedSineParameters& parameters)
{
  return stepCount(parameters.start_frequency, parameters.stop_frequency, parameters.frequency_step);
}

double stepCount(const SineDwellParameters& parameters)
{
  double count = 0.0;
  for (const SineBand& band : parameters.bands)
  {
    count += stepCount(band.from, band.to, parameters.frequency_step);
  }
  return count;
}

std::vector<double> stepFrequencies(double from, double to, double step)
{
  std::vector<double> frequencies(static_cast<std::size_t>(stepCount(from, to, step)));
  for (std::size_t i = 0; i < frequencies.size(); ++i)
  {
    frequencies[i] = from + static_cast<double>(i) * std::copysign(step, to - from);
  }
  return frequencies;
}

// A stretch of constant frequency that begins at phase zero.
struct Segment
{
  std::uint64_t first = 0;   // sample
  double lead = 0.0;         // from the begin of the stretch to its first sample, in samples
  double frequency = 0.0;    // Hz; 0: no drive
  double amplitude = 0.0;    // m/s^2
  double ramp_cycles = 0.0;  // 0: none
  double ramp_from = 0.0;    // amplitude where the ramp begins, m/s^2
};

struct Schedule
{
  std::vector<Segment> segments;
  std::uint64_t samples = 0;
};

class ScheduleBuilder
{
public:
  explicit ScheduleBuilder(double sample_rate) : sample_rate_(sample_rate)
  {
  }

  void addSine(double frequency, double amplitude, double cycles, double ramp_cycles, double ramp_from = 0.0)
  {
    segments_.push_back({position_.firstSample(), position_.lead(), frequency, amplitude, ramp_cycles, ramp_from});
    position_.advance(divide(cycles * sample_rate_, frequency));
  }

  void addRest(double seconds)
  {
    segments_.push_back({position_.firstSample(), position_.lead()});
    position_.advance(divide(seconds * sample_rate_, 1.0));
  }

  Schedule take()
  {
    return {std::move(segments_), position_.firstSample()};
  }

private:
  double sample_rate_;
  SamplePosition position_;
  std::vector<Segment> segments_;
};

Schedule schedule(const SineParameters& parameters, double sample_rate)
{
  ScheduleBuilder builder(sample_rate);
  builder.addSine(parameters.reference_frequency * parameters.frequency, parameters.acceleration, parameters.cycles,
                  parameters.soft_start_cycles);
  return builder.take();
}

Schedule schedule(const SteppedSineParameters& parameters, double sample_rate)
{
  ScheduleBuilder builder(sample_rate);
  const bool rests = parameters.rest > 0.0;
  bool first = true;
  for (const double frequency : stepFrequencies(parameters))
  {
    if (!first && rests)
    {
      builder.addRest(parameters.rest);
    }
    builder.addSine(frequency, parameters.acceleration, static_cast<double>(parameters.cycles_per_step),
                    first || rests ? parameters.soft_start_cycles : 0.0);
    first = false;
  }
  return builder.take();
}

Schedule schedule(const SineDwellParameters& parameters, double sample_rate)
{
  ScheduleBuilder builder(sample_rate);
  double amplitude = 0.0;
  for (const SineDwell& dwell : sineDwells(parameters))
  {
    builder.addSine(dwell.frequency, dwell.acceleration, dwell.cycles, parameters.ramp_cycles, amplitude);
    amplitude = dwell.acceleration;
  }
  return builder.take();
}

class SegmentedSine : public DriveSignal
{
public:
  SegmentedSine(Schedule schedule, double sample_rate)
      : DriveSignal(sample_rate, schedule.samples), segments_(std::move(schedule.segments))
  {
  }

  double frequency(std::uint64_t sample) const override
  {
    return sample < samples() ? segmentOf(sample)->frequency : 0.0;
  }

private:
  using Iterator = std::vector<Segment>::const_iterator;

  Iterator segmentOf(std::uint64_t sample) const
  {
    const auto starts_later = [](std::uint64_t number, const Segment& segment) { return number < segment.first; };
    return std::upper_bound(segments_.begin(), segments_.end(), sample, starts_later) - 1;
  }

  void fill(std::uint64_t first, std::size_t count, double* acceleration) const override
  {
    const std::uint64_t end = first + count;
    for (auto segment = segmentOf(first); first < end; ++segment)
    {
      const auto next = segment + 1;
      const std::uint64_t stop = next == segments_.end() ? end : std::min(end, next->first);
      while (first < stop)
      {
        const std::uint64_t number = first - segment->first;
        const std::uint64_t anchor = number - number % anchor_distance;
        const std::uint64_t here = std::min(stop, segment->first + anchor + anchor_distance);
        acceleration = fillFrom(*segment, anchor, number, here - segment->first, acceleration);
        first = here;
      }
    }
  }

  // Samples [number, stop) of a segment, counted from its first one and close to `anchor`.
  double* fillFrom(const Segment& segment, std::uint64_t anchor, std::uint64_t number, std::uint64_t stop,
                   double* acceleration) const
  {
    const double cycles_per_sample = segment.frequency / sampleRate();
    const double phase = exactPhase(segment.frequency, anchor) + segment.lead * cycles_per_sample;
    for (; number < stop; ++number)
    {
      const double cycles = phase + static_cast<double>(number - anchor) * cycles_per_sample;
      double amplitude = segment.amplitude;
      if (segment.ramp_cycles > 0.0)
      {
        const double done = (static_cast<double>(number) + segment.lead) * cycles_per_sample;
        amplitude = segment.ramp_from + (amplitude - segment.ramp_from) * softStart(done, segment.ramp_cycles);
      }
      *acceleration++ = amplitude * sineOfCycles(cycles);
    }
    return acceleration;
  }

  // Cycles that `number` samples take, without whole ones: the product is split into two numbers that are exact
  // together.
  double exactPhase(double frequency, std::uint64_t number) const
  {
    const double samples = static_cast<double>(number);
    const double product = samples * frequency;
    const double rest = std::fma(samples, frequency, -product);
    return divide(product, sampleRate()).fraction + rest / sampleRate();
  }

  std::vector<Segment> segments_;
};

}  // namespace

void findFaults(const SineParameters& parameters, DriveFaults& faults)
{
  faults.checkAmplitude("acceleration", parameters.acceleration, " (m/s^2)");
  const bool reference = faults.checkReference(parameters.reference_frequency);
  const bool frequency = faults.checkFrequency("frequency", parameters.frequency, parameters.reference_frequency);
  const bool cycles =
      faults.check(DriveFaults::isPositive(parameters.cycles), "cycles", parameters.cycles, "a finite number > 0");
  faults.checkSoftStart(parameters.soft_start_cycles, cycles ? parameters.cycles : DriveFaults::infinity,
                        "the number of cycles");
  if (reference && frequency && cycles)
  {
    faults.checkDuration(parameters.cycles / (parameters.reference_frequency * parameters.frequency));
  }
}

void findFaults(const SteppedSineParameters& parameters, DriveFaults& faults)
{
  faults.checkAmplitude("acceleration", parameters.acceleration, " (m/s^2)");
  bool good = faults.checkReference(parameters.reference_frequency);
  good &= faults.checkFrequency("start_frequency", parameters.start_frequency, parameters.reference_frequency);
  good &= faults.checkFrequency("stop_frequency", parameters.stop_frequency, parameters.reference_frequency);
  good &= faults.check(DriveFaults::isPositive(parameters.frequency_step), "frequency_step", parameters.frequency_step,
                       "a finite number > 0, also for steps downwards (Hz, or times reference_frequency)");
  const auto cycles = static_cast<double>(parameters.cycles_per_step);
  const bool has_cycles = faults.check(cycles >= 1.0, "cycles_per_step", cycles, "a whole number >= 1");
  faults.checkSoftStart(parameters.soft_start_cycles, has_cycles ? cycles : DriveFaults::infinity, "cycles_per_step");
  good &= faults.check(std::isfinite(parameters.rest) && parameters.rest >= 0.0, "rest", parameters.rest,
                       "a finite number >= 0 (s)");
  if (good && has_cycles &&
      faults.check(stepCount(parameters) <= most_steps, "frequency_step", parameters.frequency_step,
                   "large enough for at most " + text(most_steps) + " steps from start to stop"))
  {
    const double lowest =
        parameters.reference_frequency * std::min(parameters.start_frequency, parameters.stop_frequency);
    faults.checkDuration(stepCount(parameters) * (cycles / lowest + parameters.rest));
  }
}

void findFaults(const SineDwellParameters& parameters, DriveFaults& faults)
{
  bool good = faults.checkBands(parameters.bands);
  good &= faults.checkPositive("frequency_step", parameters.frequency_step, ", also for bands downwards (Hz)");
  good &= faults.checkPositive("dwell", parameters.dwell, " (s)");
  good &= faults.checkAmplitude("ramp_cycles", parameters.ramp_cycles, " (cycles)");
  if (!good || !faults.check(stepCount(parameters) <= most_steps, "frequency_step", parameters.frequency_step,
                             "large enough for at most " + text(most_steps) + " dwells"))
  {
    return;
  }
  double shortest = DriveFaults::infinity;
  double duration = 0.0;
  for (const SineDwell& dwell : sineDwells(parameters))
  {
    shortest = std::min(shortest, dwell.cycles);
    duration += dwell.cycles / dwell.frequency;
  }
  faults.check(parameters.ramp_cycles <= shortest, "ramp_cycles", parameters.ramp_cycles,
               "at most " + text(shortest) + ", the cycles of the shortest dwell");
  faults.checkDuration(duration);
}

std::vector<double> stepFrequencies(const SteppedSineParameters& parameters)
{
  std::vector<double> frequencies =
      stepFrequencies(parameters.start_frequency, parameters.stop_frequency, parameters.frequency_step);
  for (double& frequency : frequencies)
  {
    frequency *= parameters.reference_frequency;
  }
  return frequencies;
}

std::vector<SineDwell> sineDwells(const SineDwellParameters& parameters)
{
  std::vector<SineDwell> dwells;
  for (const SineBand& band : parameters.bands)
  {
    for (const double frequency : stepFrequencies(band.from, band.to, parameters.frequency_step))
    {
      const double cycles = std::max(1.0, std::ceil(parameters.dwell * frequency - step_tolerance));
      dwells.push_back({frequency, accelerationAmplitude(band.amplitude, frequency), cycles});
    }
  }
  return dwells;
}

std::unique_ptr<const DriveSignal> makeSignal(const SineParameters& parameters, double sample_rate)
{
  return std::make_unique<SegmentedSine>(schedule(parameters, sample_rate), sample_rate);
}

std::unique_ptr<const DriveSignal> makeSignal(const SteppedSineParameters& parameters, double sample_rate)
{
  return std::make_unique<SegmentedSine>(schedule(parameters, sample_rate), sample_rate);
}

std::unique_ptr<const DriveSignal> makeSignal(const SineDwellParameters& parameters, double sample_rate)
{
  return std::make_unique<SegmentedSine>(schedule(parameters, sample_rate), sample_rate);
}

}  // namespace vibro_impact::core
