#pragma once

#include <cstddef>
#include <cstdint>

namespace vibro_impact::core
{
/// White noise of independent, normally distributed values of mean 0 and variance 1, each a function of its number and
/// the seed alone: the same on every machine, but for the last digits of its logarithm and cosine.
class GaussianNoise
{
public:
  explicit GaussianNoise(std::uint64_t seed);

  /// Writes `count` values, both `first` and `count` even.
  void generate(std::uint64_t first, std::size_t count, double* values) const;

private:
  std::uint64_t key_;
};

}  // namespace vibro_impact::core
