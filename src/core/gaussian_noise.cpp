#include "gaussian_noise.h"

#include <cmath>

#include "drive_phase.h"

namespace vibro_impact::core
{
namespace
{
constexpr std::uint64_t golden_ratio = 0x9e3779b97f4a7c15u;
constexpr double two_to_minus_53 = 1.0 / 9007199254740992.0;

// The output function of SplitMix64: G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number generators,
// OOPSLA 2014.
std::uint64_t mix(std::uint64_t bits)
{
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return bits ^ (bits >> 31);
}

}  // namespace

GaussianNoise::GaussianNoise(std::uint64_t seed) : key_(mix(seed + golden_ratio))
{
}

// G. E. P. Box, M. E. Muller, A note on the generation of random normal deviates, Ann. Math. Statist. 29 (1958).
void GaussianNoise::generate(std::uint64_t first, std::size_t count, double* values) const
{
  for (std::size_t i = 0; i < count; i += 2)
  {
    const std::uint64_t number = first + i;
    const std::uint64_t radius_bits = mix(key_ + golden_ratio * (number + 1)) >> 11;
    const std::uint64_t angle_bits = mix(key_ + golden_ratio * (number + 2)) >> 11;
    const double radius = std::sqrt(-2.0 * std::log(static_cast<double>(radius_bits + 1) * two_to_minus_53));
    const double angle = two_pi * (static_cast<double>(angle_bits) * two_to_minus_53);
    values[i] = radius * std::cos(angle);
    values[i + 1] = radius * std::sin(angle);
  }
}

}  // namespace vibro_impact::core
