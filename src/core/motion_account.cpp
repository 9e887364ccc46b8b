// Of SwitchedMotion: energies and the history.

#include <cmath>

#include "switched_motion.h"

namespace vibro_impact::core
{
/// What the change does to the spring is work from outside. A truncated mapping takes its share of the structures'.
void SwitchedMotion::takeOverAccount(const SwitchedMotion& previous)
{
  EnergyAccount before;
  previous.storeEnergy(before);
  account_ = previous.account_;
  storeEnergy(account_);
  const double contact_work = account_.spring + account_.left_out - before.spring - before.left_out;
  const double mapping_loss =
      model_->lossless() ? 0.0 : before.structure1 + before.structure2 - account_.structure1 - account_.structure2;
  account_.contact_work += contact_work;
  account_.mapping_loss += mapping_loss;
  account_.turnover += std::abs(contact_work) + std::abs(mapping_loss);
}

double SwitchedMotion::bodyEnergy(const Eigen::VectorXd& z, double time) const
{
  const StateTables& t = now();
  const Eigen::Index modes = t.modes();
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
  return energy(displacement, velocity);
}

double SwitchedMotion::energy(const Eigen::Ref<const Eigen::VectorXd>& displacement,
                              const Eigen::Ref<const Eigen::VectorXd>& velocity) const
{
  const LinearState& linear = linearState(state_);
  double sum = 0.5 * (velocity.squaredNorm() + (linear.frequency * displacement.array()).matrix().squaredNorm());
  if (state_ == 1)
  {
    // The spring's 1/2 k g^2 with g = clearance + d.eta: its quadratic part is in the frequencies, its linear one is
    // the preload. Modes that are left out stand deflected by the preload.
    sum +=
        -(linear.preload * displacement.array()).sum() + 0.5 * model_->stiffness() * model_->clearance() * linear.gap;
  }
  return sum;
}

HistorySample SwitchedMotion::sample() const
{
  Eigen::VectorXd displacement;
  Eigen::VectorXd velocity;
  coordinates(displacement, velocity);
  HistorySample sample;
  describe(0.0, gap_, gapRate(), displacement, velocity, sample);
  if (!in_coordinates_)
  {
    enter(now().energy.upTo(vectors().exponentials, moment(vectors().exponentials, time_)), sample.energy);
  }
  sample.acceleration = phasor_ ? -drive_amplitude_ : acceleration(time_);
  return sample;
}

void SwitchedMotion::describe(double time, double gap, double rate,
                              const Eigen::Ref<const Eigen::VectorXd>& displacement,
                              const Eigen::Ref<const Eigen::VectorXd>& velocity, HistorySample& sample) const
{
  sample.time = static_cast<double>(intervals_) * grid_.length + time;
  sample.gap = gap;
  sample.gap_velocity = rate;
  sample.force = force(gap);
  sample.in_contact = inContact();
  sample.energy = account_;
  storeEnergy(displacement, velocity, gap, sample.energy);
}

void SwitchedMotion::openAccount()
{
  account_ = EnergyAccount();
  storeEnergy(account_);
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
    const Eigen::Index modes = now().modes();
    moment.drive_re = exponentials(modes);
    moment.drive_im = exponentials(exponentials.size() / 2 + modes);
    moment.time += static_cast<double>(span_intervals_) * grid_.length;
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

void SwitchedMotion::storeEnergy(const Eigen::Ref<const Eigen::VectorXd>& displacement,
                                 const Eigen::Ref<const Eigen::VectorXd>& velocity, double gap,
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

/// Of the displacement and velocity that are held.
void SwitchedMotion::storeEnergy(EnergyAccount& account) const
{
  const Eigen::Index modes = linearState(state_).size();
  storeEnergy(vectors().displacement.head(modes), vectors().velocity.head(modes), gap_, account);
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
  { return grid_.length * (static_cast<double>(number) / static_cast<double>(history_size_)); };
  for (; history_taken_ + 1 < history_size_ && sample_time(history_taken_ + 1) <= time_; ++history_taken_)
  {
    const double time = sample_time(history_taken_ + 1);
    move(v.history, static_cast<std::int64_t>(std::llround((time - history_start_) / grid_.tick)), v.probe);
    HistorySample& sample = *history_++;
    const Moment here = distance(v.probe, time);
    const Eigen::Index modes = now().modes();
    convert(v.probe, time, v.displacement, v.velocity);
    describe(time, side() * here.value, side() * here.rate, v.displacement.head(modes), v.velocity.head(modes), sample);
    enter(now().energy.upTo(v.probe, moment(v.probe, time)), sample.energy);
    sample.acceleration = v.probe(modes);
  }
}

void SwitchedMotion::endHistoryInterval()
{
  HistorySample& sample = *history_++;
  const Eigen::Index modes = now().modes();
  toCoordinates();
  describe(0.0, gap_, rate_, vectors().displacement.head(modes), vectors().velocity.head(modes), sample);
  enter(now().energy.upTo(vectors().exponentials, moment(vectors().exponentials, time_)), sample.energy);
  sample.acceleration = -drive_amplitude_;
  history_taken_ = 0;
}

}  // namespace vibro_impact::core
