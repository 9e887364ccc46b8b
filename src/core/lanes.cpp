#include "lanes.h"

// Packages are built once for the oldest processor. Where GCC can, each of these functions is also compiled for AVX2,
// and the faster one is chosen when the program is loaded.
// The address sanitizer is not there yet when that choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define VIBRO_IMPACT_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define VIBRO_IMPACT_CLONES
#endif

namespace vibro_impact::core
{
namespace
{
// As GCC and Clang offer it: two registers where one is too short.
using Packet = double __attribute__((vector_size(lanes * sizeof(double)), aligned(sizeof(double)), may_alias));

const Packet* packets(const double* numbers)
{
  return reinterpret_cast<const Packet*>(numbers);
}

Packet* packets(double* numbers)
{
  return reinterpret_cast<Packet*>(numbers);
}

double sum(const Packet& packet)
{
  return (packet[0] + packet[2]) + (packet[1] + packet[3]);
}
}  // namespace

VIBRO_IMPACT_CLONES
void growBy(double* __restrict re, double* __restrict im, const double* __restrict factor_re,
            const double* __restrict factor_im, Eigen::Index size)
{
  for (Eigen::Index n = 0; n < size / lanes; ++n)
  {
    const Packet x = packets(re)[n];
    const Packet y = packets(im)[n];
    const Packet f = packets(factor_re)[n];
    const Packet g = packets(factor_im)[n];
    packets(re)[n] = x + (x * f - y * g);
    packets(im)[n] = y + (x * g + y * f);
  }
}

VIBRO_IMPACT_CLONES
void addScaled(double* __restrict x, double factor, const double* __restrict y, Eigen::Index size)
{
  for (Eigen::Index n = 0; n < size / lanes; ++n)
  {
    packets(x)[n] += factor * packets(y)[n];
  }
}

VIBRO_IMPACT_CLONES
double dot(const double* __restrict x, const double* __restrict y, Eigen::Index size)
{
  Packet result{};
  for (Eigen::Index n = 0; n < size / lanes; ++n)
  {
    result += packets(x)[n] * packets(y)[n];
  }
  return sum(result);
}

VIBRO_IMPACT_CLONES
double quadraticForm(const double* __restrict z, const double* __restrict squares, const double* __restrict products,
                     Eigen::Index half)
{
  Packet result{};
  for (Eigen::Index n = 0; n < half / lanes; ++n)
  {
    const Packet x = packets(z)[n];
    const Packet y = packets(z + half)[n];
    result += packets(squares)[n] * x * x + packets(squares + half)[n] * y * y + packets(products)[n] * x * y;
  }
  return sum(result);
}

VIBRO_IMPACT_CLONES
Forms kickGrowEvaluate(double* __restrict z, double* __restrict kicked, double change, const double* __restrict kick,
                       const double* __restrict factor_re, const double* __restrict factor_im,
                       const double* __restrict first, const double* __restrict second, Eigen::Index half)
{
  Packet first_re{};
  Packet first_im{};
  Packet second_re{};
  Packet second_im{};
  for (Eigen::Index n = 0; n < half / lanes; ++n)
  {
    const Packet old_re = packets(z)[n];
    const Packet old_im = packets(z + half)[n];
    packets(kicked)[n] += change * old_re;
    packets(kicked + half)[n] += change * old_im;
    const Packet x = old_re + change * packets(kick)[n];
    const Packet y = old_im + change * packets(kick + half)[n];
    const Packet f = packets(factor_re)[n];
    const Packet g = packets(factor_im)[n];
    const Packet re = x + (x * f - y * g);
    const Packet im = y + (x * g + y * f);
    packets(z)[n] = re;
    packets(z + half)[n] = im;
    first_re += packets(first)[n] * re;
    first_im += packets(first + half)[n] * im;
    second_re += packets(second)[n] * re;
    second_im += packets(second + half)[n] * im;
  }
  first_re += first_im;
  second_re += second_im;
  return Forms{sum(first_re), sum(second_re)};
}

}  // namespace vibro_impact::core
