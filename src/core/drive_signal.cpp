#include "vibro_impact/core/drive_signal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "parameter_faults.h"
#include "vibro_impact/core/quotient.h"

namespace vibro_impact::core
{
namespace
{
constexpr double two_pi = 6.28318530717958647692;

// Longer signals are mistakes: a million steps, or 2^52 samples (three thousand years at 50 kHz).
constexpr double most_steps = 1.0e+6;
constexpr double most_samples = 4503599627370496.0;

// A stop frequency or an end that is missed by no more than rounding is met: in steps, in samples.
constexpr double step_tolerance = 1.0e-6;
constexpr double sample_tolerance = 1.0e-9;

// Samples between two exact evaluations of the phase; in between, the rounding of a few hundred cycles is below 1e-13.
constexpr std::uint64_t anchor_distance = 1024;

double stepCount(const SteppedSineParameters& parameters)
{
  const double range = std::abs(parameters.stop_frequency - parameters.start_frequency);
  return std::floor(range / parameters.frequency_step + step_tolerance) + 1.0;
}

// Amplitude during a soft start of `length` cycles.
double softStart(double cycles, double length)
{
  return cycles < length ? 0.5 - 0.5 * std::cos(0.5 * two_pi * cycles / length) : 1.0;
}

double sineOfCycles(double cycles)
{
  return std::sin(two_pi * (cycles - std::floor(cycles)));
}

// A point on the time axis in samples: whole + fraction.
class Position
{
public:
  void advance(const Quotient& samples)
  {
    whole_ += samples.whole;
    fraction_ += samples.fraction;
    if (fraction_ >= 1.0)
    {
      ++whole_;
      fraction_ -= 1.0;
    }
  }

  // The first sample that is not before it.
  std::uint64_t firstSample() const
  {
    return fraction_ > sample_tolerance ? whole_ + 1 : whole_;
  }

  // How long before that sample it lies, in samples.
  double lead() const
  {
    return fraction_ > sample_tolerance ? 1.0 - fraction_ : -fraction_;
  }

private:
  std::uint64_t whole_ = 0;
  double fraction_ = 0.0;
};

// A stretch of constant frequency that begins at phase zero.
struct Segment
{
  std::uint64_t first = 0;         // sample
  double lead = 0.0;               // from the begin of the stretch to its first sample, in samples
  double frequency = 0.0;          // Hz; 0: no drive
  double soft_start_cycles = 0.0;  // 0: none
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

  void addSine(double frequency, double cycles, double soft_start_cycles)
  {
    segments_.push_back({position_.firstSample(), position_.lead(), frequency, soft_start_cycles});
    position_.advance(divide(cycles * sample_rate_, frequency));
  }

  void addRest(double seconds)
  {
    segments_.push_back({position_.firstSample(), position_.lead(), 0.0, 0.0});
    position_.advance(divide(seconds * sample_rate_, 1.0));
  }

  Schedule take()
  {
    return {std::move(segments_), position_.firstSample()};
  }

private:
  double sample_rate_;
  Position position_;
  std::vector<Segment> segments_;
};

Schedule schedule(const SineParameters& parameters, double sample_rate)
{
  ScheduleBuilder builder(sample_rate);
  builder.addSine(parameters.reference_frequency * parameters.frequency, parameters.cycles,
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
    builder.addSine(frequency, static_cast<double>(parameters.cycles_per_step),
                    first || rests ? parameters.soft_start_cycles : 0.0);
    first = false;
  }
  return builder.take();
}

class SegmentedSine : public DriveSignal
{
public:
  SegmentedSine(double acceleration, Schedule schedule, double sample_rate)
      : DriveSignal(sample_rate, schedule.samples), acceleration_(acceleration), segments_(std::move(schedule.segments))
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
      double amplitude = acceleration_;
      if (segment.soft_start_cycles > 0.0)
      {
        amplitude *=
            softStart((static_cast<double>(number) + segment.lead) * cycles_per_sample, segment.soft_start_cycles);
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

  double acceleration_;
  std::vector<Segment> segments_;
};

// Linear:      f = f0 + r t,         cycles = f0 t + r t^2/2,            r = (f1 - f0)/T
// Logarithmic: f = f0 exp(r t),      cycles = f0 (exp(r t) - 1)/r,       r = ln(f1/f0)/T
class SweptSine : public DriveSignal
{
public:
  SweptSine(const SweptSineParameters& parameters, double sample_rate, std::uint64_t samples)
      : DriveSignal(sample_rate, samples),
        law_(parameters.law),
        acceleration_(parameters.acceleration),
        start_(parameters.reference_frequency * parameters.start_frequency),
        rate_(law_ == SweepLaw::linear
                  ? parameters.reference_frequency * (parameters.stop_frequency - parameters.start_frequency) /
                        parameters.duration
                  : std::log(parameters.stop_frequency / parameters.start_frequency) / parameters.duration),
        soft_start_cycles_(parameters.soft_start_cycles)
  {
  }

