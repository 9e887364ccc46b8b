#include "switched_motion.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "lanes.h"

namespace vibro_impact::core
{
namespace
{
constexpr double two_pi = 6.28318530717958647693;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Rounding error of the gap, as a share of the terms it is summed from: an allowance for what adds up in 1e5
/// intervals.
constexpr double gap_rounding = 128.0 * epsilon;

/// Derivatives of the gap below this share of the terms they are summed from are rounding, and taken for zero.
constexpr double derivative_rounding = 1.0e-9;

/// The most ticks that are made at a root to get past the gap's rounding error: 1e-9 of the shortest period.
constexpr double most_ticks_through = 1024.0;

/// Keeps the three highest bits: a step shortened by less than a fifth that costs three products a mode at the most.
std::int64_t threeHighestBits(std::int64_t ticks)
{
  int shift = 0;
  while ((ticks >> shift) > 7)
  {
    ++shift;
  }
  return (ticks >> shift) << shift;
}

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
}  // namespace

SwitchedMotion::SwitchedMotion(std::shared_ptr<const SwitchedModel> model, bool phasor)
    : model_(std::move(model)), phasor_(phasor)
{
  for (int state = 0; state < 2; ++state)
  {
    const Eigen::Index modes = linearState(state).size();
    const Eigen::Index half = padded(modes + (phasor_ ? 1 : 0));
    Vectors& v = vectors_[static_cast<std::size_t>(state)];
    v.exponentials = v.before = v.trial = v.history = Eigen::VectorXd::Zero(2 * half);
    v.displacement = v.velocity = Eigen::VectorXd::Zero(modes);
    tabulate(state);
  }
  const LinearState& contact = model_->contact();
  lowest_frequency_ =
      (contact.contact_deflection != 0.0).select(contact.frequency, std::numeric_limits<double>::infinity()).minCoeff();
  rest();
}

void SwitchedMotion::tabulate(int state)
{
  const LinearState& linear = linearState(state);
  const Eigen::Index modes = linear.size();
  const Eigen::Index half = padded(modes + (phasor_ ? 1 : 0));
  Tables& t = tables_[static_cast<std::size_t>(state)];

  const Eigen::ArrayXd squared = linear.frequency.square();
  const auto elastic = [&linear](const Eigen::ArrayXd& values) -> Eigen::ArrayXd
  { return (linear.frequency > 0.0).select(values, 0.0); };
  t.bodies = (linear.frequency == 0.0).count();
  t.decay = linear.damping_ratio * linear.frequency;
  t.damped = linear.frequency * (1.0 - linear.damping_ratio.square()).sqrt();
  t.compliance = elastic(linear.participation / squared);
  t.lag = elastic(2.0 * linear.damping_ratio * linear.participation / (squared * linear.frequency));
  t.standing = elastic(linear.preload / squared);
  t.transfer_re = t.transfer_im = Eigen::ArrayXd::Zero(modes);

  for (Eigen::Index n = 0; n < t.bodies; ++n)
  {
    if (linear.contact_deflection(n) != 0.0)
    {
      t.gap_body = n;
      t.body_deflection = linear.contact_deflection(n);
      t.body_pull = linear.contact_deflection(n) * linear.participation(n);
    }
  }

  t.line_constant = linear.gap + (linear.contact_deflection * t.standing).sum();
  if (state == 1 && tables_[0].gap_body >= 0)
  {
    t.line_constant = 0.0;  // nothing presses a free body against the spring
  }
  t.line_compliance = (linear.contact_deflection * t.compliance).sum();
  t.line_lag = (linear.contact_deflection * t.lag).sum();

  t.kick = Eigen::VectorXd::Zero(2 * half);
  t.kick.head(modes) = -t.lag;
  t.kick.segment(half, modes) = -elastic((t.compliance - t.decay * t.lag) / t.damped);
  const Eigen::ArrayXd kick_size =
      (t.kick.head(modes).array().square() + t.kick.segment(half, modes).array().square()).sqrt();
  t.kick_bound = (linear.contact_deflection.abs() * squared * kick_size).sum();

  t.derivative = Eigen::MatrixXd::Zero(2 * half, highest_derivative + 2);
  t.magnitude = Eigen::MatrixXd::Zero(half, highest_derivative + 2);
  for (Eigen::Index n = t.bodies; n < modes; ++n)
  {
    const std::complex<double> lambda(-t.decay(n), t.damped(n));
    const double weight = linear.contact_deflection(n);
    std::complex<double> factor = weight / lambda;
    for (Eigen::Index column = 0; column < t.derivative.cols(); ++column)
    {
      t.derivative(n, column) = factor.real();
      t.derivative(half + n, column) = -factor.imag();
      t.magnitude(n, column) = std::abs(weight) * std::pow(linear.frequency(n), static_cast<double>(column));
      factor = column == 0 ? std::complex<double>(weight) : factor * lambda;
    }
  }
  t.kick_gap_integral = t.derivative.col(0).dot(t.kick);
  t.energy.tabulate(linear, t.kick);
}

void SwitchedMotion::tabulatePhasor(int state)
{
  const LinearState& linear = linearState(state);
  const Eigen::Index modes = linear.size();
  const Eigen::Index half = padded(modes + 1);
  Tables& t = tables_[static_cast<std::size_t>(state)];
  const double omega = drive_frequency_;
  std::complex<double> weight = 0.0;
  for (Eigen::Index n = 0; n < modes; ++n)
  {
    const double natural = linear.frequency(n);
    const std::complex<double> dynamic_stiffness((natural - omega) * (natural + omega),
                                                 2.0 * linear.damping_ratio(n) * natural * omega);
    std::complex<double> transfer = 0.0;
    if (linear.participation(n) != 0.0)
    {
      transfer = -linear.participation(n) / dynamic_stiffness;
    }
    t.transfer_re(n) = transfer.real();
    t.transfer_im(n) = transfer.imag();
    weight += linear.contact_deflection(n) * transfer;
  }
  const std::complex<double> lambda(0.0, omega);
  std::complex<double> factor = weight / lambda;
  for (Eigen::Index column = 0; column < t.derivative.cols(); ++column)
  {
    t.derivative(modes, column) = factor.real();
    t.derivative(half + modes, column) = -factor.imag();
    t.magnitude(modes, column) = std::abs(weight) * std::pow(omega, static_cast<double>(column));
    factor = column == 0 ? weight : factor * lambda;
  }
  t.energy.tabulateHarmonic(linear, omega, drive_amplitude_, t.transfer_re, t.transfer_im);
}

void SwitchedMotion::setInterval(double length)
{
  length_ = length;
  inverse_length_ = 1.0 / length;
  double highest = 0.0;
  for (int state = 0; state < 2; ++state)
  {
    const LinearState& linear = linearState(state);
    highest = std::max(highest, (linear.contact_deflection != 0.0).select(linear.frequency, 0.0).maxCoeff());
  }
  const double shortest_period = highest > 0.0 ? two_pi / highest : length;
  doublings_ = std::clamp(static_cast<int>(std::ceil(std::log2(length / (1.0e-12 * shortest_period)))), 10, 60);
  tick_ = std::ldexp(length, -doublings_);
  switch_limit_ = switch_allowance + static_cast<std::int64_t>(std::min(1.0e9, 2.0 * length * highest / two_pi));

  for (int state = 0; state < 2; ++state)
  {
    Tables& t = tables_[static_cast<std::size_t>(state)];
    const Eigen::Index modes = linearState(state).size();
    const Eigen::Index half = padded(modes + (phasor_ ? 1 : 0));
    t.factor_re.resize(half, doublings_ + 1);
    t.factor_im.resize(half, doublings_ + 1);
    for (int k = 0; k <= doublings_; ++k)
    {
      const double time = std::ldexp(tick_, k);
      for (Eigen::Index n = 0; n < half; ++n)  // the modes, the phasor, the padding
      {
        const double shrinkage = n < modes ? std::expm1(-t.decay(n) * time) : 0.0;
        const double angle = (n < modes ? t.damped(n) : drive_frequency_) * time;
        const double half_sine = std::sin(0.5 * angle);
        t.factor_re(n, k) = shrinkage * std::cos(angle) - 2.0 * half_sine * half_sine;
        t.factor_im(n, k) = (1.0 + shrinkage) * std::sin(angle);
      }
    }
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
  for (int state = 0; state < 2; ++state)
  {
    tabulatePhasor(state);
  }
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
  v.displacement = now().standing;
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
  rate_ = bound_ = 0.0;
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
  const bool same_modes = model_->stiffness() == before.stiffness() && linearState(1).size() == before.contact().size();
  const auto map = [](const auto& matrix, const Vectors& source, Vectors& result)
  {
    result.displacement.noalias() = matrix * source.displacement;
    result.velocity.noalias() = matrix * source.velocity;
  };
  if (previous.state_ == 0 && state_ == 1)
  {
    map(model_->mapping().transpose(), from, to);
  }
  else if (previous.state_ == 1 && state_ == 0)
  {
    map(before.mapping(), from, to);
  }
  else if (state_ == 1 && !same_modes)
  {
    map(before.mapping(), from, vectors_[0]);
    map(model_->mapping().transpose(), vectors_[0], to);
  }
  else
  {
    to.displacement = from.displacement;
    to.velocity = from.velocity;
  }
  in_coordinates_ = true;
  if (!model_->lossless())
  {
    gap_ = linearState(state_).gap + linearState(state_).contact_deflection.matrix().dot(to.displacement);
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
  episode_.smallest_gap = gap_;
  episode_.smallest_gap_time = episode_.elapsed;
}

/// What the change does to the spring is work from outside. A truncated mapping takes its share of the structures'.
void SwitchedMotion::takeOverAccount(const SwitchedMotion& previous)
{
  EnergyAccount before;
  previous.storeEnergy(previous.vectors().displacement, previous.vectors().velocity, previous.gap_, before);
  account_ = previous.account_;
  storeEnergy(vectors().displacement, vectors().velocity, gap_, account_);
  const double contact_work = account_.spring + account_.left_out - before.spring - before.left_out;
  const double mapping_loss =
      model_->lossless() ? 0.0 : before.structure1 + before.structure2 - account_.structure1 - account_.structure2;
  account_.contact_work += contact_work;
  account_.mapping_loss += mapping_loss;
  account_.turnover += std::abs(contact_work) + std::abs(mapping_loss);
}

void SwitchedMotion::setFreeCoordinates(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity)
{
  state_ = 0;
  vectors().displacement = displacement;
  vectors().velocity = velocity;
  const Eigen::ArrayXd& deflection = model_->free().contact_deflection;
  gap_ = model_->clearance() + deflection.matrix().dot(displacement);
  rate_ = deflection.matrix().dot(velocity);
  resolution_ = gap_rounding * (std::abs(model_->clearance()) + (deflection * displacement.array()).abs().sum());
  in_coordinates_ = true;
  if (gap_ < -resolution_)
  {
    state_ = 1;
    vectors().displacement = model_->mapping().transpose() * displacement;
    vectors().velocity = model_->mapping().transpose() * velocity;
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

// ---------------------------------------------------------------------------------------------------------------------
// Coordinates and exponentials

void SwitchedMotion::coordinates(Eigen::VectorXd& displacement, Eigen::VectorXd& velocity) const
{
  const Vectors& v = vectors();
  if (in_coordinates_)
  {
    displacement = v.displacement;
    velocity = v.velocity;
    return;
  }
  coordinates(v.exponentials, time_, displacement, velocity);
}

void SwitchedMotion::coordinates(const Eigen::VectorXd& exponentials, double time, Eigen::VectorXd& displacement,
                                 Eigen::VectorXd& velocity) const
{
  const Tables& t = now();
  const Eigen::Index modes = t.decay.size();
  const Eigen::Index half = exponentials.size() / 2;
  const auto re = exponentials.head(modes).array();
  const auto im = exponentials.segment(half, modes).array();
  displacement = (t.standing - t.compliance * acceleration(time) + t.lag * slope_ + re).matrix();
  velocity = (-t.compliance * slope_ - t.decay * re - t.damped * im).matrix();
  for (Eigen::Index n = 0; n < t.bodies; ++n)
  {
    displacement(n) = bodyDisplacement(n, time);
    velocity(n) = bodyVelocity(n, time);
  }
  if (phasor_)
  {
    const double drive_re = exponentials(modes);
    const double drive_im = exponentials(half + modes);
    displacement.array() += t.transfer_re * drive_re - t.transfer_im * drive_im;
    velocity.array() -= drive_frequency_ * (t.transfer_im * drive_re + t.transfer_re * drive_im);
  }
}

void SwitchedMotion::toCoordinates()
{
  coordinates(vectors().displacement, vectors().velocity);
}

void SwitchedMotion::toExponentials()
{
  Vectors& v = vectors();
  const Tables& t = now();
  const Eigen::Index modes = t.decay.size();
  const Eigen::Index half = v.exponentials.size() / 2;
  auto re = v.exponentials.head(modes).array();
  auto im = v.exponentials.segment(half, modes).array();
  re = v.displacement.array() - (t.standing - t.compliance * acceleration(time_) + t.lag * slope_);
  im = v.velocity.array() + t.compliance * slope_;
  if (phasor_)
  {
    const double drive_re = v.exponentials(modes);
    const double drive_im = v.exponentials(half + modes);
    re -= t.transfer_re * drive_re - t.transfer_im * drive_im;
    im += drive_frequency_ * (t.transfer_im * drive_re + t.transfer_re * drive_im);
  }
  const Eigen::Index elastic = modes - t.bodies;
  im.tail(elastic) = -(im.tail(elastic) + t.decay.tail(elastic) * re.tail(elastic)) / t.damped.tail(elastic);
  body_time_ = time_;
  in_coordinates_ = false;
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

double SwitchedMotion::bodyEnergy(const Eigen::VectorXd& z, double time) const
{
  const Tables& t = now();
  const Eigen::Index modes = t.decay.size();
  const Eigen::Index half = z.size() / 2;
  double sum = 0.0;
  for (Eigen::Index n = 0; n < t.bodies; ++n)
  {
    double velocity = bodyVelocity(n, time);
    if (phasor_)
    {
      velocity -= drive_frequency_ * (t.transfer_im(n) * z(modes) + t.transfer_re(n) * z(half + modes));
    }
    sum += 0.5 * velocity * velocity;
  }
  return sum;
}

double SwitchedMotion::energy() const
{
  Eigen::VectorXd displacement;
  Eigen::VectorXd velocity;
  coordinates(displacement, velocity);
  return energy(state_, displacement, velocity);
}

double SwitchedMotion::energy(int state, const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity) const
{
  const LinearState& linear = linearState(state);
  double sum = 0.5 * (velocity.squaredNorm() + (linear.frequency * displacement.array()).matrix().squaredNorm());
  if (state == 1)
  {
    // The spring's 1/2 k g^2 with g = clearance + d.eta: its quadratic part is in the frequencies, its linear one is
    // the preload. Modes that are left out stand deflected by the preload.
    sum +=
        -(linear.preload * displacement.array()).sum() + 0.5 * model_->stiffness() * model_->clearance() * linear.gap;
  }
  return sum;
}

void SwitchedMotion::rotate(Eigen::VectorXd& exponentials, int k) const
{
  const Tables& t = now();
  const Eigen::Index half = t.factor_re.rows();
  growBy(exponentials.data(), exponentials.data() + half, t.factor_re.data() + k * half, t.factor_im.data() + k * half,
         half);
}

void SwitchedMotion::rotateTicks(Eigen::VectorXd& exponentials, std::int64_t ticks) const
{
  for (auto rest = static_cast<std::uint64_t>(ticks); rest != 0; rest &= rest - 1)
  {
    rotate(exponentials, __builtin_ctzll(rest));
  }
}

void SwitchedMotion::evaluate(const Eigen::VectorXd& exponentials, double time, double& gap, double& rate) const
{
  const Tables& t = now();
  const Eigen::Index size = exponentials.size();
  gap = lineGap(time) + dot(t.derivative.data() + size, exponentials.data(), size);
  rate = lineRate(time) + dot(t.derivative.data() + 2 * size, exponentials.data(), size);
}

double SwitchedMotion::derivative(int order) const
{
  const Tables& t = now();
  const double body = order == 2 ? -t.body_pull * acceleration(time_) : order == 3 ? -t.body_pull * slope_ : 0.0;
  return body + t.derivative.col(order + 1).dot(vectors().exponentials);
}

void SwitchedMotion::evaluate()
{
  evaluate(vectors().exponentials, time_, gap_, rate_);
}

double SwitchedMotion::boundOfDerivative(int order) const
{
  return boundOfDerivative(order, vectors().exponentials);
}

double SwitchedMotion::boundOfDerivative(int order, const Eigen::VectorXd& z) const
{
  const Eigen::Index half = z.size() / 2;
  return now().magnitude.col(order).dot(
      (z.head(half).array().square() + z.tail(half).array().square()).sqrt().matrix());
}

void SwitchedMotion::refreshBound()
{
  const Tables& t = now();
  bound_ = boundOfDerivative(2);
  double terms = std::abs(model_->clearance()) + std::abs(t.line_constant) + std::abs(t.line_compliance) * farthest_ +
                 std::abs(t.line_lag * slope_) + boundOfDerivative(0);
  if (t.gap_body >= 0)
  {
    const Eigen::VectorXd& z = vectors().exponentials;
    const double left = length_ - body_time_;
    terms += std::abs(t.body_deflection) * (std::abs(z(t.gap_body)) + left * std::abs(z(z.size() / 2 + t.gap_body))) +
             0.5 * left * left * bodyBound(2);
  }
  resolution_ = gap_rounding * terms;
}

// ---------------------------------------------------------------------------------------------------------------------
// Advancing

void SwitchedMotion::advanceLinear(double from, double to, ImpactSink& sink)
{
  const double slope = (to - from) * inverse_length_;
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
    now().energy.pass(change, slope_, length_);
    slope_ = slope;
    bound_ += std::abs(change) * now().kick_bound;
  }
  advanceInterval(change, sink);
}

void SwitchedMotion::advanceHarmonic(ImpactSink& sink)
{
  time_ = body_time_ = 0.0;
  // The phasor starts every cycle anew, so that its rounding cannot add up: a = Re D = -amplitude cos(Omega t).
  for (Vectors& v : vectors_)
  {
    const Eigen::Index half = v.exponentials.size() / 2;
    v.exponentials(v.displacement.size()) = -drive_amplitude_;
    v.exponentials(half + v.displacement.size()) = 0.0;
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
  refreshBound();
  openSpan();
  if (state_ == 1)
  {
    openIntegrals();
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// The history

HistorySample SwitchedMotion::sample() const
{
  Eigen::VectorXd displacement;
  Eigen::VectorXd velocity;
  coordinates(displacement, velocity);
  HistorySample sample;
  describe(0.0, gap_, rate_, displacement, velocity, sample);
  if (!in_coordinates_)
  {
    enter(now().energy.upTo(vectors().exponentials, moment(vectors().exponentials, time_)), sample.energy);
  }
  sample.acceleration = phasor_ ? -drive_amplitude_ : acceleration(time_);
  return sample;
}

void SwitchedMotion::describe(double time, double gap, double rate, const Eigen::VectorXd& displacement,
                              const Eigen::VectorXd& velocity, HistorySample& sample) const
{
  sample.time = static_cast<double>(intervals_) * length_ + time;
  sample.gap = gap;
  sample.gap_velocity = rate;
  sample.force = force(gap);
  sample.in_contact = inContact();
  sample.energy = account_;
  storeEnergy(displacement, velocity, gap, sample.energy);
}

// ---------------------------------------------------------------------------------------------------------------------
// The energy account

void SwitchedMotion::openAccount()
{
  account_ = EnergyAccount();
  storeEnergy(vectors().displacement, vectors().velocity, gap_, account_);
  account_.initial = account_.turnover = account_.stored();
}

SpanEnergy::Moment SwitchedMotion::moment(const Eigen::VectorXd& exponentials, double time) const
{
  SpanEnergy::Moment moment;
  moment.acceleration = acceleration(time);
  moment.slope = slope_;
  moment.time = time;
  moment.body_energy = bodyEnergy(exponentials, time);
  if (phasor_)
  {
    const Eigen::Index modes = now().decay.size();
    moment.drive_re = exponentials(modes);
    moment.drive_im = exponentials(exponentials.size() / 2 + modes);
    moment.time += static_cast<double>(span_intervals_) * length_;
  }
  return moment;
}

void SwitchedMotion::openSpan()
{
  span_intervals_ = 0;
  const Eigen::VectorXd& z = vectors().exponentials;
  now().energy.open(z, moment(z, time_));
}

void SwitchedMotion::closeSpan()
{
  const Eigen::VectorXd& z = vectors().exponentials;
  const SpanEnergy::Amounts amounts = now().energy.upTo(z, moment(z, time_));
  enter(amounts, account_);
  if (state_ == 1)
  {
    episode_.impact.base_work += amounts.work;
    episode_.impact.dissipated += amounts.dissipated;
  }
}

void SwitchedMotion::enter(const SpanEnergy::Amounts& amounts, EnergyAccount& account) const
{
  account.work += amounts.work;
  (state_ == 0 ? account.dissipated_free : account.dissipated_contact) += amounts.dissipated;
  account.turnover += std::abs(amounts.work) + std::abs(amounts.dissipated);
}

void SwitchedMotion::storeEnergy(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity, double gap,
                                 EnergyAccount& account) const
{
  const auto energy = [&](int structure)
  {
    const StructureEnergy& share = state_ == 0 ? model_->freeEnergy(structure) : model_->contactEnergy(structure);
    return share.energy(displacement, velocity);
  };
  account.structure1 = energy(1);
  account.structure2 = energy(2);
  account.spring = state_ == 0 ? 0.0 : 0.5 * model_->stiffness() * gap * gap;
  // What is in the total, energy(), besides.
  const double standing_gap = linearState(state_).gap;
  account.left_out = model_->stiffness() * (model_->clearance() - standing_gap) * (gap - 0.5 * standing_gap);
}

void SwitchedMotion::recordHistory(HistorySample* samples, std::size_t per_interval)
{
  history_ = samples;
  history_size_ = per_interval;
}

void SwitchedMotion::beginHistoryPiece()
{
  vectors().history = vectors().exponentials;
  history_start_ = time_;
}

void SwitchedMotion::takeHistory()
{
  Vectors& v = vectors();
  const auto sample_time = [this](std::size_t number)
  { return length_ * (static_cast<double>(number) / static_cast<double>(history_size_)); };
  for (; history_taken_ + 1 < history_size_ && sample_time(history_taken_ + 1) <= time_; ++history_taken_)
  {
    const double time = sample_time(history_taken_ + 1);
    v.trial = v.history;
    rotateTicks(v.trial, static_cast<std::int64_t>(std::llround((time - history_start_) / tick_)));
    HistorySample& sample = *history_++;
    double gap = 0.0;
    double rate = 0.0;
    evaluate(v.trial, time, gap, rate);
    coordinates(v.trial, time, v.displacement, v.velocity);
    describe(time, gap, rate, v.displacement, v.velocity, sample);
    enter(now().energy.upTo(v.trial, moment(v.trial, time)), sample.energy);
    sample.acceleration = v.trial(v.displacement.size());
  }
}

void SwitchedMotion::endHistoryInterval()
{
  Vectors& v = vectors();
  HistorySample& sample = *history_++;
  coordinates(v.exponentials, time_, v.displacement, v.velocity);
  describe(0.0, gap_, rate_, v.displacement, v.velocity, sample);
  enter(now().energy.upTo(v.exponentials, moment(v.exponentials, time_)), sample.energy);
  sample.acceleration = -drive_amplitude_;
  history_taken_ = 0;
}

// ---------------------------------------------------------------------------------------------------------------------

void SwitchedMotion::advanceInterval(double slope_change, ImpactSink& sink)
{
  Vectors& v = vectors();
  Tables& t = now();
  if (state_ == 1)
  {
    v.before = v.exponentials;
    if (slope_change != 0.0)
    {
      addScaled(v.before.data(), slope_change, t.kick.data(), t.kick.size());
      episode_.gap_integral -= slope_change * t.kick_gap_integral;
    }
    beginPiece();
  }
  if (history_ != nullptr)
  {
    beginHistoryPiece();
  }
  const double distance = side() * gap_;
  const double reach = distance + side() * rate_ * length_ - 0.5 * curvatureBound() * length_ * length_;
  if (distance >= 0.0 && reach >= 0.0)
  {
    const double gap_before = gap_;
    const double rate_before = rate_;
    const Eigen::Index half = t.factor_re.rows();
    const Forms forms = kickGrowEvaluate(v.exponentials.data(), t.energy.kicks(), slope_change, t.kick.data(),
                                         t.factor_re.data() + doublings_ * half, t.factor_im.data() + doublings_ * half,
                                         t.derivative.data() + 2 * half, t.derivative.data() + 4 * half, half);
    time_ = length_;
    gap_ = lineGap(time_) + forms.first;
    rate_ = lineRate(time_) + forms.second;
    if (state_ == 1)
    {
      watchPeak(0.0, std::int64_t{1} << doublings_, gap_before, rate_before);
    }
  }
  else
  {
    addScaled(t.energy.kicks(), slope_change, v.exponentials.data(), v.exponentials.size());
    addScaled(v.exponentials.data(), slope_change, t.kick.data(), t.kick.size());
    locateSwitches(sink);
    time_ = length_;
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

/// Moves on by `ticks` from `time`, and watches the peak of the force on the way.
void SwitchedMotion::step(std::int64_t ticks, double time)
{
  const double gap_before = gap_;
  const double rate_before = rate_;
  if (state_ == 1)
  {
    vectors().before = vectors().exponentials;
  }
  rotateTicks(vectors().exponentials, ticks);
  time_ = time + static_cast<double>(ticks) * tick_;
  evaluate();
  if (state_ == 1)
  {
    watchPeak(time, ticks, gap_before, rate_before);
  }
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
  const std::int64_t total = std::int64_t{1} << doublings_;
  std::int64_t tick = 0;
  std::int64_t smallest = 1;
  std::int64_t switches = 0;
  int steps = 0;
  bool settled = false;  // the state was decided, and the gap could not be told from zero since
  std::int64_t settled_at = 0;
  refreshBound();
  while (tick < total)
  {
    const std::int64_t left = total - tick;
    const double time = static_cast<double>(tick) * tick_;
    if (switches >= switch_limit_ && state_ == 1)
    {
      ++switch_limit_reached_;
      step(left, time);
      break;
    }
    ++steps_total_;
    const bool has_crossed = crossed();
    settled = settled && (tick == settled_at || std::abs(gap_) <= resolution_);
    std::int64_t ticks = has_crossed ? 0 : safeTicks(left);
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
    if (++steps % steps_before_coarser == 0)
    {
      smallest *= 2;
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
      v.trial = v.exponentials;
      rotateTicks(v.trial, ticks);
      double gap = 0.0;
      double rate = 0.0;
      evaluate(v.trial, time + static_cast<double>(ticks) * tick_, gap, rate);
      if (ticks > 1 && side() * gap < -resolution_)
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
    switchState(length_, sink);
  }
}

/// How many of the `left` ticks can be made without a switch; at least 1, or 0 where the state must be switched now.
std::int64_t SwitchedMotion::safeTicks(std::int64_t left)
{
  const double distance = std::max(0.0, side() * gap_);
  const double rate = side() * rate_;
  double time = earliestZero(distance, rate, curvatureBound());
  if (onWrongSide())
  {
    // On its way back. The gap makes a switch only where it turns round: a zero of the rate.
    time = earliestZero(rate, side() * derivative(2), boundOfDerivative(3) + bodyBound(3));
  }
  else if (distance <= resolution_ && time < 65536.0 * tick_ && hasNoRate())
  {
    return departureTicks(left);
  }
  const double ticks = time / tick_;
  if (ticks >= static_cast<double>(left))
  {
    return left;
  }
  const std::int64_t safe = std::max<std::int64_t>(1, threeHighestBits(static_cast<std::int64_t>(ticks)));
  if (distance <= resolution_ && rate < 0.0)
  {
    // At the root as far as the gap can be told from zero: on to where it can.
    const double through = 1.5 * (distance + resolution_) / (-rate * tick_);
    return std::clamp(static_cast<std::int64_t>(std::min(through, most_ticks_through)), safe, left);
  }
  return safe;
}

/// Whether the velocity is zero as far as the gap can tell: the acceleration turns it before it takes the gap further
/// than its rounding error.
bool SwitchedMotion::hasNoRate() const
{
  return rate_ * rate_ <= 2.0 * resolution_ * std::max(std::abs(derivative(2)), derivative_rounding * curvatureBound());
}

/// At gap zero with zero velocity the first derivative that is not zero decides: away from contact (no switch) or into
/// it. With the derivative D of order k and the bound B of the next one the gap keeps its sign for  (k + 1) |D|/B; half
/// of that is made.
std::int64_t SwitchedMotion::departureTicks(std::int64_t left)
{
  for (int order = 2; order <= highest_derivative; ++order)
  {
    const double inward = side() * derivative(order);
    if (std::abs(inward) > derivative_rounding * (boundOfDerivative(order) + bodyBound(order)))
    {
      if (inward < 0.0)
      {
        return 0;
      }
      const double next = boundOfDerivative(order + 1) + bodyBound(order + 1);
      const double ticks = 0.5 * (order + 1) * inward / (next * tick_);
      return ticks >= static_cast<double>(left)
                 ? left
                 : std::max<std::int64_t>(1, threeHighestBits(static_cast<std::int64_t>(ticks)));
    }
  }
  return left;  // nothing moves
}

void SwitchedMotion::switchState(double time, ImpactSink& sink)
{
  // The motion is past the root by a few ticks; in the conjoined basis a jump of the gap may have put it anywhere.
  const double overrun = gap_ / rate_;
  const double late = overrun > 0.0 && overrun <= most_ticks_through * tick_ ? overrun : 0.0;
  const double speed = std::abs(rate_ - late * derivative(2));
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
  toCoordinates();
  double mapping_loss = model_->lossless() ? 0.0 : energy(state_, from.displacement, from.velocity);
  const Eigen::Index from_half = from.exponentials.size() / 2;

  state_ = 1 - state_;
  Vectors& to = vectors();
  if (state_ == 1)
  {
    to.displacement.noalias() = model_->mapping().transpose() * from.displacement;
    to.velocity.noalias() = model_->mapping().transpose() * from.velocity;
  }
  else
  {
    to.displacement.noalias() = model_->mapping() * from.displacement;
    to.velocity.noalias() = model_->mapping() * from.velocity;
  }
  if (phasor_)
  {
    const Eigen::Index half = to.exponentials.size() / 2;
    to.exponentials(to.displacement.size()) = from.exponentials(from.displacement.size());
    to.exponentials(half + to.displacement.size()) = from.exponentials(from_half + from.displacement.size());
  }
  if (!model_->lossless())
  {
    mapping_loss -= energy(state_, to.displacement, to.velocity);
    account_.mapping_loss += mapping_loss;
    account_.turnover += std::abs(mapping_loss);
  }
  toExponentials();
  evaluate();
  refreshBound();
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

// ---------------------------------------------------------------------------------------------------------------------
// The contact episode

void SwitchedMotion::beginEpisode(double offset, double elapsed, double approach_speed)
{
  episode_ = Episode();
  episode_.impact.interval = intervals_;
  episode_.impact.offset = offset;
  episode_.impact.approach_speed = approach_speed;
  episode_.elapsed = elapsed;
  episode_.smallest_gap = gap_;
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
  const Tables& t = now();
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
  const double peak_force = -model_->stiffness() * episode_.smallest_gap;
  if (peak_force > impact.peak_force)
  {
    impact.peak_force = peak_force;
    impact.peak_time = std::max(0.0, episode_.smallest_gap_time);
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

void SwitchedMotion::notePeak(double gap, double time)
{
  if (gap < episode_.smallest_gap)
  {
    episode_.smallest_gap = gap;
    episode_.smallest_gap_time = episode_.elapsed + (time - episode_.piece_start);
  }
}

void SwitchedMotion::watchPeak(double start, std::int64_t ticks, double gap_before, double rate_before)
{
  notePeak(gap_, time_);
  refinePeak(start, GapSample{0, gap_before, rate_before}, GapSample{ticks, gap_, rate_}, DerivativeBounds{}, 0);
}

/// Finds a gap smaller than any so far between two samples of the step that began at `start`, if there is one.
void SwitchedMotion::refinePeak(double start, const GapSample& from, const GapSample& to, DerivativeBounds bounds,
                                int depth)
{
  // With |g''| <= B the gap lies above a parabola through each end, with its value and slope there. They meet where
  //   g_0 + g_0' t - B t^2/2 = g_1 - g_1' (w - t) - B (w - t)^2/2.
  const double width = static_cast<double>(to.tick - from.tick) * tick_;
  const double slope = from.rate - to.rate - bound_ * width;
  const double meeting =
      slope < 0.0 ? (to.gap - from.gap - to.rate * width - 0.5 * bound_ * width * width) / slope : 0.0;
  const double t = std::clamp(meeting, 0.0, width);
  const double lowest = from.gap + from.rate * t - 0.5 * bound_ * t * t;
  constexpr double tolerance = 1.0e-10;
  constexpr int deepest = 48;
  if (lowest >= episode_.smallest_gap - tolerance * std::abs(episode_.smallest_gap) || to.tick - from.tick < 2 ||
      depth == deepest)
  {
    return;
  }

  Vectors& v = vectors();
  const auto sample = [&](std::int64_t tick)
  {
    ++peak_evaluations_;
    v.trial = v.before;
    rotateTicks(v.trial, tick);
    GapSample result{tick, 0.0, 0.0};
    const double time = start + static_cast<double>(tick) * tick_;
    evaluate(v.trial, time, result.gap, result.rate);
    notePeak(result.gap, time);
    return result;
  };
  const auto derivative = [&](int order) { return now().derivative.col(order + 1).dot(v.trial); };

  if (depth == 0)
  {
    bounds = DerivativeBounds{boundOfDerivative(3, v.before), boundOfDerivative(highest_derivative, v.before)};
  }
  const bool minimum_inside = from.rate < 0.0 && to.rate > 0.0;
  // Linear interpolation of the rate alone may go on moving one end only: every other time the middle.
  const double fraction = minimum_inside && depth % 2 == 0 ? from.rate / (from.rate - to.rate) : 0.5;
  const std::int64_t range = to.tick - from.tick;
  const std::int64_t chosen =
      std::clamp<std::int64_t>(static_cast<std::int64_t>(fraction * static_cast<double>(range)), 1, range - 1);
  GapSample middle = sample(from.tick + chosen);

  // How far rate and curvature can be from those of the middle, anywhere up to the farther end: by Taylor's theorem,
  // with a bound of the third derivative or, where the terms of the lower ones cancel, of the highest. They cancel at
  // the start from rest and between beams much alike.
  const double farthest = static_cast<double>(std::max(chosen, range - chosen)) * tick_;
  double curvature = derivative(2);
  double curvature_change = bounds.third * farthest;
  double rate_change = 0.5 * curvature_change * farthest;
  const auto monotonous = [&] { return std::abs(middle.rate) > std::abs(curvature) * farthest + rate_change; };
  if (curvature <= curvature_change && !monotonous())
  {
    curvature_change = rate_change = 0.0;
    double power = 1.0;  // farthest^(order - 2)/(order - 2)!
    for (int order = 3; order <= highest_derivative; ++order)
    {
      power *= farthest / (order - 2);
      const double size = order < highest_derivative ? std::abs(derivative(order)) : bounds.highest;
      curvature_change += size * power;
      rate_change += size * power * farthest / (order - 1);
    }
  }
  if (monotonous())  // no minimum but at the ends
  {
    return;
  }
  if (curvature > curvature_change)  // convex throughout: no more than one minimum
  {
    for (int iteration = 0; minimum_inside && iteration < 8; ++iteration)
    {
      const double correction = -middle.rate / curvature;
      const double gain = -0.5 * middle.rate * correction;
      if (gain <= 1.0e-9 * std::abs(middle.gap) || std::abs(correction) < tick_)
      {
        notePeak(middle.gap - gain, start + static_cast<double>(middle.tick) * tick_ + correction);
        break;
      }
      const std::int64_t next = middle.tick + static_cast<std::int64_t>(correction / tick_);
      middle = sample(std::clamp(next, from.tick, to.tick));
      curvature = derivative(2);
    }
    return;
  }
  refinePeak(start, from, middle, bounds, depth + 1);
  refinePeak(start, middle, to, bounds, depth + 1);
}

}  // namespace vibro_impact::core
