#include "lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// Packages are built once for the oldest processor. Where GCC can, each of these functions is also compiled for AVX2,
// and the faster one is chosen when the program is loaded.
// The address sanitizer is not there yet when that choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define VIBRO_IMPACT_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define VIBRO_IMPACT_CLONES
#endif
// So that they are compiled as the clone is that calls them.
#define VIBRO_IMPACT_INLINE __attribute__((always_inline)) inline

namespace vibro_impact::core
{
namespace
{
// As GCC and Clang offer it: two registers where one is too short.
using Packet __attribute__((aligned(sizeof(double)), may_alias)) =
    double __attribute__((vector_size(lanes * sizeof(double))));
static_assert(alignof(Packet) == alignof(double), "packets lie wherever numbers do");

const Packet* packets(const double* numbers)
{
  return reinterpret_cast<const Packet*>(numbers);
}

Packet* packets(double* numbers)
{
  return reinterpret_cast<Packet*>(numbers);
}

VIBRO_IMPACT_INLINE double sum(const Packet& packet)
{
  return (packet[0] + packet[2]) + (packet[1] + packet[3]);
}

/// sum += weights (|x| + |y|)
VIBRO_IMPACT_INLINE void addSizes(Packet& sum, const Packet& weights, const Packet& x, const Packet& y)
{
  using Bits = std::int64_t __attribute__((vector_size(lanes * sizeof(double))));
  constexpr std::int64_t magnitude = std::numeric_limits<std::int64_t>::max();  // all bits but the sign
  sum += weights * (Packet(Bits(x) & magnitude) + Packet(Bits(y) & magnitude));
}

/// The sums of SineSums, `lanes` of each side by side.
struct SinePackets
{
  Packet sum{}, squares{}, cosine[3]{}, sine[3]{}, moment_cosine{}, moment_sine{};
};

/// Adds samples y at the positions n, where c and s are cos(step n) and sin(step n).
VIBRO_IMPACT_INLINE void add(SinePackets& sums, const Packet& y, const Packet& n, const Packet& c, const Packet& s)
{
  const Packet y_cos = y * c;
  const Packet y_sin = y * s;
  const Packet cos_two = c * c - s * s;
  const Packet sin_two = 2.0 * c * s;
  sums.sum += y;
  sums.squares += y * y;
  sums.cosine[0] += y_cos;
  sums.sine[0] += y_sin;
  sums.cosine[1] += y * cos_two;
  sums.sine[1] += y * sin_two;
  sums.cosine[2] += y_cos * cos_two - y_sin * sin_two;
  sums.sine[2] += y_sin * cos_two + y_cos * sin_two;
  sums.moment_cosine += n * y_cos;
  sums.moment_sine += n * y_sin;
}

/// `count` packets of exponentials from n on, side by side in registers: each waits for its own last product only.
template <int count>
VIBRO_IMPACT_INLINE void growPackets(const Growth& growth, std::uint64_t tabulated, double series, const double* from,
                                     double* to, Eigen::Index n)
{
  const Eigen::Index half = growth.half;
  Packet re[count];
  Packet im[count];
  for (int i = 0; i < count; ++i)
  {
    re[i] = *packets(from + n + i * lanes);
    im[i] = *packets(from + half + n + i * lanes);
  }
  for (std::uint64_t rest = tabulated; rest != 0; rest &= rest - 1)
  {
    const Eigen::Index column = half * __builtin_ctzll(rest) + n;
    const double* factor_re = growth.factor_re + column;
    const double* factor_im = growth.factor_im + column;
    for (int i = 0; i < count; ++i)
    {
      const Packet f = *packets(factor_re + i * lanes);
      const Packet g = *packets(factor_im + i * lanes);
      const Packet before = re[i];
      re[i] += before * f - im[i] * g;
      im[i] += before * g + im[i] * f;
    }
  }
  if (series != 0.0)
  {
    for (int i = 0; i < count; ++i)
    {
      // z + e (z + e/2 (z + e/3 (z + e/4 z)))
      const Packet f = series * *packets(growth.exponent_re + n + i * lanes);
      const Packet g = series * *packets(growth.exponent_im + n + i * lanes);
      Packet u = re[i];
      Packet v = im[i];
      for (const double share : {0.25, 1.0 / 3.0, 0.5, 1.0})
      {
        const Packet before = u;
        u = re[i] + share * (u * f - v * g);
        v = im[i] + share * (before * g + v * f);
      }
      re[i] = u;
      im[i] = v;
    }
  }
  for (int i = 0; i < count; ++i)
  {
    *packets(to + n + i * lanes) = re[i];
    *packets(to + half + n + i * lanes) = im[i];
  }
}

VIBRO_IMPACT_INLINE void growAll(const Growth& growth, std::uint64_t tabulated, double series, const double* from,
                                 double* to)
{
  Eigen::Index n = 0;
  for (; n + 3 * lanes <= growth.half; n += 3 * lanes)
  {
    growPackets<3>(growth, tabulated, series, from, to, n);
  }
  for (; n < growth.half; n += lanes)
  {
    growPackets<1>(growth, tabulated, series, from, to, n);
  }
}

VIBRO_IMPACT_INLINE double formOf(const double* weights, const double* z, Eigen::Index size)
{
  Packet result{};
  for (Eigen::Index n = 0; n < size; n += lanes)
  {
    result += *packets(weights + n) * *packets(z + n);
  }
  return sum(result);
}

/// sum w_n (|Re z_n| + |Im z_n|)
VIBRO_IMPACT_INLINE double sizeOf(const double* weights, const double* z, Eigen::Index half)
{
  Packet size{};
  for (Eigen::Index n = 0; n < half; n += lanes)
  {
    addSizes(size, *packets(weights + n), *packets(z + n), *packets(z + half + n));
  }
  return sum(size);
}

VIBRO_IMPACT_INLINE double kickGrowForm(const Growth& growth, int k, const double* from, double change,
                                        const double* kick, const double* weights, double* to)
{
  const Eigen::Index half = growth.half;
  const double* factor_re = growth.factor_re + half * k;
  const double* factor_im = growth.factor_im + half * k;
  Packet form{};
  for (Eigen::Index n = 0; n < half; n += lanes)
  {
    const Packet x = *packets(from + n) + change * *packets(kick + n);
    const Packet y = *packets(from + half + n) + change * *packets(kick + half + n);
    const Packet f = *packets(factor_re + n);
    const Packet g = *packets(factor_im + n);
    const Packet re = x + (x * f - y * g);
    const Packet im = y + (x * g + y * f);
    *packets(to + n) = re;
    *packets(to + half + n) = im;
    form += *packets(weights + n) * re + *packets(weights + half + n) * im;
  }
  return sum(form);
}

/// Whether `bound` is below `limit`; if not, whether that renewed by the weighted size of z is: damping may have made
/// it less.
VIBRO_IMPACT_INLINE bool isBelow(double limit, double& bound, double added, const double* weights, const double* z,
                                 Eigen::Index half)
{
  if (bound + added < limit)
  {
    return true;
  }
  bound = sizeOf(weights, z, half);
  return bound + added < limit;
}

template <bool closed>
VIBRO_IMPACT_INLINE std::size_t advanceSteadily(const Steady& constants, SteadyMotion& motion,
                                                const double* acceleration, std::size_t count, double* gap)
{
  const Steady c = constants;
  SteadyMotion m = motion;
  const Eigen::Index half = c.growth.half;
  constexpr double side = closed ? -1.0 : 1.0;
  std::size_t done = 0;
  for (; done < count; ++done)
  {
    const double slope = (acceleration[done] - m.acceleration) * c.inverse_length;
    const double change = slope - m.slope;
    const double form = kickGrowForm(c.growth, c.k, m.z, change, c.kick, c.weights, m.there);
    const double line_start = c.line_constant - c.line_compliance * m.acceleration + c.line_lag * slope;
    const double line_slope = -c.line_compliance * slope;
    const double after = line_start + line_slope * c.length + form;
    const double sag_added = std::abs(change) * c.kick_sag;
    if (!isBelow(std::min(side * m.gap, side * after) - c.resolution, m.sag, sag_added, c.sag, m.z, half))
    {
      break;
    }
    if (closed)
    {
      const double rate = line_slope + formOf(c.weights + 2 * half, m.there, 2 * half);
      const double sag_rate_added = std::abs(change) * c.kick_sag_rate;
      const double least_peak = std::max(m.compression * c.peak_share, c.resolution);
      if (std::max(-m.gap, -after) + m.sag + sag_added > least_peak)
      {
        const double slowest = m.rate * rate > 0.0 ? std::min(std::abs(m.rate), std::abs(rate)) : 0.0;
        if (!isBelow(slowest, m.sag_rate, sag_rate_added, c.sag_rate, m.z, half))
        {
          break;
        }
      }
      m.sag_rate += sag_rate_added;
      m.rate = rate;
      m.elapsed += c.length;
      m.duration += c.length;
      m.gap_integral += c.length * (c.line_constant - c.line_compliance * 0.5 * (m.acceleration + acceleration[done]) +
                                    c.line_lag * slope) -
                        change * c.kick_gap_integral;
      if (-after > m.compression)
      {
        m.compression = -after;
        m.compression_time = m.elapsed;
      }
    }
    m.sag += sag_added;
    for (Eigen::Index n = 0; n < 2 * half; n += lanes)
    {
      *packets(m.kicked + n) += change * *packets(m.z + n);
    }
    m.squared_changes += change * change;
    m.squared_slope += m.slope * m.slope * c.length;
    std::swap(m.z, m.there);
    m.start_acceleration = m.acceleration;
    m.acceleration = acceleration[done];
    m.slope = slope;
    m.gap = after;
    gap[done] = after;
  }
  motion = m;
  return done;
}

/// What of displacement and velocity is not in the exponentials of the modes.
struct Forced
{
  Packet displacement, velocity;
};

VIBRO_IMPACT_INLINE Forced forcedAt(const Conversion& conversion, Eigen::Index n)
{
  const Eigen::Index rows = conversion.rows;
  const double* column = conversion.columns + n;
  const Packet standing = *packets(column);
  const Packet compliance = *packets(column + rows);
  const Packet lag = *packets(column + 2 * rows);
  const Packet transfer_re = *packets(column + 6 * rows);
  const Packet transfer_im = *packets(column + 7 * rows);
  return Forced{standing - compliance * conversion.acceleration + lag * conversion.slope +
                    (transfer_re * conversion.drive_re - transfer_im * conversion.drive_im),
                -compliance * conversion.slope - conversion.drive_frequency * (transfer_im * conversion.drive_re +
                                                                               transfer_re * conversion.drive_im)};
}

VIBRO_IMPACT_INLINE Forms formsOf(const double* weights, const double* z, Eigen::Index size)
{
  Packet first{};
  Packet second{};
  Packet third{};
  for (Eigen::Index n = 0; n < size; n += lanes)
  {
    const Packet x = *packets(z + n);
    first += *packets(weights + n) * x;
    second += *packets(weights + size + n) * x;
    third += *packets(weights + 2 * size + n) * x;
  }
  return Forms{sum(first), sum(second), sum(third)};
}
}  // namespace

VIBRO_IMPACT_CLONES
void grow(const Growth& growth, std::uint64_t tabulated, double series, const double* from, double* to)
{
  growAll(growth, tabulated, series, from, to);
}

VIBRO_IMPACT_CLONES
Forms growEvaluate(const Growth& growth, std::uint64_t tabulated, double series, const double* from,
                   const double* weights, double* to)
{
  growAll(growth, tabulated, series, from, to);
  return formsOf(weights, to, 2 * growth.half);
}

VIBRO_IMPACT_CLONES
TwoForms growEvaluateTwo(const Growth& growth, std::uint64_t tabulated, double series, const double* from,
                         const double* first, const double* second, double* to)
{
  growAll(growth, tabulated, series, from, to);
  return TwoForms{formsOf(first, to, 2 * growth.half), formsOf(second, to, 2 * growth.half)};
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
double dot(const double* x, const double* y, Eigen::Index size)
{
  return formOf(x, y, size);
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
Forms evaluateForms(const double* weights, const double* z, Eigen::Index size)
{
  return formsOf(weights, z, size);
}

VIBRO_IMPACT_CLONES
double weightedSize(const double* weights, const double* z, Eigen::Index half)
{
  return sizeOf(weights, z, half);
}

VIBRO_IMPACT_CLONES
Forms weightedSizes(const double* weights, const double* z, Eigen::Index half)
{
  Packet first{};
  Packet second{};
  Packet third{};
  for (Eigen::Index n = 0; n < half; n += lanes)
  {
    const Packet x = *packets(z + n);
    const Packet y = *packets(z + half + n);
    addSizes(first, *packets(weights + n), x, y);
    addSizes(second, *packets(weights + half + n), x, y);
    addSizes(third, *packets(weights + 2 * half + n), x, y);
  }
  return Forms{sum(first), sum(second), sum(third)};
}

VIBRO_IMPACT_CLONES
double kickGrowEvaluate(const Growth& growth, int k, const double* from, double change, const double* kick,
                        const double* weights, double* to)
{
  return kickGrowForm(growth, k, from, change, kick, weights, to);
}

VIBRO_IMPACT_CLONES
std::size_t advanceOpen(const Steady& constants, SteadyMotion& motion, const double* acceleration, std::size_t count,
                        double* gap)
{
  return advanceSteadily<false>(constants, motion, acceleration, count, gap);
}

VIBRO_IMPACT_CLONES
std::size_t advanceClosed(const Steady& constants, SteadyMotion& motion, const double* acceleration, std::size_t count,
                          double* gap)
{
  return advanceSteadily<true>(constants, motion, acceleration, count, gap);
}

VIBRO_IMPACT_CLONES
void toCoordinates(const Conversion& conversion, const double* re, const double* im, double* displacement,
                   double* velocity)
{
  const Eigen::Index rows = conversion.rows;
  for (Eigen::Index n = 0; n < rows; n += lanes)
  {
    const Forced forced = forcedAt(conversion, n);
    const Packet decay = *packets(conversion.columns + 3 * rows + n);
    const Packet damped = *packets(conversion.columns + 4 * rows + n);
    const Packet x = *packets(re + n);
    const Packet y = *packets(im + n);
    *packets(displacement + n) = forced.displacement + x;
    *packets(velocity + n) = forced.velocity - decay * x - damped * y;
  }
}

VIBRO_IMPACT_CLONES
void toExponentials(const Conversion& conversion, const double* displacement, const double* velocity, double* re,
                    double* im)
{
  const Eigen::Index rows = conversion.rows;
  for (Eigen::Index n = 0; n < rows; n += lanes)
  {
    const Forced forced = forcedAt(conversion, n);
    const Packet decay = *packets(conversion.columns + 3 * rows + n);
    const Packet over_damped = *packets(conversion.columns + 5 * rows + n);
    const Packet x = *packets(displacement + n) - forced.displacement;
    const Packet rate = *packets(velocity + n) - forced.velocity;
    *packets(re + n) = x;
    *packets(im + n) = -(rate + decay * x) * over_damped;
  }
}

VIBRO_IMPACT_CLONES
std::array<double, 4> evaluateFourForms(const double* weights, const double* z, Eigen::Index size)
{
  Packet forms[4]{};
  for (Eigen::Index n = 0; n < size; n += lanes)
  {
    const Packet x = *packets(z + n);
    forms[0] += *packets(weights + n) * x;
    forms[1] += *packets(weights + size + n) * x;
    forms[2] += *packets(weights + 2 * size + n) * x;
    forms[3] += *packets(weights + 3 * size + n) * x;
  }
  return {sum(forms[0]), sum(forms[1]), sum(forms[2]), sum(forms[3])};
}

VIBRO_IMPACT_CLONES
void multiplyTwo(const double* matrix, Eigen::Index rows, Eigen::Index columns, const double* x, const double* y,
                 double* x_to, double* y_to)
{
  for (Eigen::Index row = 0; row < rows; row += lanes)
  {
    Packet x_sum{};
    Packet y_sum{};
    for (Eigen::Index column = 0; column < columns; ++column)
    {
      const Packet entries = *packets(matrix + rows * column + row);
      x_sum += x[column] * entries;
      y_sum += y[column] * entries;
    }
    *packets(x_to + row) = x_sum;
    *packets(y_to + row) = y_sum;
  }
}

VIBRO_IMPACT_CLONES
void addSineSums(const double* samples, std::size_t count, double step, double first, SineSums& sums)
{
  // Samples after which the rotation is computed anew, before its rounding errors add up.
  constexpr std::size_t renewal = 256;
  static_assert(renewal % lanes == 0, "only the last packet of all is not full");
  constexpr std::size_t width = lanes;
  const double step_cos = std::cos(step);
  const double step_sin = std::sin(step);
  const double ahead_cos = std::cos(step * static_cast<double>(width));
  const double ahead_sin = std::sin(step * static_cast<double>(width));
  SinePackets lanes_sums{};
  Packet n{};
  Packet c{};
  Packet s{};
  for (std::size_t i = 0; i < count; i += width)
  {
    if (i % renewal == 0)
    {
      const double position = first + static_cast<double>(i);
      n[0] = position;
      c[0] = std::cos(step * position);
      s[0] = std::sin(step * position);
      for (std::size_t lane = 1; lane < width; ++lane)
      {
        n[lane] = position + static_cast<double>(lane);
        c[lane] = c[lane - 1] * step_cos - s[lane - 1] * step_sin;
        s[lane] = s[lane - 1] * step_cos + c[lane - 1] * step_sin;
      }
    }
    Packet y{};
    if (count - i >= width)
    {
      y = *packets(samples + i);
    }
    else
    {
      for (std::size_t lane = 0; lane < count - i; ++lane)
      {
        y[lane] = samples[i + lane];
      }
    }
    add(lanes_sums, y, n, c, s);
    n += static_cast<double>(width);
    const Packet ahead = c * ahead_cos - s * ahead_sin;
    s = s * ahead_cos + c * ahead_sin;
    c = ahead;
  }
  sums.sum += sum(lanes_sums.sum);
  sums.squares += sum(lanes_sums.squares);
  for (std::size_t h = 0; h < 3; ++h)
  {
    sums.cosine[h] += sum(lanes_sums.cosine[h]);
    sums.sine[h] += sum(lanes_sums.sine[h]);
  }
  sums.moment_cosine += sum(lanes_sums.moment_cosine);
  sums.moment_sine += sum(lanes_sums.moment_sine);
}

}  // namespace vibro_impact::core