  double frequency(std::uint64_t sample) const override
  {
    if (sample >= samples())
    {
      return 0.0;
    }
    const double time = static_cast<double>(sample) / sampleRate();
    return law_ == SweepLaw::linear ? start_ + rate_ * time : start_ * std::exp(rate_ * time);
  }

private:
  void fill(std::uint64_t first, std::size_t count, double* acceleration) const override
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      const double time = static_cast<double>(first + i) / sampleRate();
      const double cycles =
          law_ == SweepLaw::linear ? time * (start_ + 0.5 * rate_ * time) : start_ * std::expm1(rate_ * time) / rate_;
      acceleration[i] = acceleration_ * softStart(cycles, soft_start_cycles_) * sineOfCycles(cycles);
    }
  }

  SweepLaw law_;
  double acceleration_;
  double start_;
  double rate_;
  double soft_start_cycles_;
};

class FaultFinder
{
public:
  explicit FaultFinder(double sample_rate) : sample_rate_(sample_rate)
  {
    check(isPositive(sample_rate), "sample_rate", sample_rate, "a finite number > 0 (Hz)");
  }

  void operator()(const SineParameters& parameters)
  {
    checkAmplitude(parameters.acceleration);
    const bool reference = checkReference(parameters.reference_frequency);
    const bool frequency = checkFrequency("frequency", parameters.frequency, parameters.reference_frequency);
    const bool cycles = check(isPositive(parameters.cycles), "cycles", parameters.cycles, "a finite number > 0");
    checkSoftStart(parameters.soft_start_cycles, cycles ? parameters.cycles : infinity, "the number of cycles");
    if (reference && frequency && cycles)
    {
      checkDuration(parameters.cycles / (parameters.reference_frequency * parameters.frequency));
    }
  }

  void operator()(const SteppedSineParameters& parameters)
  {
    checkAmplitude(parameters.acceleration);
    bool good = checkReference(parameters.reference_frequency);
    good &= checkFrequency("start_frequency", parameters.start_frequency, parameters.reference_frequency);
    good &= checkFrequency("stop_frequency", parameters.stop_frequency, parameters.reference_frequency);
    good &= check(isPositive(parameters.frequency_step), "frequency_step", parameters.frequency_step,
                  "a finite number > 0, also for steps downwards (Hz, or times reference_frequency)");
    const auto cycles = static_cast<double>(parameters.cycles_per_step);
    const bool has_cycles = check(cycles >= 1.0, "cycles_per_step", cycles, "a whole number >= 1");
    checkSoftStart(parameters.soft_start_cycles, has_cycles ? cycles : infinity, "cycles_per_step");
    good &= check(std::isfinite(parameters.rest) && parameters.rest >= 0.0, "rest", parameters.rest,
                  "a finite number >= 0 (s)");
    if (good && has_cycles &&
        check(stepCount(parameters) <= most_steps, "frequency_step", parameters.frequency_step,
              "large enough for at most " + text(most_steps) + " steps from start to stop"))
    {
      const double lowest =
          parameters.reference_frequency * std::min(parameters.start_frequency, parameters.stop_frequency);
      checkDuration(stepCount(parameters) * (cycles / lowest + parameters.rest));
    }
  }

