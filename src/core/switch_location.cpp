// Of SwitchedMotion: where the motion changes its state.

#include <array>
#include <cmath>
#include <limits>

#include "switched_motion.h"
#include "tick_bits.h"

namespace vibro_impact::core
{
namespace
{
/// Derivatives of the gap below this share of the terms they are summed from are rounding, and taken for zero.
constexpr double derivative_rounding = 1.0e-9;

/// The earliest time (s, or infinite) at which a quantity >= 0 can be zero that has this rate now, and a second
/// derivative within +-bound from now on.
double earliestZero(double value, double rate, double bound)
{
  if (bound == 0.0)
  {
    return rate < 0.0 ? -value / rate : std::numeric_limits<double>::infinity();
  }
  const double root = std::sqrt(rate * rate + 2.0 * value * bound);
  return rate >= 0.0 ? (rate + root) / bound : 2.0 * value / (root - rate);
}

/// The first time at which the parabola of this moment, with a value >= 0 and a rate < 0, is zero; infinite if it never
/// is.
double firstZero(double value, double rate, double acceleration)
{
  const double discriminant = rate * rate - 2.0 * value * acceleration;
  return discriminant >= 0.0 ? 2.0 * value / (std::sqrt(discriminant) - rate) : std::numeric_limits<double>::infinity();
}
}  // namespace

void SwitchedMotion::move(const Eigen::VectorXd& from, std::int64_t ticks, Eigen::VectorXd& to) const
{
  const auto [tabulated, series] = split(ticks);
  grow(now().growth(), tabulated, series, from.data(), to.data());
}

Moment SwitchedMotion::move(const Eigen::VectorXd& from, std::int64_t ticks, double time, Eigen::VectorXd& to) const
{
  const auto [tabulated, series] = split(ticks);
  return distance(
      growEvaluate(now().growth(), tabulated, series, from.data(), now().derivative.col(1).data(), to.data()), time);
}

Moment SwitchedMotion::distance(const Eigen::VectorXd& exponentials, double time) const
{
  const Eigen::Index size = exponentials.size();
  return distance(evaluateForms(now().derivative.data() + size, exponentials.data(), size), time);
}

double SwitchedMotion::derivative(int order) const
{
  const StateTables& t = now();
  const double body = order == 2 ? -t.body_pull * acceleration(time_) : order == 3 ? -t.body_pull * slope_ : 0.0;
  return body + t.derivative.col(order + 1).dot(vectors().exponentials);
}

double SwitchedMotion::boundOfDerivative(int order) const
{
  const Eigen::VectorXd& z = vectors().exponentials;
  return weightedSize(now().magnitude.col(order).data(), z.data(), z.size() / 2);
}

const Spread& SwitchedMotion::spread(int k)
{
  Vectors& v = vectors();
  k = std::max(k, grid_.shortest_stride);
  const std::uint64_t bit = std::uint64_t{1} << k;
  Spread& spread = v.spreads[static_cast<std::size_t>(k)];
  if ((v.known_spreads & bit) == 0)
  {
    const StateTables& t = now();
    spread = Spread{weightedSize(t.bulgeWeights(k), v.exponentials.data(), t.half), 0.0, 0.0, 0.0};
    if (t.hasFlat(k))
    {
      const Forms flat = weightedSizes(t.flatWeights(k), v.exponentials.data(), t.half);
      spread.flat = flat.first;
      spread.flat_rate = flat.second;
      spread.flat_acceleration = flat.third;
    }
    v.known_spreads |= bit;
  }
  return spread;
}

const Spread& SwitchedMotion::slowSpread(int k)
{
  if (!now().leavesOut(k))
  {
    return spread(k);
  }
  Vectors& v = vectors();
  const std::uint64_t bit = std::uint64_t{1} << k;
  Spread& spread = v.slow_spreads[static_cast<std::size_t>(k)];
  if ((v.known_slow_spreads & bit) == 0)
  {
    const StateTables& t = now();
    spread.bulge = weightedSize(t.slowBulgeWeights(k), v.exponentials.data(), t.half);
    const Forms flat = weightedSizes(t.slowFlatWeights(k), v.exponentials.data(), t.half);
    spread.flat = flat.first;
    spread.flat_rate = flat.second;
    v.known_slow_spreads |= bit;
  }
  return spread;
}

double SwitchedMotion::thirdBound()
{
  Vectors& v = vectors();
  if (v.third_bound < 0.0)
  {
    v.third_bound = boundOfDerivative(3) + bodyBound(3);
  }
  return v.third_bound;
}

void SwitchedMotion::refreshResolution()
{
  const StateTables& t = now();
  double terms = std::abs(model_->clearance()) + std::abs(t.line_constant) + std::abs(t.line_compliance) * farthest_ +
                 std::abs(t.line_lag * slope_) + boundOfDerivative(0);
  if (t.gap_body >= 0)
  {
    const Eigen::VectorXd& z = vectors().exponentials;
    const double left = grid_.length - body_time_;
    terms += std::abs(t.body_deflection) * (std::abs(z(t.gap_body)) + left * std::abs(z(z.size() / 2 + t.gap_body))) +
             0.5 * left * left * bodyBound(2);
  }
  resolution_ = gap_rounding * terms;
}

/// One long step, if what is known at both its ends shows that there is no switch in it; else one that ends shortly
/// before the first. Returns its ticks, or 0 where nothing can be shown.
std::int64_t SwitchedMotion::stride(std::int64_t left, double time)
{
  Vectors& v = vectors();
  Moment from = distance();
  if (from.value < -resolution_ || (from.value <= resolution_ && from.rate <= 0.0))
  {
    return 0;
  }
  from.value = std::max(0.0, from.value);
  constexpr int attempts = 4;
  for (int attempt = 0; attempt < attempts; ++attempt)
  {
    const std::int64_t whole = std::int64_t{1} << v.stride;
    const std::int64_t ticks = std::min(whole, left);
    const double width = static_cast<double>(ticks) * grid_.tick;
    ++steps_total_;
    const int k = std::max(grid_.shortest_stride, ticks == whole ? v.stride : bitLength(ticks - 1));
    Moment to;
    Moment slow_from = from;
    Moment slow_to;
    if (now().leavesOut(k))
    {
      if (v.slow_stride != k)
      {
        v.slow = distance(evaluateForms(now().slowForms(k), v.exponentials.data(), v.exponentials.size()), time);
        v.slow_stride = k;
      }
      slow_from = v.slow;
      const auto [tabulated, series] = split(ticks);
      const TwoForms forms = growEvaluateTwo(now().growth(), tabulated, series, v.exponentials.data(),
                                             now().derivative.col(1).data(), now().slowForms(k), v.there.data());
      to = distance(forms.first, time + width);
      slow_to = distance(forms.second, time + width);
    }
    else
    {
      to = slow_to = move(v.exponentials, ticks, time + width, v.there);
    }
    const Spread& about = slowSpread(k);
    const GapStretch stretch(slow_from, slow_to, width, about, from.value);
    if (stretch.staysAbove(resolution_))
    {
      if (state_ == 1)
      {
        watchPeak(Step{time, Sample{0, from}, Sample{ticks, to}}, stretch, ticks);
      }
      arrive(to, time + width);
      if (now().leavesOut(k))
      {
        v.slow = slow_to;
        v.slow_stride = k;
      }
      // Over twice the width the bulge is 64 times as high.
      if (v.stride < grid_.doublings && to.value > 128.0 * about.bulge + 4.0 * about.flat)
      {
        ++v.stride;
      }
      return ticks;
    }
    if (to.value < 0.0)
    {
      const double share = stretch.shareAbove(resolution_);
      if (share > 0.25)
      {
        const std::int64_t shorter = highestBits(static_cast<std::int64_t>(share * static_cast<double>(ticks)), 5);
        ++steps_total_;
        const double part = static_cast<double>(shorter) * grid_.tick;
        const Moment there = move(v.exponentials, shorter, time + part, v.there);
        if (state_ == 1)
        {
          watchPeak(Step{time, Sample{0, from}, Sample{shorter, there}}, stretch, ticks);
        }
        arrive(there, time + part);
        return shorter;
      }
    }
    if (v.stride == grid_.shortest_stride)
    {
      break;
    }
    v.stride = std::max(grid_.shortest_stride, bitLength(ticks - 1) - 1);
  }
  return 0;
}

/// From where the parabola of this moment tells of a root, and of no earlier one (approaches()): on to it, and past it
/// as far as the gap needs to show it. Returns the ticks made, or 0 where that is not among those that are left.
std::int64_t SwitchedMotion::land(std::int64_t left, double time)
{
  Vectors& v = vectors();
  const double third = side() * derivative(3);
  const auto series_range = static_cast<double>(std::int64_t{1} << grid_.shortest_stride);
  Moment at = distance();
  std::int64_t made = 0;
  double most = static_cast<double>(left);
  constexpr int attempts = 6;
  for (int attempt = 0; attempt < attempts; ++attempt)
  {
    // To where the gap is past zero by its rounding error and a half, forwards or back.
    double way = firstZero(at.value + 1.5 * resolution_, at.rate, at.acceleration);
    way -= third * way * way * way / (6.0 * (at.rate + at.acceleration * way));
    const double ticks = std::ceil(way / grid_.tick);
    if (attempt == 0)
    {
      most = std::min(most, 1.125 * ticks + most_ticks_through);
    }
    if (!(std::abs(static_cast<double>(made) + ticks) <= most))
    {
      return 0;
    }
    // A long way is not known well enough to be made to the tick at once.
    const bool near = std::abs(ticks) < series_range;
    const auto on =
        near || attempt > 0 ? static_cast<std::int64_t>(ticks) : highestBits(static_cast<std::int64_t>(ticks), 8);
    const bool on_from_there = attempt > 0 && (near || on > 0);
    made += on;
    if (made <= 0)
    {
      return 0;
    }
    ++steps_total_;
    const double there = time + static_cast<double>(made) * grid_.tick;
    at = on_from_there ? move(v.there, on, there, v.there) : move(v.exponentials, made, there, v.there);
    const double overrun = at.value / (at.rate * grid_.tick);
    if (at.value < -resolution_ && at.rate < 0.0 &&
        overrun < std::max(2.0, 4.0 * resolution_ / -(at.rate * grid_.tick)))
    {
      arrive(at, there);
      return made;
    }
  }
  return 0;
}

/// Moves on by `ticks` from `time`, and watches the peak of the force on the way.
void SwitchedMotion::step(std::int64_t ticks, double time)
{
  Vectors& v = vectors();
  const Moment from = distance();
  const double arrival = time + static_cast<double>(ticks) * grid_.tick;
  move(v.exponentials, ticks, v.there);
  const Moment to = distance(v.there, arrival);
  if (state_ == 1)
  {
    notePeak(to.value, arrival);
    searchPeak(Step{time, Sample{0, from}, Sample{ticks, to}}, 0);
  }
  arrive(to, arrival);
}

bool SwitchedMotion::onWrongSide() const
{
  return side() * gap_ < -resolution_;
}

bool SwitchedMotion::crossed() const
{
  return onWrongSide() && side() * rate_ < 0.0;
}

void SwitchedMotion::locateSwitches(ImpactSink& sink)
{
  const std::int64_t total = std::int64_t{1} << grid_.doublings;
  std::int64_t tick = 0;
  std::int64_t smallest = 1;
  std::int64_t shortest = total;  // safe step since that was last enlarged
  std::int64_t switches = 0;
  int steps = 0;
  bool settled = false;  // the state was decided, and the gap could not be told from zero since
  std::int64_t settled_at = 0;
  refreshResolution();
  while (tick < total)
  {
    const std::int64_t left = total - tick;
    const double time = static_cast<double>(tick) * grid_.tick;
    if (switches >= switch_limit_ && state_ == 1)
    {
      ++switch_limit_reached_;
      step(left, time);
      break;
    }
    const bool has_crossed = crossed();
    settled = settled && (tick == settled_at || std::abs(gap_) <= resolution_);
    std::int64_t ticks = !has_crossed && approaches() ? land(left, time) : 0;
    if (ticks == 0 && !has_crossed)
    {
      ticks = stride(left, time);
    }
    if (ticks != 0)
    {
      tick += ticks;
      continue;
    }
    ++steps_total_;
    ticks = has_crossed ? 0 : safeTicks(left);
    if (ticks == 0 && (has_crossed || !settled))
    {
      time_ = time;
      switchState(time, sink);
      ++switches;
      steps = 0;
      smallest = 1;
      settled = true;
      settled_at = tick;
      continue;
    }
    shortest = ticks > 0 ? std::min(shortest, ticks) : shortest;
    if (++steps % steps_before_coarser == 0)
    {
      smallest = 2 * std::max(smallest, shortest);
      shortest = total;
    }
    if (ticks == 0)
    {
      // Each state would leave for the other. It makes no difference which one it is until the gap shows.
      ticks = std::min(smallest, left);
      smallest *= 2;
    }
    else if (ticks < smallest && side() * gap_ >= -resolution_)
    {
      // Near grazing: a step that may overrun a crossing. Try it on a copy; if it does, halve it.
      ticks = std::min(smallest, left);
      Vectors& v = vectors();
      move(v.exponentials, ticks, v.probe);
      if (ticks > 1 && distance(v.probe, time + static_cast<double>(ticks) * grid_.tick).value < -resolution_)
      {
        smallest = ticks / 2;
        continue;
      }
    }
    else
    {
      ticks = std::min(std::max(ticks, smallest), left);
    }
    step(ticks, time);
    tick += ticks;
  }
  // A switch that has come due is not left to the next interval: the sample at its start is of the new state.
  if (crossed() && switches < switch_limit_)
  {
    switchState(grid_.length, sink);
  }
}

/// Whether a root is so near that the parabola of this moment tells where, and that there is none before: with the
/// third derivative within +-B the gap falls steadily up to the parabola's root and an eighth of the way beyond, which
/// is more than it can be late.
bool SwitchedMotion::approaches()
{
  const Moment d = distance();
  if (d.rate >= 0.0 || d.value <= 0.0)
  {
    return false;
  }
  const double root = firstZero(d.value, d.rate, d.acceleration);
  if (!(root < grid_.length))
  {
    return false;
  }
  const double square = root * root;
  const double bound = thirdBound();
  const double steepness = -(d.rate + d.acceleration * root);
  return bound * square * root / 6.0 < 0.0625 * d.value && steepness > 2.0 * bound * square &&
         steepness > -0.2 * d.rate;
}

/// How many of the `left` ticks can be made without a switch; at least 1, or 0 where the state must be switched now.
std::int64_t SwitchedMotion::safeTicks(std::int64_t left)
{
  const Moment here = distance();
  const double value = std::max(0.0, here.value);
  double time = earliestZero(value, here.rate, curvatureBound());
  if (onWrongSide())
  {
    // On its way back. The gap makes a switch only where it turns round: a zero of the rate.
    time = earliestZero(here.rate, here.acceleration, thirdBound());
  }
  else if (value <= resolution_ && (here.rate >= 0.0 || (time < 65536.0 * grid_.tick && hasNoRate())))
  {
    return departureTicks(left);
  }
  const double ticks = time / grid_.tick;
  if (ticks >= static_cast<double>(left))
  {
    return left;
  }
  const std::int64_t safe = std::max<std::int64_t>(1, highestBits(static_cast<std::int64_t>(ticks), 3));
  if (value <= resolution_ && here.rate < 0.0)
  {
    // At the root as far as the gap can be told from zero: on to where it can.
    const double through = 1.5 * (value + resolution_) / (-here.rate * grid_.tick);
    return std::clamp(static_cast<std::int64_t>(std::min(through, most_ticks_through)), safe, left);
  }
  return safe;
}

/// Whether the velocity is zero as far as the gap can tell: the acceleration turns it before it takes the gap further
/// than its rounding error.
bool SwitchedMotion::hasNoRate() const
{
  return rate_ * rate_ <= 2.0 * resolution_ * std::max(std::abs(acceleration_), derivative_rounding * curvatureBound());
}

/// At gap zero and not on the way out the first derivative D_k that is not zero decides: away from contact (no switch)
/// or into it. The gap keeps its sign for a time t if no partial sum of
///
///   D_1 t + D_2 t^2/2! + ... + D_7 t^7/7! - B_8 t^8/8!,
///
/// B_8 bounding the eighth derivative, is negative: at a share x of that time term k has the part x^k, which falls with
/// k, so that by Abel's summation the whole sum is not negative either.
std::int64_t SwitchedMotion::departureTicks(std::int64_t left)
{
  std::array<double, StateTables::highest_derivative + 1> derivatives{};
  derivatives[1] = hasNoRate() ? 0.0 : side() * rate_;
  double first = derivatives[1];
  for (int order = 2; order <= StateTables::highest_derivative; ++order)
  {
    const double inward = side() * derivative(order);
    const double bound = boundOfDerivative(order) + bodyBound(order);
    derivatives[static_cast<std::size_t>(order)] = order == StateTables::highest_derivative         ? -bound
                                                   : std::abs(inward) > derivative_rounding * bound ? inward
                                                                                                    : 0.0;
    if (first == 0.0)
    {
      first = std::abs(inward) > derivative_rounding * bound ? inward : 0.0;
    }
  }
  if (first < 0.0)
  {
    return 0;
  }
  if (first == 0.0)
  {
    return left;  // nothing moves
  }
  const auto keeps_sign = [&derivatives](double time)
  {
    double power = 1.0;  // time^order/order!
    double sum = 0.0;
    for (int order = 1; order <= StateTables::highest_derivative; ++order)
    {
      power *= time / order;
      sum += derivatives[static_cast<std::size_t>(order)] * power;
      if (sum < 0.0)
      {
        return false;
      }
    }
    return true;
  };
  std::int64_t ticks = left;
  while (ticks > 1 && !keeps_sign(static_cast<double>(ticks) * grid_.tick))
  {
    ticks /= 2;
  }
  return highestBits(ticks, 3);
}

}  // namespace vibro_impact::core
