#pragma once

#include <cstring>

#include <Eigen/Core>

namespace vibro_impact::core
{
// Vectors in the advance of the model have a length that is a multiple of `lanes` (padded with zeros) and are worked on
// in packets of two, the vector of every 64-bit processor, as GCC and Clang offer it. There is no remainder to take
// care of, and every sum has one order, whatever instructions the compiler chooses.

constexpr Eigen::Index lanes = 4;

inline Eigen::Index padded(Eigen::Index size)
{
  return (size + lanes - 1) / lanes * lanes;
}

constexpr Eigen::Index packet_size = 2;
using Packet = double __attribute__((vector_size(packet_size * sizeof(double))));

inline Packet load(const double* from)
{
  Packet packet;
  std::memcpy(&packet, from, sizeof(Packet));
  return packet;
}

inline void store(double* to, Packet packet)
{
  std::memcpy(to, &packet, sizeof(Packet));
}

inline Packet broadcast(double value)
{
  return Packet{value, value};
}

inline double sum(Packet packet)
{
  return packet[0] + packet[1];
}

/// z += z f, elementwise and complex, in place; real and imaginary parts apart. For the small steps that make up most
/// of a motion f is small, and the rounding of the factor 1 + f, which would add up, does not arise.
inline void growBy(double* __restrict re, double* __restrict im, const double* __restrict factor_re,
                   const double* __restrict factor_im, Eigen::Index size)
{
  for (Eigen::Index n = 0; n < size; n += packet_size)
  {
    const Packet x = load(re + n);
    const Packet y = load(im + n);
    const Packet f = load(factor_re + n);
    const Packet g = load(factor_im + n);
    store(re + n, x + (x * f - y * g));
    store(im + n, y + (x * g + y * f));
  }
}

/// x += factor y
inline void addScaled(double* __restrict x, double factor, const double* __restrict y, Eigen::Index size)
{
  const Packet scale = broadcast(factor);
  for (Eigen::Index n = 0; n < size; n += packet_size)
  {
    store(x + n, load(x + n) + scale * load(y + n));
  }
}

inline double dot(const double* __restrict x, const double* __restrict y, Eigen::Index size)
{
  Packet even{};
  Packet odd{};
  for (Eigen::Index n = 0; n < size; n += lanes)
  {
    even += load(x + n) * load(y + n);
    odd += load(x + n + packet_size) * load(y + n + packet_size);
  }
  return sum(even + odd);
}

/// z = (z + change kick)(1 + f), and of the new z the two linear forms `first` and `second`, all in one pass; every
/// array but the factors is [real parts; imaginary parts] with `half` of each.
inline void kickGrowEvaluate(double* __restrict z, double change, const double* __restrict kick,
                             const double* __restrict factor_re, const double* __restrict factor_im,
                             const double* __restrict first, const double* __restrict second, Eigen::Index half,
                             double& first_value, double& second_value)
{
  const Packet scale = broadcast(change);
  Packet first_re{};
  Packet first_im{};
  Packet second_re{};
  Packet second_im{};
  for (Eigen::Index n = 0; n < half; n += packet_size)
  {
    const Eigen::Index m = half + n;
    const Packet x = load(z + n) + scale * load(kick + n);
    const Packet y = load(z + m) + scale * load(kick + m);
    const Packet f = load(factor_re + n);
    const Packet g = load(factor_im + n);
    const Packet re = x + (x * f - y * g);
    const Packet im = y + (x * g + y * f);
    store(z + n, re);
    store(z + m, im);
    first_re += load(first + n) * re;
    first_im += load(first + m) * im;
    second_re += load(second + n) * re;
    second_im += load(second + m) * im;
  }
  first_value = sum(first_re + first_im);
  second_value = sum(second_re + second_im);
}

}  // namespace vibro_impact::core