  void operator()(const SweptSineParameters& parameters)
  {
    checkAmplitude(parameters.acceleration);
    checkReference(parameters.reference_frequency);
    checkFrequency("start_frequency", parameters.start_frequency, parameters.reference_frequency);
    if (checkFrequency("stop_frequency", parameters.stop_frequency, parameters.reference_frequency))
    {
      check(parameters.stop_frequency != parameters.start_frequency, "stop_frequency", parameters.stop_frequency,
            "another one than start_frequency");
    }
    if (check(isPositive(parameters.duration), "duration", parameters.duration, "a finite number > 0 (s)"))
    {
      checkDuration(parameters.duration);
    }
    checkSoftStart(parameters.soft_start_cycles, infinity, "");
  }

  std::vector<ParameterFault> take()
  {
    return std::move(faults_);
  }

private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  static bool isPositive(double value)
  {
    return std::isfinite(value) && value > 0.0;
  }

  bool check(bool good, const std::string& key, double value, const std::string& allowed)
  {
    if (!good)
    {
      faults_.push_back({key, text(value), allowed});
    }
    return good;
  }

  void checkAmplitude(double value)
  {
    check(std::isfinite(value) && value >= 0.0, "acceleration", value, "a finite number >= 0 (m/s^2)");
  }

  bool checkReference(double value)
  {
    return check(isPositive(value), "reference_frequency", value, "a finite number > 0 (Hz)");
  }

  bool checkFrequency(const std::string& key, double value, double reference)
  {
    std::string allowed = "a number > 0";
    double highest = infinity;
    if (isPositive(sample_rate_) && isPositive(reference))
    {
      highest = 0.5 * sample_rate_ / reference;
      allowed += " and < " + text(highest) + ", half the sample rate";
    }
    allowed += reference == 1.0 ? " (Hz)" : " (times reference_frequency)";
    return check(value > 0.0 && value < highest, key, value, allowed);
  }

  void checkSoftStart(double value, double most, const std::string& name_of_most)
  {
    const std::string allowed = std::isfinite(most) ? "a number from 0 to " + text(most) + ", " + name_of_most
                                                    : std::string("a finite number >= 0 (cycles)");
    check(std::isfinite(value) && value >= 0.0 && value <= most, "soft_start_cycles", value, allowed);
  }

  void checkDuration(double seconds)
  {
    if (isPositive(sample_rate_))
    {
      check(seconds * sample_rate_ <= most_samples, "duration", seconds,
            "at most " + text(most_samples / sample_rate_) + " (s)");
    }
  }

  double sample_rate_;
  std::vector<ParameterFault> faults_;
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

std::vector<ParameterFault> findFaults(const DriveParameters& parameters, double sample_rate)
{
  FaultFinder finder(sample_rate);
  std::visit(finder, parameters);
  return finder.take();
}

std::vector<double> stepFrequencies(const SteppedSineParameters& parameters)
{
  const auto count = static_cast<std::size_t>(stepCount(parameters));
  const double step = std::copysign(parameters.frequency_step, parameters.stop_frequency - parameters.start_frequency);
  std::vector<double> frequencies(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    frequencies[i] = parameters.reference_frequency * (parameters.start_frequency + static_cast<double>(i) * step);
  }
  return frequencies;
}

std::unique_ptr<const DriveSignal> makeDriveSignal(const DriveParameters& parameters, double sample_rate)
{
  throwIfAny(findFaults(parameters, sample_rate));
  if (const auto* swept = std::get_if<SweptSineParameters>(&parameters))
  {
    Position end;
    end.advance(divide(swept->duration * sample_rate, 1.0));
    return std::make_unique<SweptSine>(*swept, sample_rate, end.firstSample());
  }
  if (const auto* stepped = std::get_if<SteppedSineParameters>(&parameters))
  {
    return std::make_unique<SegmentedSine>(stepped->acceleration, schedule(*stepped, sample_rate), sample_rate);
  }
  const auto& sine = std::get<SineParameters>(parameters);
  return std::make_unique<SegmentedSine>(sine.acceleration, schedule(sine, sample_rate), sample_rate);
}

}  // namespace vibro_impact::core
