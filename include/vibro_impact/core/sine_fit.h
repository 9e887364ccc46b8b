#pragma once

#include <array>
#include <cstddef>

namespace vibro_impact::core
{
/// A sine fitted to equally spaced samples: y(t) = offset + amplitude cos(frequency t + phase), t = 0 in the middle of
/// them.
struct SineFit
{
  double frequency = 0.0;  ///< rad/s
  double amplitude = 0.0;  ///< >= 0, in the unit of the samples
  double phase = 0.0;      ///< half way between the first and the last sample, rad, in (-pi, pi]
  double offset = 0.0;     ///< in the unit of the samples
  double residual =
      0.0;  ///< standard deviation of what the fit (harmonics included) leaves, in the unit of the samples
};

/// Sums over samples y at the positions n, each one more than that before: all that a sine fit asks of the samples. A
/// step from one to the next is `step` rad of the sine.
struct SineSums
{
  static constexpr std::size_t harmonics = 3;

  double sum = 0.0;                        ///< of y
  double squares = 0.0;                    ///< y^2
  std::array<double, harmonics> cosine{};  ///< y cos(h step n), h = 1, 2, 3
  std::array<double, harmonics> sine{};    ///< y sin(h step n)
  double moment_cosine = 0.0;              ///< n y cos(step n)
  double moment_sine = 0.0;                ///< n y sin(step n)
};

/// Least-squares sine fit of IEEE Std 1057, gathered while the samples stream by. Harmonics of the frequency may be
/// fitted along, so that the distortion of a shaker does not leak into the fundamental where the samples are not whole
/// cycles.
class SineFitter
{
public:
  static constexpr int most_harmonics = static_cast<int>(SineSums::harmonics);

  /// `frequency` in rad/s, > 0; `sample_period` in s, > 0; `count` samples will be added, at least one; `harmonics`
  /// 1 (the fundamental alone) ... most_harmonics. Throws std::invalid_argument otherwise.
  SineFitter(double frequency, double sample_period, std::size_t count, int harmonics = 1);

  /// Takes the next samples; those beyond `count` are left. Returns how many were taken.
  std::size_t add(const double* samples, std::size_t count);

  /// Samples taken so far.
  std::size_t added() const
  {
    return added_;
  }

  /// All samples have been added.
  bool complete() const
  {
    return added_ == count_;
  }

  /// The smallest number of samples that determines a four-parameter fit with one degree of freedom left.
  static std::size_t fewestSamples(int harmonics);

  /// Three-parameter fit: amplitude, phase and offset at the frequency given. Throws std::logic_error unless complete.
  SineFit knownFrequency() const;

  /// Four-parameter fit: one Gauss-Newton step for the frequency, from the frequency given. Converges quadratically: a
  /// frequency given to 0.05 cycles over all samples comes out to better than the noise. Throws std::logic_error unless
  /// complete.
  SineFit unknownFrequency() const;

private:
  void requireComplete() const;
  double half() const;  // of the length, in samples: the unit of tau

  double frequency_;
  double sample_period_;
  std::size_t count_;
  int harmonics_;
  std::size_t added_ = 0;
  SineSums sums_;  // positions from the middle of all samples
};

/// Iterated four-parameter fit of `count` samples in memory, from a frequency (rad/s) that is right to about half a
/// cycle over all samples. Throws std::invalid_argument as SineFitter does, and for fewer samples than determine the
/// fit.
SineFit fitSine(const double* samples, std::size_t count, double sample_period, double frequency, int harmonics = 1);

}  // namespace vibro_impact::core
