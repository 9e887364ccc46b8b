#include "vibro_impact/core/sine_fit.h"

#include <algorithm>
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
constexpr int most = 2 * SineFitter::most_harmonics + 4;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;

// Samples after which the rotation is computed anew.
constexpr std::size_t renewal = 256;

// Half way between the first and the last of `count` samples, in samples.
double middleOf(std::size_t count)
{
  return 0.5 * static_cast<double>(count - 1);
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
    : frequency_(frequency),
      sample_period_(sample_period),
      count_(count),
      harmonics_(harmonics),
      columns_(2 * harmonics + 4)
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
  switch (harmonics_)
  {
    case 1:
      accumulate<1>(samples, taken);
      break;
    case 2:
      accumulate<2>(samples, taken);
      break;
    default:
      accumulate<3>(samples, taken);
  }
  added_ += taken;
  return taken;
}

// The number of harmonics is known to the compiler: this loop takes most of the time of a search for steps.
template <int harmonics>
void SineFitter::accumulate(const double* samples, std::size_t count)
{
  constexpr std::size_t columns = 2 * harmonics + 4;
  const double step = frequency_ * sample_period_;
  const double middle = middleOf(count_);
  const double half = std::max(middle, 0.5);
  const double step_cos = std::cos(step);
  const double step_sin = std::sin(step);
  double c = 0.0;
  double s = 0.0;
  // A table at a time, whose products are then summed by as many at once as the processor can.
  constexpr std::size_t most_rows = 64;
  static_assert(renewal % most_rows == 0, "the rotation is renewed with a table");
  std::array<ProductRow, most_rows> rows{};
  std::array<ProductRow, most_products> sums{};
  for (std::size_t first = 0; first < count; first += most_rows)
  {
    const std::size_t last = std::min(count, first + most_rows);
    // The rotation from sample to sample is renewed before its rounding errors add up.
    if (first % renewal == 0)
    {
      const double position = static_cast<double>(added_ + first) - middle;
      c = std::cos(step * position);
      s = std::sin(step * position);
    }
    for (std::size_t i = first; i < last; ++i)
    {
      ProductRow& row = rows[i - first];
      row[0] = 1.0;
      row[1] = c;
      row[2] = s;
      for (std::size_t h = 1; h < harmonics; ++h)
      {
        row[2 * h + 1] = row[2 * h - 1] * c - row[2 * h] * s;
        row[2 * h + 2] = row[2 * h] * c + row[2 * h - 1] * s;
      }
      const double tau = (static_cast<double>(added_ + i) - middle) / half;
      row[columns - 3] = tau * c;
      row[columns - 2] = tau * s;
      row[columns - 1] = samples[i];
      const double next_cos = c * step_cos - s * step_sin;
      s = s * step_cos + c * step_sin;
      c = next_cos;
    }
    addProducts(rows.data(), last - first, columns, sums);
  }
  for (std::size_t k = 0; k < columns; ++k)
  {
    for (std::size_t l = 0; l <= k; ++l)
    {
      gram_[k][l] += sums[k][l];
    }
  }
}

SineFit SineFitter::knownFrequency() const
{
  const Eigen::Map<const Eigen::Matrix<double, most_columns, most_columns, Eigen::RowMajor>> gram(gram_[0].data());
  const Eigen::Index parameters = columns_ - 3;
  const Matrix normal = gram.topLeftCorner(parameters, parameters);
  const Vector right = gram.row(columns_ - 1).head(parameters).transpose();
  const Vector solution = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  return fitOf(frequency_, solution, gram(columns_ - 1, columns_ - 1) - right.dot(solution), added_);
}

SineFit SineFitter::unknownFrequency() const
{
  const SineFit start = knownFrequency();
  const Eigen::Map<const Eigen::Matrix<double, most_columns, most_columns, Eigen::RowMajor>> gram(gram_[0].data());
  const Matrix full = gram.topLeftCorner(columns_, columns_).selfadjointView<Eigen::Lower>();

  // The derivative with respect to the frequency, (B cos - A sin) tau, takes the place of tau cos and tau sin.
  const Eigen::Index parameters = columns_ - 2;
  Matrix choice = Matrix::Zero(columns_, parameters);
  choice.topLeftCorner(parameters - 1, parameters - 1).setIdentity();
  choice(columns_ - 3, parameters - 1) = -start.amplitude * std::sin(start.phase);
  choice(columns_ - 2, parameters - 1) = -start.amplitude * std::cos(start.phase);
  const Matrix normal = choice.transpose() * full * choice;
  const Vector right = choice.transpose() * full.col(columns_ - 1);
  const Vector solution = normal.ldlt().solve(right);

  const double half = std::max(middleOf(count_), 0.5) * sample_period_;
  return fitOf(frequency_ + solution(parameters - 1) / half, solution,
               full(columns_ - 1, columns_ - 1) - right.dot(solution), added_);
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
