#pragma once

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "common.h"

namespace vibro_impact::core
{
/// A drive signal with known steps, continuous in phase: what a shaker would play, and what its accelerometer would see
/// of it.
class PlayedSignal
{
public:
  explicit PlayedSignal(double sample_rate) : sample_rate_(sample_rate)
  {
  }

  /// A step of so many cycles, not rounded to samples; its amplitude rises over the first `soft_start` cycles.
  PlayedSignal& step(double frequency_hz, double amplitude, double cycles, double soft_start = 0.0)
  {
    const double start = time_;
    const double end = time_ + cycles / frequency_hz;
    while (nextTime() < end)
    {
      const double since = nextTime() - start;
      const double ramp = soft_start > 0.0 ? std::min(1.0, since * frequency_hz / soft_start) : 1.0;
      const double phase = phase_ + two_pi * frequency_hz * since;
      samples_.push_back(amplitude * ramp *
                         (std::sin(phase) + distortion_ * std::sin(2.0 * phase + 0.4) -
                          0.6 * distortion_ * std::sin(3.0 * phase + 1.0)));
    }
    phase_ = std::remainder(phase_ + two_pi * cycles, two_pi);
    time_ = end;
    return *this;
  }

  PlayedSignal& rest(double seconds)
  {
    time_ += seconds;
    while (nextTime() < time_)
    {
      samples_.push_back(0.0);
    }
    return *this;
  }

  /// Frequency running from one value to the other in so many seconds.
  PlayedSignal& sweep(double from_hz, double to_hz, double amplitude, double seconds, bool logarithmic)
  {
    const double start = time_;
    const double rate = std::log(to_hz / from_hz) / seconds;
    while (nextTime() < start + seconds)
    {
      const double t = nextTime() - start;
      const double turns =
          logarithmic ? from_hz * std::expm1(rate * t) / rate : from_hz * t + 0.5 * (to_hz - from_hz) * t * t / seconds;
      samples_.push_back(amplitude * std::sin(phase_ + two_pi * turns));
    }
    time_ = start + seconds;
    return *this;
  }

  PlayedSignal& jumpInPhase(double radians)
  {
    phase_ += radians;
    return *this;
  }

  /// Second harmonic of the steps that follow, relative; the third is 0.6 of it.
  PlayedSignal& distort(double relative)
  {
    distortion_ = relative;
    return *this;
  }

  /// White Gaussian noise on all there is.
  PlayedSignal& addNoise(double deviation, unsigned seed)
  {
    std::mt19937 generator(seed);
    std::normal_distribution<double> noise;  // which takes no deviation of zero
    for (double& sample : samples_)
    {
      sample += deviation * noise(generator);
    }
    return *this;
  }

  PlayedSignal& addOffset(double offset)
  {
    for (double& sample : samples_)
    {
      sample += offset;
    }
    return *this;
  }

  std::vector<double>& samples()
  {
    return samples_;
  }
  double samplePeriod() const
  {
    return 1.0 / sample_rate_;
  }
  /// Number of samples before the present end, not rounded.
  double position() const
  {
    return time_ * sample_rate_;
  }

private:
  double nextTime() const
  {
    return static_cast<double>(samples_.size()) / sample_rate_;
  }

  double sample_rate_;
  double time_ = 0.0;
  double phase_ = 0.3;
  double distortion_ = 0.0;
  std::vector<double> samples_;
};
}  // namespace vibro_impact::core
