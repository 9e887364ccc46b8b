// A sine that glides through bands of constant displacement, velocity or acceleration.

#include <algorithm>
#include <cmath>
#include <string>

#include "drive_phase.h"
#include "drive_signals.h"

namespace vibro_impact::core
{
namespace
{
// Longer signals are mistakes.
constexpr std::int64_t most_sweeps = 1'000'000;

// A band that is too narrow by no more than rounding is not, in octaves.
constexpr double octave_tolerance = 1.0e-9;

// Of one sweep upwards, r = ln 2 times the rate: f = f0 exp(r t), cycles = (f - f0)/r; downwards the same backwards.
class BandedSweep : public DriveSignal
{
public:
  BandedSweep(const BandedSweepParameters& parameters, double sample_rate, double rate, double duration)
      : DriveSignal(sample_rate, samplesBefore(duration * static_cast<double>(parameters.sweeps), sample_rate)),
        parameters_(parameters),
        lowest_(parameters.bands.front().from),
        highest_(parameters.bands.back().to),
        rate_(rate),
        duration_(duration)
  {
  }

  double frequency(std::uint64_t sample) const override
  {
    return sample < samples() ? at(sample).frequency : 0.0;
  }

private:
  struct Moment
  {
    double frequency;  // Hz
    double cycles;     // since the start
  };

  Moment at(std::uint64_t sample) const
  {
    const double time = static_cast<double>(sample) / sampleRate();
    const double sweep = std::min(std::floor(time / duration_), static_cast<double>(parameters_.sweeps - 1));
    const double since = time - sweep * duration_;
    const double whole = sweep * (highest_ - lowest_) / rate_;
    const bool upwards = (std::fmod(sweep, 2.0) == 0.0) == parameters_.upwards;
    const double frequency = upwards ? lowest_ * std::exp(rate_ * since) : highest_ * std::exp(-rate_ * since);
    return {frequency, whole + (upwards ? frequency - lowest_ : highest_ - frequency) / rate_};
  }

  void fill(std::uint64_t first, std::size_t count, double* acceleration) const override
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      const Moment moment = at(first + i);
      acceleration[i] = accelerationAmplitude(parameters_.bands, moment.frequency) *
                        softStart(moment.cycles, parameters_.soft_start_cycles) * sineOfCycles(moment.cycles);
    }
  }

  BandedSweepParameters parameters_;
  double lowest_;
  double highest_;
  double rate_;      // 1/s
  double duration_;  // of one sweep, s
};

}  // namespace

double accelerationAmplitude(const std::vector<SineBand>& bands, double frequency)
{
  // The first band that ends above the frequency; no two edges are so near that both count.
  auto band = std::find_if(bands.begin(), bands.end() - 1,
                           [frequency](const SineBand& candidate)
                           { return std::log2(frequency / candidate.to) < 0.5 * crossover_octaves; });
  const double amplitude = accelerationAmplitude(band->amplitude, frequency);
  const double past_edge = std::log2(frequency / band->to) / crossover_octaves;
  const auto next = band + 1;
  if (next == bands.end() || past_edge < -0.5)
  {
    return amplitude;
  }
  const double share = 0.5 + 0.5 * std::sin(0.5 * two_pi * past_edge);
  return amplitude + share * (accelerationAmplitude(next->amplitude, frequency) - amplitude);
}

void findFaults(const BandedSweepParameters& parameters, DriveFaults& faults)
{
  bool good = faults.checkBands(parameters.bands);
  for (std::size_t i = 0; good && i < parameters.bands.size(); ++i)
  {
    const SineBand& band = parameters.bands[i];
    const std::string path = "bands[" + std::to_string(i) + "].";
    const double least = band.from * std::exp2(crossover_octaves);
    good &= faults.check(std::log2(band.to / band.from) >= crossover_octaves - octave_tolerance, path + "to", band.to,
                         "at least " + text(least) + ", a sixteenth of an octave above from (Hz)");
    good &= i == 0 || faults.check(band.from == parameters.bands[i - 1].to, path + "from", band.from,
                                   text(parameters.bands[i - 1].to) + ", where the band before it ends (Hz)");
  }
  good &= faults.checkPositive("rate", parameters.rate, " (octaves per minute)");
  good &=
      faults.check(parameters.sweeps >= 1 && parameters.sweeps <= most_sweeps, "sweeps",
                   static_cast<double>(parameters.sweeps), "a whole number from 1 to " + std::to_string(most_sweeps));
  faults.checkSoftStart(parameters.soft_start_cycles, DriveFaults::infinity, "");
  if (good)
  {
    faults.checkDuration(60.0 * std::log2(parameters.bands.back().to / parameters.bands.front().from) /
                         parameters.rate * static_cast<double>(parameters.sweeps));
  }
}

std::unique_ptr<const DriveSignal> makeSignal(const BandedSweepParameters& parameters, double sample_rate)
{
  const double rate = parameters.rate / 60.0 * std::log(2.0);
  const double duration = std::log(parameters.bands.back().to / parameters.bands.front().from) / rate;
  return std::make_unique<BandedSweep>(parameters, sample_rate, rate, duration);
}

}  // namespace vibro_impact::core
