#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "vibro_impact/core/sine_fit.h"

namespace vibro_impact::core
{
// Vectors in the advance of the model have a length that is a multiple of `lanes` (padded with zeros). There is no
// remainder to take care of, and every sum has one order, (l_0 + l_2) + (l_1 + l_3) of the lanes' sums, whatever
// instructions the processor has.

constexpr Eigen::Index lanes = 4;

inline Eigen::Index padded(Eigen::Index size)
{
  return (size + lanes - 1) / lanes * lanes;
}

/// The factors by which exponentials grow in a time, real and imaginary parts apart, `half` of each.
struct Growth
{
  const double* factor_re;  // column k: exp(lambda tick 2^k) - 1; the columns lie one behind the other
  const double* factor_im;
  const double* exponent_re;  // lambda tick
  const double* exponent_im;
  Eigen::Index half;
};

/// Values of three linear forms.
struct Forms
{
  double first, second, third;
};

/// to = from exp(lambda ticks tick) for `tabulated` + `series` ticks, elementwise and complex: by the columns of the
/// bits of `tabulated`, and over `series` ticks, which may be negative, by the first four terms of the series of the
/// exponential function. For the small steps that make up most of a motion the factors less one are small, and the
/// rounding of the whole factor, which would add up, does not arise. Arrays are [real parts; imaginary parts]; `to` may
/// be `from`.
void grow(const Growth& growth, std::uint64_t tabulated, double series, const double* from, double* to);

/// x += factor y
void addScaled(double* x, double factor, const double* y, Eigen::Index size);

double dot(const double* x, const double* y, Eigen::Index size);

/// sum squares x^2 + squares' y^2 + products x y  over z = [x; y] and the squares' coefficients alike, `half` of each.
double quadraticForm(const double* z, const double* squares, const double* products, Eigen::Index half);

/// Both in one: grow, and the forms of `to`.
Forms growEvaluate(const Growth& growth, std::uint64_t tabulated, double series, const double* from,
                   const double* weights, double* to);

struct TwoForms
{
  Forms first, second;
};

/// The same with two sets of weights.
TwoForms growEvaluateTwo(const Growth& growth, std::uint64_t tabulated, double series, const double* from,
                         const double* first, const double* second, double* to);

/// The forms of z whose weights lie one behind the other.
Forms evaluateForms(const double* weights, const double* z, Eigen::Index size);

/// sum w_n (|Re z_n| + |Im z_n|): no less than sum w_n |z_n|, where w >= 0, and no square root.
double weightedSize(const double* weights, const double* z, Eigen::Index half);

/// Three such sums, whose weights lie one behind the other.
Forms weightedSizes(const double* weights, const double* z, Eigen::Index half);

/// to = (from + change kick)(1 + f) with column k of `growth`; the form of `to` that has these weights. All in one
/// pass.
double kickGrowEvaluate(const Growth& growth, int k, const double* from, double change, const double* kick,
                        const double* weights, double* to);

/// A linear drive over equal intervals without a switch: what stays the same,
struct Steady
{
  Growth growth;
  int k;                           // the column of `growth` for one interval
  const double* kick;              // of z per change of the slope
  const double* weights;           // of the gap and, behind them, of its rate
  const double* sag;               // bounds how far the gap is from its chord over an interval, per |z|
  const double* sag_rate;          // the same of its rate
  double kick_sag, kick_sag_rate;  // and per change of the slope
  double line_constant, line_compliance, line_lag;  // the gap's line: constant - compliance a + lag s
  double kick_gap_integral;
  double length, inverse_length;
  double resolution;
  double peak_share;  // a compression of no more than this share of the greatest so far is no peak
};
/// and what moves.
struct SteadyMotion
{
  double* z;      // may change places with
  double* there;  // this one
  double* kicked;
  double start_acceleration, slope;  // of the last interval
  double acceleration, gap;          // now
  double sag;
  double squared_changes, squared_slope;  // sum of the slope's changes squared, integral of its square
  // In contact:
  double rate, sag_rate;                                                  // of the gap
  double compression, compression_time, elapsed, gap_integral, duration;  // of the episode
};

/// Advances by as many of the `count` intervals, at whose ends the drive has these accelerations, as the chord of the
/// gap shows to be without contact; writes the gap at the end of each, and returns their number.
std::size_t advanceOpen(const Steady& constants, SteadyMotion& motion, const double* acceleration, std::size_t count,
                        double* gap);

/// The same in contact throughout, and while the chord of the rate shows that no peak is inside an interval.
std::size_t advanceClosed(const Steady& constants, SteadyMotion& motion, const double* acceleration, std::size_t count,
                          double* gap);

/// What makes coordinates of exponentials and back: columns of `rows` (padded), one behind the other,
///
///   standing, compliance, lag, decay, damped frequency and what divides by it, real and imaginary part of the transfer
///
/// and where the drive stands.
struct Conversion
{
  const double* columns;
  Eigen::Index rows;
  double acceleration, slope;                  // of the linear drive
  double drive_re, drive_im, drive_frequency;  // of the harmonic one
};

/// eta = standing - compliance a + lag s + Re z + Re H D,  eta' = -compliance s + Re lambda z + Re i Omega H D
void toCoordinates(const Conversion& conversion, const double* re, const double* im, double* displacement,
                   double* velocity);

/// The same the other way round.
void toExponentials(const Conversion& conversion, const double* displacement, const double* velocity, double* re,
                    double* im);

/// Four linear forms of z, whose weights lie one behind the other.
std::array<double, 4> evaluateFourForms(const double* weights, const double* z, Eigen::Index size);

/// Two vectors at once multiplied by one matrix of `rows` (padded) and `columns`:  x_to = A x, y_to = A y.
void multiplyTwo(const double* matrix, Eigen::Index rows, Eigen::Index columns, const double* x, const double* y,
                 double* x_to, double* y_to);

/// Adds the sums of `count` samples from the position `first` on, `step` in rad.
void addSineSums(const double* samples, std::size_t count, double step, double first, SineSums& sums);

}  // namespace vibro_impact::core
