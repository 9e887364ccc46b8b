#include "vibro_impact/core/sine_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "lanes.h"

namespace vibro_impact::core
{
namespace
{
constexpr int most = 2 * SineFitter::most_harmonics + 3;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;

// Half way between the first and the last of `count` samples, in samples.
double middleOf(std::size_t count)
{
  return 0.5 * static_cast<double>(count - 1);
}

// Sums over the positions n = -(count - 1)/2, ..., (count - 1)/2.
struct PositionSums
{
  double cosine;  // cos(angle n)
  double moment;  // n sin(angle n)
  double second;  // n^2 cos(angle n)
};

// The first is Dirichlet's kernel D = sin(count angle/2)/sin(angle/2); the others are -D' and -D'', from
//   2 sin(angle/2) D' = count cos(count angle/2) - cos(angle/2) D,    D'' = (1 - count^2)/4 D - cot(angle/2) D'
PositionSums sumOverPositions(double angle, std::size_t count)
{
  const auto positions = static_cast<double>(count);
  const double sine = std::sin(0.5 * angle);
  const double cosine = std::cos(0.5 * angle);
  // Over less than a sixth of a turn the differences above cancel. A fit over a cycle or more asks this of angle 0
  // only.
  if (std::abs(sine) * positions < 0.5)
  {
    PositionSums sums{0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < count; ++i)
    {
      const double n = static_cast<double>(i) - middleOf(count);
      sums.cosine += std::cos(angle * n);
      sums.moment += n * std::sin(angle * n);
      sums.second += n * n * std::cos(angle * n);
    }
    return sums;
  }
  const double kernel = std::sin(0.5 * positions * angle) / sine;
  const double slope = (positions * std::cos(0.5 * positions * angle) - cosine * kernel) / (2.0 * sine);
  return {kernel, -slope, (0.25 * (positions * positions - 1.0)) * kernel + cosine / sine * slope};
}

// The normal equations of the columns 1; cos and sin of every harmonic; tau cos and tau sin, with tau = n/half.
struct NormalEquations
{
  Matrix normal;
  Vector right;
};

// Positions lie evenly about zero, so that products of an even and an odd column leave nothing.
NormalEquations normalEquations(double step, std::size_t count, int harmonics, double half, const SineSums& samples)
{
  const auto positions = static_cast<double>(count);
  std::array<PositionSums, 2 * SineFitter::most_harmonics + 1> at{};  // at multiples of the step
  at[0] = {positions, 0.0, positions * (positions * positions - 1.0) / 12.0};
  for (std::size_t k = 1; k < at.size(); ++k)
  {
    at[k] = sumOverPositions(static_cast<double>(k) * step, count);
  }
  const Eigen::Index columns = 2 * harmonics + 3;
  const Eigen::Index tau_cos = columns - 2;
  const Eigen::Index tau_sin = columns - 1;
  NormalEquations equations{Matrix::Zero(columns, columns), Vector::Zero(columns)};
  Matrix& normal = equations.normal;
  Vector& right = equations.right;
  normal(0, 0) = positions;
  right(0) = samples.sum;
  for (Eigen::Index h = 1; h <= harmonics; ++h)
  {
    const Eigen::Index cos_h = 2 * h - 1;
    const Eigen::Index sin_h = 2 * h;
    const auto order = static_cast<std::size_t>(h);
    normal(cos_h, 0) = at[order].cosine;
    for (Eigen::Index l = 1; l <= h; ++l)
    {
      const double difference = at[static_cast<std::size_t>(h - l)].cosine;
      const double sum = at[static_cast<std::size_t>(h + l)].cosine;
      normal(cos_h, 2 * l - 1) = 0.5 * (difference + sum);
      normal(sin_h, 2 * l) = 0.5 * (difference - sum);
    }
    normal(tau_sin, cos_h) = 0.5 * (at[order + 1].moment - at[order - 1].moment) / half;
    normal(tau_cos, sin_h) = 0.5 * (at[order + 1].moment + at[order - 1].moment) / half;
    right(cos_h) = samples.cosine[order - 1];
    right(sin_h) = samples.sine[order - 1];
  }
  normal(tau_sin, 0) = at[1].moment / half;
  normal(tau_cos, tau_cos) = 0.5 * (at[0].second + at[2].second) / (half * half);
  normal(tau_sin, tau_sin) = 0.5 * (at[0].second - at[2].second) / (half * half);
  right(tau_cos) = samples.moment_cosine / half;
  right(tau_sin) = samples.moment_sine / half;
  normal.triangularView<Eigen::StrictlyUpper>() = normal.transpose();
  return equations;
}

SineFit fitOf(double frequency, const Vector& parameters, double sum_of_squares, std::size_t count)
{
  SineFit fit;
  fit.frequency = frequency;
  fit.offset = parameters(0);
  fit.amplitude = std::hypot(parameters(1), parameters(2));
  fit.phase = std::atan2(-parameters(2), parameters(1));
  const double freedom = static_cast<double>(count) - static_cast<double>(parameters.size());
  fit.residual = freedom > 0.0 ? std::sqrt(std::max(sum_of_squares, 0.0) / freedom) : 0.0;
  return fit;
}
}  // namespace

SineFitter::SineFitter(double frequency, double sample_period, std::size_t count, int harmonics)
    : frequency_(frequency), sample_period_(sample_period), count_(count), harmonics_(harmonics)
{
  if (!std::isfinite(frequency) || frequency <= 0.0)
  {
    throw std::invalid_argument("sine fit: frequency is " + std::to_string(frequency) + " rad/s, must be > 0");
  }
  if (!std::isfinite(sample_period) || sample_period <= 0.0)
  {
    throw std::invalid_argument("sine fit: sample_period is " + std::to_string(sample_period) + " s, must be > 0");
  }
  if (count < 1)
  {
    throw std::invalid_argument("sine fit: no samples");
  }
  if (harmonics < 1 || harmonics > most_harmonics)
  {
    throw std::invalid_argument("sine fit: harmonics is " + std::to_string(harmonics) + ", must be 1 ... " +
                                std::to_string(most_harmonics));
  }
}

std::size_t SineFitter::fewestSamples(int harmonics)
{
  return 2 * static_cast<std::size_t>(harmonics) + 3;
}

std::size_t SineFitter::add(const double* samples, std::size_t count)
{
  const std::size_t taken = std::min(count, count_ - added_);
  addSineSums(samples, taken, frequency_ * sample_period_, static_cast<double>(added_) - middleOf(count_), sums_);
  added_ += taken;
  return taken;
}

void SineFitter::requireComplete() const
{
  if (!complete())
  {
    throw std::logic_error("sine fit: " + std::to_string(added_) + " of " + std::to_string(count_) +
                           " samples have been added");
  }
}

double SineFitter::half() const
{
  return std::max(middleOf(count_), 0.5);
}

SineFit SineFitter::knownFrequency() const
{
  requireComplete();
  const NormalEquations all = normalEquations(frequency_ * sample_period_, count_, harmonics_, half(), sums_);
  const Eigen::Index parameters = all.right.size() - 2;
  const Matrix normal = all.normal.topLeftCorner(parameters, parameters);
  const Vector right = all.right.head(parameters);
  const Vector solution = normal.ldlt().solve(right);
  return fitOf(frequency_, solution, sums_.squares - right.dot(solution), added_);
}

SineFit SineFitter::unknownFrequency() const
{
  const SineFit start = knownFrequency();
  const NormalEquations all = normalEquations(frequency_ * sample_period_, count_, harmonics_, half(), sums_);

  // The derivative with respect to the frequency, (B cos - A sin) tau, takes the place of tau cos and tau sin.
  const Eigen::Index parameters = all.right.size() - 1;
  Matrix choice = Matrix::Zero(parameters + 1, parameters);
  choice.topLeftCorner(parameters - 1, parameters - 1).setIdentity();
  choice(parameters - 1, parameters - 1) = -start.amplitude * std::sin(start.phase);
  choice(parameters, parameters - 1) = -start.amplitude * std::cos(start.phase);
  const Matrix normal = choice.transpose() * all.normal * choice;
  const Vector right = choice.transpose() * all.right;
  const Vector solution = normal.ldlt().solve(right);
  return fitOf(frequency_ + solution(parameters - 1) / (half() * sample_period_), solution,
               sums_.squares - right.dot(solution), added_);
}

SineFit fitSine(const double* samples, std::size_t count, double sample_period, double frequency, int harmonics)
{
  if (count < SineFitter::fewestSamples(harmonics))
  {
    throw std::invalid_argument("sine fit: " + std::to_string(count) + " samples, needs at least " +
                                std::to_string(SineFitter::fewestSamples(harmonics)));
  }
  constexpr int most_iterations = 12;
  const double converged = 1.0e-13 + 1.0e-12 / static_cast<double>(count);
  SineFit fit;
  for (int i = 0; i < most_iterations; ++i)
  {
    SineFitter fitter(frequency, sample_period, count, harmonics);
    fitter.add(samples, count);
    fit = fitter.unknownFrequency();
    if (!(fit.frequency > 0.0) || std::abs(fit.frequency - frequency) <= converged * frequency)
    {
      break;
    }
    frequency = fit.frequency;
  }
  return fit;
}
}  // namespace vibro_impact::core
