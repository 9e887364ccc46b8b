#include "switched_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace vibro_impact::core
{
namespace
{
constexpr double two_pi = 6.28318530717958647693;

/// The series of an exponential function ends after the fourth power: x^4/120 is half a bit of 1 at this x.
constexpr double longest_series = 1.0e-3;
}  // namespace

SwitchedMotion::SwitchedMotion(std::shared_ptr<const SwitchedModel> model, bool phasor)
    : model_(std::move(model)),
      phasor_(phasor),
      tables_{StateTables(*model_, 0, phasor), StateTables(*model_, 1, phasor)}
{
  for (int state = 0; state < 2; ++state)
  {
    const Eigen::Index modes = linearState(state).size();
    const Eigen::Index half = tables_[static_cast<std::size_t>(state)].half;
    Vectors& v = vectors_[static_cast<std::size_t>(state)];
    v.exponentials = v.there = v.probe = v.history = Eigen::VectorXd::Zero(2 * half);
    v.displacement = v.velocity = Eigen::VectorXd::Zero(padded(modes));
  }
  const LinearState& contact = model_->contact();
  lowest_frequency_ =
      (contact.contact_deflection != 0.0).select(contact.frequency, std::numeric_limits<double>::infinity()).minCoeff();
  rest();
}

void SwitchedMotion::setInterval(double length)
{
  double highest = 0.0;
  double fastest = phasor_ ? drive_frequency_ : 0.0;
  for (int state = 0; state < 2; ++state)
  {
    const LinearState& linear = linearState(state);
    highest = std::max(highest, (linear.contact_deflection != 0.0).select(linear.frequency, 0.0).maxCoeff());
    fastest = std::max(fastest, linear.frequency.maxCoeff());
  }
  const double shortest_period = highest > 0.0 ? two_pi / highest : length;
  grid_.length = length;
  grid_.inverse_length = 1.0 / length;
  grid_.doublings = std::clamp(static_cast<int>(std::ceil(std::log2(length / (1.0e-12 * shortest_period)))), 10, 60);
  grid_.tick = std::ldexp(length, -grid_.doublings);
  grid_.shortest_stride = grid_.doublings;
  if (fastest > 0.0)
  {
    const double shortest = std::log2(longest_series / (fastest * grid_.tick));
    grid_.shortest_stride = static_cast<int>(std::clamp(shortest, 0.0, static_cast<double>(grid_.doublings)));
  }
  switch_limit_ = switch_allowance + static_cast<std::int64_t>(std::min(1.0e9, 2.0 * length * highest / two_pi));
  for (std::size_t state = 0; state < 2; ++state)
  {
    tables_[state].setGrid(grid_, drive_frequency_, drive_amplitude_);
    vectors_[state].stride = grid_.doublings;
    vectors_[state].forgetBounds();
  }
}

void SwitchedMotion::setHarmonicDrive(double frequency, double amplitude)
{
  for (int state = 0; state < 2; ++state)
  {
    const LinearState& linear = linearState(state);
    for (Eigen::Index n = 0; n < linear.size(); ++n)
    {
      if (linear.participation(n) != 0.0 && linear.damping_ratio(n) == 0.0 &&
          std::abs(linear.frequency(n) - frequency) <= 1.0e-9 * frequency)
      {
        throw std::invalid_argument("drive frequency: " + std::to_string(frequency / two_pi) +
                                    " Hz is a natural frequency of an undamped mode, whose response has no bound; "
                                    "give it damping or choose another frequency");
      }
    }
  }
  leaveExponentials();
  drive_frequency_ = frequency;
  drive_amplitude_ = amplitude;
  setInterval(two_pi / frequency);
  restartIntervalCount();
}

void SwitchedMotion::restartIntervalCount()
{
  intervals_ = 0;
  if (state_ == 1)
  {
    episode_.impact.interval = 0;
    episode_.impact.offset = -episode_.elapsed;
  }
}

void SwitchedMotion::rest()
{
  const double clearance = model_->clearance();
  const Eigen::Index gap_body = tables_[0].gap_body;
  state_ = clearance < 0.0 && gap_body < 0 ? 1 : 0;
  Vectors& v = vectors();
  v.displacement.head(now().standing.size()) = now().standing;
  v.velocity.setZero();
  in_coordinates_ = true;
  start_acceleration_ = slope_ = time_ = farthest_ = 0.0;
  gap_ = now().line_constant;
  if (clearance < 0.0 && gap_body >= 0)
  {
    // A body that nothing holds gives way until the spring no longer pushes it: the surfaces just touch.
    v.displacement(gap_body) = -clearance / model_->free().contact_deflection(gap_body);
    gap_ = 0.0;
  }
  rate_ = acceleration_ = 0.0;
  moment_known_ = true;
  for (Vectors& each : vectors_)
  {
    each.stride = grid_.doublings;
  }
  resolution_ = gap_rounding * std::abs(clearance);
  intervals_ = impacts_ = 0;
  contact_time_ = 0.0;
  if (state_ == 1)
  {
    beginEpisode(0.0, 0.0, 0.0);
    episode_.impact.cut_short = true;
  }
  openAccount();
}

void SwitchedMotion::start(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity)
{
  rest();
  setFreeCoordinates(displacement, velocity);
}

void SwitchedMotion::takeOver(SwitchedMotion& previous, ImpactSink& sink)
{
  previous.leaveExponentials();
  const SwitchedModel& before = *previous.model_;
  const Vectors& from = previous.vectors();
  gap_ = previous.gap_ + (linearState(previous.state_).gap - previous.linearState(previous.state_).gap);
  rate_ = previous.rate_;
  moment_known_ = true;
  time_ = previous.time_;
  start_acceleration_ = previous.start_acceleration_;
  slope_ = previous.slope_;
  farthest_ = previous.farthest_;
  resolution_ = previous.resolution_ + gap_rounding * (std::abs(before.clearance()) + std::abs(model_->clearance()));
  intervals_ = previous.intervals_;
  switches_ = previous.switches_;
  switch_limit_reached_ = previous.switch_limit_reached_;
  steps_total_ = previous.steps_total_;
  peak_evaluations_ = previous.peak_evaluations_;
  contact_time_ = previous.contact_time_;

  // Within its rounding of zero the gap decides nothing.
  state_ = std::abs(gap_) <= resolution_ ? previous.state_ : (gap_ < 0.0 ? 1 : 0);
  Vectors& to = vectors();
  const Eigen::Index modes = linearState(state_).size();
  const bool same_modes = model_->stiffness() == before.stiffness() && linearState(1).size() == before.contact().size();
  if (previous.state_ == 0 && state_ == 1)
  {
    map(tables_[1].mapping, from, to);
  }
  else if (previous.state_ == 1 && state_ == 0)
  {
    map(previous.tables_[0].mapping, from, to);
  }
  else if (state_ == 1 && !same_modes)
  {
    map(previous.tables_[0].mapping, from, vectors_[0]);
    map(tables_[1].mapping, vectors_[0], to);
  }
  else
  {
    to.displacement = from.displacement;
    to.velocity = from.velocity;
  }
  in_coordinates_ = true;
  if (!model_->lossless())
  {
    gap_ = linearState(state_).gap + linearState(state_).contact_deflection.matrix().dot(to.displacement.head(modes));
  }
  takeOverAccount(previous);

  if (previous.state_ == 1 && state_ == 0)
  {
    previous.episode_.impact.cut_short = true;
    previous.endEpisode(sink);
  }
  impacts_ = previous.impacts_;
  if (state_ == 0)
  {
    return;
  }
  if (previous.state_ == 0)
  {
    beginEpisode(0.0, 0.0, 0.0);
    episode_.impact.cut_short = true;
    return;
  }
  // The episode goes on under another force.
  previous.closeForce();
  episode_ = previous.episode_;
  episode_.compression = -gap_;
  episode_.compression_time = episode_.elapsed;
}

void SwitchedMotion::setFreeCoordinates(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity)
{
  state_ = 0;
  vectors().displacement.head(displacement.size()) = displacement;
  vectors().velocity.head(velocity.size()) = velocity;
  const Eigen::ArrayXd& deflection = model_->free().contact_deflection;
  gap_ = model_->clearance() + deflection.matrix().dot(displacement);
  rate_ = deflection.matrix().dot(velocity);
  moment_known_ = true;
  resolution_ = gap_rounding * (std::abs(model_->clearance()) + (deflection * displacement.array()).abs().sum());
  in_coordinates_ = true;
  if (gap_ < -resolution_)
  {
    mapToOtherState();
    beginEpisode(0.0, 0.0, 0.0);
    episode_.impact.cut_short = true;
  }
  openAccount();
}

double SwitchedMotion::force(double gap) const
{
  if (state_ == 0 || (gap > 0.0 && gap <= resolution_))
  {
    return 0.0;
  }
  return -model_->stiffness() * gap;
}

void SwitchedMotion::coordinates(Eigen::VectorXd& displacement, Eigen::VectorXd& velocity) const
{
  const Vectors& v = vectors();
  displacement = v.displacement;
  velocity = v.velocity;
  if (!in_coordinates_)
  {
    convert(v.exponentials, time_, displacement, velocity);
  }
  const Eigen::Index modes = linearState(state_).size();
  displacement.conservativeResize(modes);
  velocity.conservativeResize(modes);
}

Conversion SwitchedMotion::conversion(const Eigen::VectorXd& exponentials, double time) const
{
  const StateTables& t = now();
  Conversion conversion{t.conversion.data(), t.conversion.rows(), acceleration(time), slope_, 0.0, 0.0, 0.0};
  if (phasor_)
  {
    const Eigen::Index modes = t.modes();
    conversion.drive_re = exponentials(modes);
    conversion.drive_im = exponentials(exponentials.size() / 2 + modes);
    conversion.drive_frequency = drive_frequency_;
  }
  return conversion;
}

void SwitchedMotion::convert(const Eigen::VectorXd& exponentials, double time, Eigen::VectorXd& displacement,
                             Eigen::VectorXd& velocity) const
{
  const Conversion with = conversion(exponentials, time);
  vibro_impact::core::toCoordinates(with, exponentials.data(), exponentials.data() + exponentials.size() / 2,
                                    displacement.data(), velocity.data());
  const StateTables& t = now();
  for (Eigen::Index n = 0; n < t.bodies; ++n)
  {
    displacement(n) = bodyDisplacement(n, time) + t.transfer_re(n) * with.drive_re - t.transfer_im(n) * with.drive_im;
    velocity(n) = bodyVelocity(n, time) -
                  with.drive_frequency * (t.transfer_im(n) * with.drive_re + t.transfer_re(n) * with.drive_im);
  }
}

void SwitchedMotion::toCoordinates()
{
  convert(vectors().exponentials, time_, vectors().displacement, vectors().velocity);
}

void SwitchedMotion::map(const Eigen::MatrixXd& mapping, const Vectors& from, Vectors& to)
{
  multiplyTwo(mapping.data(), mapping.rows(), mapping.cols(), from.displacement.data(), from.velocity.data(),
              to.displacement.data(), to.velocity.data());
}

void SwitchedMotion::mapToOtherState()
{
  const Vectors& from = vectors();
  state_ = 1 - state_;
  map(now().mapping, from, vectors());
}

void SwitchedMotion::toExponentials()
{
  Vectors& v = vectors();
  double* z = v.exponentials.data();
  const Eigen::Index half = v.exponentials.size() / 2;
  const Conversion with = conversion(v.exponentials, time_);
  vibro_impact::core::toExponentials(with, v.displacement.data(), v.velocity.data(), z, z + half);
  if (phasor_)
  {
    // It may stand where the padding of the modes is.
    const Eigen::Index modes = linearState(state_).size();
    z[modes] = with.drive_re;
    z[half + modes] = with.drive_im;
  }
  body_time_ = time_;
  in_coordinates_ = false;
  setLine();
  vectors().forgetBounds();
}

void SwitchedMotion::setLine()
{
  const StateTables& t = now();
  line_start_ = t.line_constant - t.line_compliance * start_acceleration_ + t.line_lag * slope_;
  line_slope_ = -t.line_compliance * slope_;
}

void SwitchedMotion::addBody(Moment& distance, double time) const
{
  const StateTables& t = now();
  distance.value += side() * t.body_deflection * bodyDisplacement(t.gap_body, time);
  distance.rate += side() * t.body_deflection * bodyVelocity(t.gap_body, time);
  distance.acceleration -= side() * t.body_pull * acceleration(time);
}

double SwitchedMotion::bodyDisplacement(Eigen::Index n, double time) const
{
  const Eigen::VectorXd& z = vectors().exponentials;
  const double t = time - body_time_;
  const double push = linearState(state_).participation(n) * (acceleration(body_time_) / 2.0 + slope_ * t / 6.0);
  return z(n) + t * (z(z.size() / 2 + n) - t * push);
}

double SwitchedMotion::bodyVelocity(Eigen::Index n, double time) const
{
  const Eigen::VectorXd& z = vectors().exponentials;
  const double t = time - body_time_;
  return z(z.size() / 2 + n) - t * linearState(state_).participation(n) * (acceleration(body_time_) + slope_ * t / 2.0);
}

/// To the end of the interval.
void SwitchedMotion::moveBodies()
{
  Eigen::VectorXd& z = vectors().exponentials;
  for (Eigen::Index n = 0; n < now().bodies; ++n)
  {
    const double displacement = bodyDisplacement(n, time_);
    z(z.size() / 2 + n) = bodyVelocity(n, time_);
    z(n) = displacement;
  }
  body_time_ = time_;
}

void SwitchedMotion::evaluate()
{
  setDistance(distance(vectors().exponentials, time_));
}

void SwitchedMotion::setDistance(const Moment& distance)
{
  gap_ = side() * distance.value;
  rate_ = side() * distance.rate;
  acceleration_ = side() * distance.acceleration;
  moment_known_ = true;
}

void SwitchedMotion::arrive(const Moment& distance, double time)
{
  std::swap(vectors().exponentials, vectors().there);
  vectors().slow_stride = -1;
  time_ = time;
  setDistance(distance);
}

void SwitchedMotion::advanceLinear(double from, double to, ImpactSink& sink)
{
  const double slope = (to - from) * grid_.inverse_length;
  start_acceleration_ = from;
  farthest_ = std::max(std::abs(from), std::abs(to));
  time_ = body_time_ = 0.0;
  double change = 0.0;
  if (in_coordinates_)
  {
    slope_ = slope;
    startFromCoordinates();
  }
  else
  {
    // Displacement and velocity are continuous; the quasi-static part takes the new slope at once and z makes up for
    // it.
    change = slope - slope_;
    now().energy.pass(change, slope_, grid_.length);
    slope_ = slope;
    setLine();
  }
  advanceInterval(change, sink);
}

std::size_t SwitchedMotion::advanceSteadily(double from, const double* accelerations, std::size_t count, double* gap,
                                            double* force)
{
  StateTables& t = now();
  if (in_coordinates_ || t.bodies > 0)
  {
    return 0;
  }
  Vectors& v = vectors();
  const bool closed = state_ == 1;
  if (closed)
  {
    completeMoment();
  }
  const Steady constants{t.growth(),      grid_.doublings - grid_.shortest_stride,
                         t.kick.data(),   t.derivative.col(1).data(),
                         t.sag.data(),    t.sag_rate.data(),
                         t.kick_sag,      t.kick_sag_rate,
                         t.line_constant, t.line_compliance,
                         t.line_lag,      t.kick_gap_integral,
                         grid_.length,    grid_.inverse_length,
                         resolution_,     peak_share};
  SteadyMotion motion{v.exponentials.data(),
                      v.there.data(),
                      t.energy.kicks(),
                      start_acceleration_,
                      slope_,
                      from,
                      gap_,
                      sag_,
                      t.energy.passed().squared_changes,
                      t.energy.passed().squared_slope,
                      rate_,
                      sag_rate_,
                      episode_.compression,
                      episode_.compression_time,
                      episode_.elapsed,
                      episode_.gap_integral,
                      contact_time_};
  const std::size_t done = closed ? advanceClosed(constants, motion, accelerations, count, gap)
                                  : advanceOpen(constants, motion, accelerations, count, gap);
  sag_ = motion.sag;
  sag_rate_ = motion.sag_rate;
  if (done == 0)
  {
    return 0;
  }
  if (motion.z != v.exponentials.data())
  {
    std::swap(v.exponentials, v.there);
  }
  start_acceleration_ = motion.start_acceleration;
  slope_ = motion.slope;
  setLine();
  time_ = grid_.length;
  gap_ = motion.gap;
  t.energy.passed() = {motion.squared_changes, motion.squared_slope};
  intervals_ += done;
  moment_known_ = false;
  if (closed)
  {
    completeMoment();
    episode_.compression = motion.compression;
    episode_.compression_time = motion.compression_time;
    episode_.elapsed = motion.elapsed;
    episode_.gap_integral = motion.gap_integral;
    contact_time_ = motion.duration;
  }
  for (std::size_t i = 0; i < done; ++i)
  {
    force[i] = this->force(gap[i]);
  }
  return done;
}

void SwitchedMotion::advanceHarmonic(ImpactSink& sink)
{
  time_ = body_time_ = 0.0;
  // The phasor starts every cycle anew, so that its rounding cannot add up: a = Re D = -amplitude cos(Omega t).
  for (int state = 0; state < 2; ++state)
  {
    Eigen::VectorXd& z = vectors_[static_cast<std::size_t>(state)].exponentials;
    const Eigen::Index modes = linearState(state).size();
    z(modes) = -drive_amplitude_;
    z(z.size() / 2 + modes) = 0.0;
  }
  if (in_coordinates_)
  {
    startFromCoordinates();
  }
  else
  {
    ++span_intervals_;
  }
  advanceInterval(0.0, sink);
}

/// From exponentials to displacement and velocity, from which any other drive or contact can go on.
void SwitchedMotion::leaveExponentials()
{
  if (!in_coordinates_)
  {
    completeMoment();
    closeSpan();
    if (state_ == 1)
    {
      closeIntegrals();
    }
    toCoordinates();
    in_coordinates_ = true;
  }
}

void SwitchedMotion::startFromCoordinates()
{
  toExponentials();
  evaluate();
  refreshResolution();
  refreshSag();
  openSpan();
  if (state_ == 1)
  {
    openIntegrals();
  }
}

void SwitchedMotion::advanceInterval(double slope_change, ImpactSink& sink)
{
  Vectors& v = vectors();
  StateTables& t = now();
  if (state_ == 1)
  {
    episode_.gap_integral -= slope_change * t.kick_gap_integral;
    beginPiece();
  }
  if (history_ != nullptr)
  {
    beginHistoryPiece();
  }
  addScaled(t.energy.kicks(), slope_change, v.exponentials.data(), v.exponentials.size());
  if (phasor_ || !crossInterval(slope_change))
  {
    addScaled(v.exponentials.data(), slope_change, t.kick.data(), t.kick.size());
    vectors().forgetBounds();
    completeMoment();
    if (!phasor_)
    {
      v.stride = grid_.doublings;
    }
    locateSwitches(sink);
    time_ = grid_.length;
    refreshSag();
  }
  if (state_ == 1)
  {
    endPiece();
  }
  if (history_ != nullptr)
  {
    takeHistory();
  }
  if (now().bodies > 0)
  {
    moveBodies();
  }
  ++intervals_;
  if (history_ != nullptr)
  {
    endHistoryInterval();
  }
}

/// One step over a whole interval, if there the chord of the gap is so far from zero that there can be no switch, and
/// no peak but at an end.
bool SwitchedMotion::crossInterval(double slope_change)
{
  Vectors& v = vectors();
  StateTables& t = now();
  const double form = kickGrowEvaluate(t.growth(), grid_.doublings - grid_.shortest_stride, v.exponentials.data(),
                                       slope_change, t.kick.data(), t.derivative.col(1).data(), v.there.data());
  const double before = side() * gap_;
  const double after = distance(Forms{form, 0.0, 0.0}, grid_.length).value;
  const double least = std::min(before, after) - resolution_;
  const double bend = t.gap_body < 0 ? 0.0 : bodyBound(2) * grid_.length * grid_.length / 8.0;
  sag_ += std::abs(slope_change) * t.kick_sag;
  if (least <= sag_ + bend)
  {
    // Damping has made it less.
    refreshSag();
    sag_ += std::abs(slope_change) * t.kick_sag;
    if (least <= sag_ + bend)
    {
      return false;
    }
  }
  if (state_ == 0)
  {
    std::swap(v.exponentials, v.there);
    time_ = grid_.length;
    gap_ = after;
    moment_known_ = false;
    return true;
  }
  const Moment to = distance(evaluateForms(t.derivative.col(1).data(), v.there.data(), v.there.size()), grid_.length);
  if (std::max(before, after) + sag_ > leastPeak())
  {
    const double sag_rate = weightedSize(t.sag_rate.data(), v.exponentials.data(), v.exponentials.size() / 2) +
                            std::abs(slope_change) * t.kick_sag_rate;
    const double from_rate = side() * rate_;
    const bool rises = std::min(from_rate, to.rate) > sag_rate;
    const bool falls = std::max(from_rate, to.rate) < -sag_rate;
    if (!moment_known_ || !(rises || falls))
    {
      return false;
    }
    notePeak(to.value, grid_.length);
  }
  arrive(to, grid_.length);
  return true;
}

void SwitchedMotion::refreshSag()
{
  const Eigen::VectorXd& z = vectors().exponentials;
  sag_ = weightedSize(now().sag.data(), z.data(), now().half);
  sag_rate_ = weightedSize(now().sag_rate.data(), z.data(), now().half);
}

Moment SwitchedMotion::moment() const
{
  const Eigen::VectorXd& z = vectors().exponentials;
  Moment moment = distance(evaluateForms(now().derivative.col(1).data(), z.data(), z.size()), time_);
  moment.value *= side();
  moment.rate *= side();
  moment.acceleration *= side();
  return moment;
}

void SwitchedMotion::completeMoment()
{
  if (!moment_known_)
  {
    const Moment here = moment();
    rate_ = here.rate;
    acceleration_ = here.acceleration;
    moment_known_ = true;
  }
}

void SwitchedMotion::switchState(double time, ImpactSink& sink)
{
  // The motion is past the root by a few ticks; in the conjoined basis a jump of the gap may have put it anywhere.
  const double overrun = gap_ / rate_;
  const double late = overrun > 0.0 && overrun <= most_ticks_through * grid_.tick ? overrun : 0.0;
  const double speed = std::abs(rate_ - late * acceleration_);
  if (history_ != nullptr)
  {
    takeHistory();
  }
  closeSpan();
  if (state_ == 1)
  {
    endPiece();
    closeIntegrals();
    episode_.elapsed -= late;
    episode_.impact.separation_speed = speed;
  }
  const Vectors& from = vectors();
  const Eigen::Index from_modes = now().modes();
  const Eigen::Index from_half = from.exponentials.size() / 2;
  toCoordinates();
  double mapping_loss = model_->lossless() ? 0.0 : storedEnergy();
  mapToOtherState();
  if (phasor_)
  {
    Vectors& to = vectors();
    const Eigen::Index modes = now().modes();
    const Eigen::Index half = to.exponentials.size() / 2;
    to.exponentials(modes) = from.exponentials(from_modes);
    to.exponentials(half + modes) = from.exponentials(from_half + from_modes);
  }
  if (!model_->lossless())
  {
    mapping_loss -= storedEnergy();
    account_.mapping_loss += mapping_loss;
    account_.turnover += std::abs(mapping_loss);
  }
  toExponentials();
  evaluate();
  refreshResolution();
  openSpan();
  if (history_ != nullptr)
  {
    beginHistoryPiece();
  }
  ++switches_;
  if (state_ == 1)
  {
    beginEpisode(time - late, late, speed);
    episode_.impact.mapping_loss = mapping_loss;
    openIntegrals();
    beginPiece();
  }
  else
  {
    episode_.impact.mapping_loss += mapping_loss;
    endEpisode(sink);
  }
}

void SwitchedMotion::interrupt(ImpactSink& sink)
{
  if (state_ == 1)
  {
    episode_.impact.cut_short = true;
    if (!in_coordinates_)
    {
      closeSpan();
      closeIntegrals();
    }
    endEpisode(sink);
    // What is left of the episode is not whole either.
    beginEpisode(0.0, 0.0, 0.0);
    episode_.impact.cut_short = true;
    if (!in_coordinates_)
    {
      openSpan();
      openIntegrals();
    }
  }
}

}  // namespace vibro_impact::core
