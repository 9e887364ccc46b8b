// Of SwitchedMotion: what becomes an Impact.

#include <algorithm>
#include <cmath>

#include "switched_motion.h"
#include "tick_bits.h"

namespace vibro_impact::core
{
void SwitchedMotion::beginEpisode(double offset, double elapsed, double approach_speed)
{
  episode_ = Episode();
  episode_.impact.interval = intervals_;
  episode_.impact.offset = offset;
  episode_.impact.approach_speed = approach_speed;
  episode_.elapsed = elapsed;
  episode_.compression = -gap_;
  episode_.first_step = steps_total_;
}

// Over a piece of the episode inside one interval the integral of the gap is that of a line plus J(z_end) - J(z_start),
// J being a linear form. From piece to piece z only changes by the kick of a new slope, so that the forms cancel but
// for these kicks and the two ends of the episode.

void SwitchedMotion::openIntegrals()
{
  const Eigen::VectorXd& z = vectors().exponentials;
  episode_.gap_integral -= dot(now().derivative.data(), z.data(), z.size());
}

void SwitchedMotion::closeIntegrals()
{
  const Eigen::VectorXd& z = vectors().exponentials;
  episode_.gap_integral += dot(now().derivative.data(), z.data(), z.size());
}

void SwitchedMotion::beginPiece()
{
  episode_.piece_start = time_;
}

void SwitchedMotion::endPiece()
{
  const StateTables& t = now();
  const double duration = time_ - episode_.piece_start;
  const double mean = 0.5 * (acceleration(episode_.piece_start) + acceleration(time_));
  episode_.gap_integral += duration * (t.line_constant - t.line_compliance * mean + t.line_lag * slope_);
  episode_.elapsed += duration;
  contact_time_ += duration;
}

/// Adds what the force of this contact has done since it holds.
void SwitchedMotion::closeForce()
{
  Impact& impact = episode_.impact;
  episode_.impulse -= model_->stiffness() * episode_.gap_integral;
  episode_.gap_integral = 0.0;
  const double peak_force = model_->stiffness() * episode_.compression;
  if (peak_force > impact.peak_force)
  {
    impact.peak_force = peak_force;
    impact.peak_time = std::max(0.0, episode_.compression_time);
  }
}

void SwitchedMotion::endEpisode(ImpactSink& sink)
{
  closeForce();
  Impact& impact = episode_.impact;
  impact.number = impacts_++;
  impact.duration = std::max(0.0, episode_.elapsed);
  impact.impulse = episode_.impulse;
  impact.energy_lost = impact.dissipated + impact.mapping_loss;
  // The impulse is the small difference of large terms where the episode is shallow or short. Within their rounding,
  // which adds up over its intervals and steps, it is what duration and peak allow.
  const std::uint64_t roundings = 1 + intervals_ - impact.interval + steps_total_ - episode_.first_step;
  const double rounding = static_cast<double>(roundings) * model_->stiffness() * resolution_ / lowest_frequency_;
  if (std::abs(impact.impulse) <= rounding)
  {
    impact.impulse = std::clamp(impact.impulse, 0.0, impact.peak_force * impact.duration);
  }
  sink.onImpact(impact);
}

void SwitchedMotion::notePeak(double compression, double time)
{
  if (compression > episode_.compression)
  {
    episode_.compression = compression;
    episode_.compression_time = episode_.elapsed + (time - episode_.piece_start);
  }
}

/// What is no higher counts for no peak.
double SwitchedMotion::leastPeak() const
{
  return std::max(episode_.compression * peak_share, resolution_);
}

/// Of a step from the exponentials now to those `there`, the first part of a stretch of `range` ticks or the whole of
/// it.
void SwitchedMotion::watchPeak(const Step& step, const GapStretch& slow, std::int64_t range)
{
  notePeak(step.to.distance.value, step.start + static_cast<double>(step.to.tick) * grid_.tick);
  if (!slow.staysBelow(leastPeak()) && !findPeak(step, slow, range))
  {
    searchPeak(step, 0);
  }
}

SwitchedMotion::Sample SwitchedMotion::samplePeak(double start, std::int64_t tick)
{
  ++peak_evaluations_;
  const double time = start + static_cast<double>(tick) * grid_.tick;
  const Sample result{tick, move(vectors().exponentials, tick, time, vectors().probe)};
  notePeak(result.distance.value, time);
  return result;
}

/// From a sample to the maximum next to it, where the compression is concave.
void SwitchedMotion::climb(double start, Sample sample, std::int64_t least, std::int64_t most)
{
  constexpr int iterations = 8;
  for (int iteration = 0; iteration < iterations; ++iteration)
  {
    const Moment& d = sample.distance;
    const double correction = -d.rate / d.acceleration;
    const double gain = 0.5 * d.rate * correction;
    if (gain <= 1.0e-9 * std::abs(d.value) || std::abs(correction) < grid_.tick)
    {
      notePeak(d.value + gain, start + static_cast<double>(sample.tick) * grid_.tick + correction);
      return;
    }
    const auto back = static_cast<double>(least - sample.tick);
    const auto on = static_cast<double>(most - sample.tick);
    const double ticks = std::clamp(correction / grid_.tick, back, on);
    if (std::isnan(ticks))
    {
      return;  // flat to rounding
    }
    sample = samplePeak(start, sample.tick + highestBits(static_cast<std::int64_t>(ticks), 8));
  }
}

/// Finds the peak of a step where the slow modes tell how wide it is: outside that width the compression is too low.
/// Returns whether that could be shown.
bool SwitchedMotion::findPeak(const Step& step, const GapStretch& slow, std::int64_t range)
{
  if (step.from.distance.rate <= 0.0 || step.to.distance.rate >= 0.0 || step.to.tick < 8)
  {
    return false;
  }
  const auto last = static_cast<double>(step.to.tick - 1);
  const auto inside = [&](double tick)
  { return highestBits(static_cast<std::int64_t>(std::clamp(tick, 1.0, last)), 8); };
  const auto share = [&](std::int64_t tick) { return static_cast<double>(tick) / static_cast<double>(range); };
  const Sample middle = samplePeak(step.start, inside(slow.shareOfMaximum() * static_cast<double>(range)));
  const Moment& m = middle.distance;
  if (m.acceleration >= 0.0)
  {
    return false;
  }
  // Beyond sqrt(2 spread/|g''|) the parabola of the peak is lower by more than the spread.
  const double least = std::sqrt(2.0 * slow.greatestSpread() / -m.acceleration) + std::abs(m.rate / m.acceleration);
  const double ticks =
      least < last * grid_.tick ? std::ldexp(1.0, std::ilogb(std::max(2.0, least / grid_.tick)) + 1) : 2.0 * last;
  const auto at = static_cast<double>(middle.tick);
  const Sample before = at - ticks > 1.0 ? samplePeak(step.start, static_cast<std::int64_t>(at - ticks)) : step.from;
  const Sample after = at + ticks < last ? samplePeak(step.start, static_cast<std::int64_t>(at + ticks)) : step.to;
  const std::int64_t between = after.tick - before.tick;
  const GapStretch peak(before.distance, after.distance, static_cast<double>(between) * grid_.tick,
                        spread(bitLength(between - 1)));
  if (peak.isConcave())
  {
    climb(step.start, middle, before.tick, after.tick);
    return slow.staysBelowOutside(share(before.tick), share(after.tick), leastPeak());
  }
  if (!slow.staysBelowOutside(share(before.tick), share(after.tick), leastPeak()))
  {
    return false;
  }
  searchPeak(Step{step.start, before, middle}, 1);
  searchPeak(Step{step.start, middle, after}, 1);
  return true;
}

/// Finds a greater compression than any so far in a step, if there is one.
void SwitchedMotion::searchPeak(const Step& step, int depth)
{
  constexpr int deepest = 48;
  const double start = step.start;
  const Sample& from = step.from;
  const Sample& to = step.to;
  const std::int64_t range = to.tick - from.tick;
  if (range < 2 || depth == deepest)
  {
    return;
  }
  const GapStretch stretch(from.distance, to.distance, static_cast<double>(range) * grid_.tick,
                           spread(bitLength(range - 1)));
  if (stretch.staysBelow(leastPeak()) || stretch.isMonotonous())
  {
    return;
  }
  const auto chosen = [&](double share)
  {
    return from.tick + std::clamp<std::int64_t>(
                           highestBits(static_cast<std::int64_t>(share * static_cast<double>(range)), 8), 1, range - 1);
  };
  const bool inside = from.distance.rate > 0.0 && to.distance.rate < 0.0;
  if (stretch.isConcave())  // no more than one maximum
  {
    if (inside)
    {
      climb(start, samplePeak(start, chosen(stretch.shareOfMaximum())), from.tick, to.tick);
    }
    return;
  }
  const Sample middle = samplePeak(start, chosen(inside ? std::clamp(stretch.shareOfMaximum(), 0.1, 0.9) : 0.5));
  searchPeak(Step{start, from, middle}, depth + 1);
  searchPeak(Step{start, middle, to}, depth + 1);
}

}  // namespace vibro_impact::core
