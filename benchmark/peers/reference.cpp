#include "reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace vibro_impact::peers
{
namespace
{
/// Below this share of the terms it is summed from, a derivative at the start is rounding of the modal data.
constexpr long double cancelled = 1.0e-12L;
constexpr int highest_derivative = 8;
/// Steps shorter than this end the search for a root; Newton's method does the rest.
constexpr long double shortest_step = 1.0e-11L;

/// The z with Re z = displacement and Re(lambda z) = velocity.
std::complex<long double> amplitude(std::complex<long double> lambda, long double displacement, long double velocity)
{
  return {displacement, (lambda.real() * displacement - velocity) / lambda.imag()};
}
}  // namespace

Reference::Reference(const Problem& problem, double end, double disturbance)
    : mapping_(problem.mapping), drive_frequency_(problem.drive_frequency), disturbance_(disturbance)
{
  for (int s = 0; s < 2; ++s)
  {
    const State& state = problem.states[static_cast<std::size_t>(s)];
    Terms& terms = terms_[s];
    for (Eigen::Index n = 0; n < state.size(); ++n)
    {
      const Real stiffness = state.stiffness(n);
      const Real decay = 0.5L * state.damping(n);
      terms.lambda.emplace_back(-decay, std::sqrt(stiffness - decay * decay));
      terms.deflection.push_back(state.deflection(n));
      terms.transfer.push_back(Real(state.load(n)) / Complex(stiffness - drive_frequency_ * drive_frequency_,
                                                             state.damping(n) * drive_frequency_));
      terms.gap_transfer += terms.deflection.back() * terms.transfer.back();
    }
  }

  // At rest gap and rate are zero, and here the acceleration, too: the first derivative that is not zero decides.
  const auto atRest = [&](int state)
  {
    Segment rest{0.0L, state, {}};
    const Complex drive = driveTerm(0.0L);
    for (std::size_t n = 0; n < terms_[state].lambda.size(); ++n)
    {
      const Complex forced = terms_[state].transfer[n] * drive;
      rest.amplitude.push_back(amplitude(terms_[state].lambda[n], -forced.real(), drive_frequency_ * forced.imag()));
    }
    return rest;
  };
  Segment segment = atRest(0);
  Real time = 0.0L;
  for (int state = 0; state < 2 && time == 0.0L; ++state)
  {
    segment = atRest(state);
    int order = 2;
    while (order < highest_derivative &&
           std::abs(derivative(segment, 0.0L, order)) <= cancelled * bound(segment, 0.0L, order))
    {
      ++order;
    }
    const Real leading = (state == 0 ? 1.0L : -1.0L) * derivative(segment, 0.0L, order);
    if (leading > 0.0L)
    {
      time = Real(order + 1) * leading / (2.0L * bound(segment, 0.0L, order + 1));
    }
  }
  if (time == 0.0L)
  {
    throw std::runtime_error("the state in which the motion starts is not defined");
  }

  while (time < Real(end))
  {
    const Real side = segment.state == 0 ? 1.0L : -1.0L;
    const Real gap = side * derivative(segment, time, 0);
    const Real rate = side * derivative(segment, time, 1);
    const Real curvature = bound(segment, time, 2);
    greatest_gap_ = std::max(greatest_gap_, static_cast<double>(std::abs(gap)));
    const Real root = std::sqrt(std::max(0.0L, rate * rate + 2.0L * gap * curvature));
    const Real step = rate >= 0.0L ? (rate + root) / curvature : 2.0L * gap / (root - rate);
    if (step < shortest_step && rate < 0.0L)
    {
      time -= gap / rate;
      segments_.push_back(segment);
      switches_.push_back(static_cast<double>(time));
      segment = switched(segment, time);
    }
    else
    {
      time += std::max(step, shortest_step);
    }
  }
  segments_.push_back(segment);
}

Reference::Complex Reference::driveTerm(Real time) const
{
  return std::polar(Real(1), drive_frequency_ * time);
}

Reference::Real Reference::derivative(const Segment& segment, Real time, int order) const
{
  const Terms& terms = terms_[segment.state];
  const Real elapsed = time - segment.start;
  Complex sum = terms.gap_transfer * driveTerm(time) * std::pow(Complex(0.0L, drive_frequency_), order);
  for (std::size_t n = 0; n < terms.lambda.size(); ++n)
  {
    Complex factor = std::exp(terms.lambda[n] * elapsed);
    for (int i = 0; i < order; ++i)
    {
      factor *= terms.lambda[n];
    }
    sum += terms.deflection[n] * segment.amplitude[n] * factor;
  }
  return sum.real();
}

Reference::Real Reference::bound(const Segment& segment, Real time, int order) const
{
  const Terms& terms = terms_[segment.state];
  const Real elapsed = time - segment.start;
  Real sum = std::abs(terms.gap_transfer) * std::pow(drive_frequency_, Real(order));
  for (std::size_t n = 0; n < terms.lambda.size(); ++n)
  {
    sum += std::abs(terms.deflection[n]) * std::abs(segment.amplitude[n]) * std::exp(terms.lambda[n].real() * elapsed) *
           std::pow(std::abs(terms.lambda[n]), Real(order));
  }
  return sum;
}

Reference::Segment Reference::switched(const Segment& segment, Real time) const
{
  const Terms& from = terms_[segment.state];
  const Terms& to = terms_[1 - segment.state];
  const Complex drive = driveTerm(time);
  const std::size_t size = from.lambda.size();
  std::vector<Real> displacement(size);
  std::vector<Real> velocity(size);
  for (std::size_t n = 0; n < size; ++n)
  {
    const Complex z = segment.amplitude[n] * std::exp(from.lambda[n] * (time - segment.start));
    const Complex forced = from.transfer[n] * drive;
    displacement[n] = (z.real() + forced.real()) * (1.0L + disturbance_);
    velocity[n] = (from.lambda[n] * z).real() - drive_frequency_ * forced.imag();
  }
  Segment next{time, 1 - segment.state, {}};
  for (std::size_t n = 0; n < size; ++n)
  {
    Real x = 0.0L;
    Real v = 0.0L;
    for (std::size_t m = 0; m < size; ++m)
    {
      const auto row = static_cast<Eigen::Index>(segment.state == 0 ? m : n);
      const auto column = static_cast<Eigen::Index>(segment.state == 0 ? n : m);
      x += Real(mapping_(row, column)) * displacement[m];
      v += Real(mapping_(row, column)) * velocity[m];
    }
    const Complex forced = to.transfer[n] * drive;
    next.amplitude.push_back(amplitude(to.lambda[n], x - forced.real(), v + drive_frequency_ * forced.imag()));
  }
  return next;
}

double Reference::gap(double time) const
{
  auto after = std::upper_bound(segments_.begin(), segments_.end(), Real(time),
                                [](Real t, const Segment& segment) { return t < segment.start; });
  const Segment& segment = after == segments_.begin() ? segments_.front() : *(after - 1);
  const Terms& terms = terms_[segment.state];
  const double elapsed = static_cast<double>(Real(time) - segment.start);
  // In double from the last switch on: that is all a comparison needs, and four times as fast.
  std::complex<double> sum =
      std::complex<double>(terms.gap_transfer) * std::polar(1.0, static_cast<double>(drive_frequency_) * time);
  for (std::size_t n = 0; n < terms.lambda.size(); ++n)
  {
    sum += static_cast<double>(terms.deflection[n]) * std::complex<double>(segment.amplitude[n]) *
           std::exp(std::complex<double>(terms.lambda[n]) * elapsed);
  }
  return sum.real();
}
}  // namespace vibro_impact::peers
