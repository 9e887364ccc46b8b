#include "vibro_impact/ros/stream_simulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "text.h"

namespace vibro_impact::graph
{
StreamSimulation::StreamSimulation(std::shared_ptr<const core::SwitchedModel> model, const StreamLimits& limits)
    : model_(std::move(model)), rules_(limits), max_cycles_per_sample_(limits.max_cycles_per_sample)
{
}

void StreamSimulation::setContact(std::shared_ptr<const core::SwitchedModel> model, std::uint64_t seq)
{
  if (rules_.started() && seq != 0 && seq < rules_.nextSeq())
  {
    throw std::invalid_argument(
        text("seq: ", seq, " has been simulated; allowed: 0, the next sample, or at least ", rules_.nextSeq()));
  }
  if (waiting_.size() >= max_waiting_changes && waiting_.count(seq) == 0)
  {
    throw std::invalid_argument(
        text("seq: ", seq, " would be one change too many that waits; allowed: ", max_waiting_changes, " of them"));
  }
  waiting_[seq] = std::move(model);
}

const StreamSimulation::Answer& StreamSimulation::advance(const Samples& excitation)
{
  clearAnswer();
  answer_.verdict = rules_.judge(excitation);
  const double longest = longestPeriod();
  if (answer_.verdict.action != Verdict::Action::Refuse && excitation.sample_period > longest)
  {
    answer_.verdict = {Verdict::Action::Refuse, 0,
                       text("sample_period is ", excitation.sample_period, " s, must be at most ", longest,
                            " s, which are ", max_cycles_per_sample_, " cycles of the model's highest mode")};
  }
  const Verdict::Action action = answer_.verdict.action;
  if (action == Verdict::Action::Refuse)
  {
    return answer_;
  }

  bool changed = false;
  if (action == Verdict::Action::Start || action == Verdict::Action::Restart)
  {
    rest();  // an open episode is dated on the old stream
    changed = takeContact(excitation.seq);
    if (!simulation_ || changed || simulation_->samplePeriod() != excitation.sample_period)
    {
      simulation_.emplace(model_, excitation.sample_period);
    }
    first_seq_ = excitation.seq;
    carried_over_ = false;
    greatest_force_ = 0.0;
    if (observer_ != nullptr)
    {
      observer_->onStart(excitation.stamp, excitation.sample_period);
    }
  }

  const std::uint64_t switch_limits = simulation_->switchLimitReached();
  const bool was_in_contact = simulation_->inContact();
  const std::size_t cut_short = answer_.impacts.size();
  const double last_sample = rules_.lastSample();
  const std::uint64_t next = rules_.nextSeq();
  rules_.take(excitation, action, carried_over_);
  if (changed)
  {
    noteContactChange(excitation.seq);
  }

  if (action == Verdict::Action::Bridge)
  {
    bridge(next, answer_.verdict.missing, last_sample, excitation.values.front());
  }
  const std::size_t count = excitation.values.size();
  for (Samples* answer : {&answer_.gap, &answer_.force})
  {
    answer->stamp = excitation.stamp;
    answer->seq = excitation.seq;
    answer->sample_period = excitation.sample_period;
    answer->values.resize(count);
  }
  advanceSamples(excitation.seq, excitation.values.data(), count, answer_.gap.values.data(),
                 answer_.force.values.data());

  carried_over_ = was_in_contact && simulation_->inContact() && answer_.impacts.size() == cut_short;
  answer_.switch_limits = simulation_->switchLimitReached() - switch_limits;
  return answer_;
}

const StreamSimulation::Answer& StreamSimulation::reset()
{
  clearAnswer();
  rest();
  return answer_;
}

void StreamSimulation::rest()
{
  // A preloaded contact at rest is an open episode, too: before a stream has begun there is nothing to cut short.
  if (rules_.started())
  {
    simulation_->reset(*this);
    rules_.forget();
  }
}

/// s
double StreamSimulation::longestPeriod() const
{
  constexpr double two_pi = 6.283185307179586;
  const double highest = std::max(model_->free().frequency.maxCoeff(), model_->contact().frequency.maxCoeff());
  return two_pi * max_cycles_per_sample_ / highest;
}

core::EnergyAccount StreamSimulation::energyAccount() const
{
  return simulation_ ? simulation_->energyAccount() : core::EnergyAccount();
}

void StreamSimulation::onImpact(const core::Impact& impact)
{
  if (observer_ != nullptr)
  {
    observer_->onImpact(impact);
  }
  StampedImpact stamped{impact, 0};
  stamped.impact.interval += first_seq_;
  stamped.stamp = rules_.clock().at(stamped.impact.interval) + std::llround(impact.offset * 1.0e9);
  answer_.impacts.push_back(stamped);
}

/// Advances over samples of which the first has the number `seq`, and takes the changes of the contact on the way.
void StreamSimulation::advanceSamples(std::uint64_t seq, const double* acceleration, std::size_t count, double* gap,
                                      double* force)
{
  while (count > 0)
  {
    if (takeContact(seq))
    {
      simulation_->setModel(model_, *this);
      noteContactChange(seq);
    }
    std::uint64_t piece = count;
    if (!waiting_.empty())
    {
      piece = std::min(piece, waiting_.begin()->first - seq);
    }
    if (motion_step_ > 0)
    {
      piece = std::min(piece, untilRow(seq) + 1);
    }
    take(acceleration, piece, gap, force);
    if (motion_step_ > 0)
    {
      greatest_force_ = std::max(greatest_force_, *std::max_element(force, force + piece));
      if (untilRow(seq) + 1 == piece)
      {
        recordRow(seq + piece - 1, gap[piece - 1], acceleration[piece - 1]);
      }
    }
    seq += piece;
    acceleration += piece;
    gap += piece;
    force += piece;
    count -= piece;
  }
}

/// How many samples lie before the next one with a row, `seq` or one after it.
std::uint64_t StreamSimulation::untilRow(std::uint64_t seq) const
{
  const std::uint64_t past = seq % motion_step_;
  return past == 0 ? 0 : motion_step_ - past;
}

void StreamSimulation::recordRow(std::uint64_t seq, double gap, double acceleration)
{
  Motion& motion = answer_.motion;
  if (motion.gap.empty())
  {
    motion.step = motion_step_;
    motion.seq = seq;
    motion.stamp = rules_.clock().at(seq);
  }
  simulation_->structureCoordinates(coordinates_);
  motion.coordinates.insert(motion.coordinates.end(), coordinates_.data(), coordinates_.data() + coordinates_.size());
  motion.gap.push_back(gap);
  motion.force.push_back(greatest_force_);
  motion.acceleration.push_back(acceleration);
  greatest_force_ = 0.0;
}

/// Whether another contact holds from sample `seq` on; then it is model_ from now on.
bool StreamSimulation::takeContact(std::uint64_t seq)
{
  std::shared_ptr<const core::SwitchedModel> model = model_;
  while (!waiting_.empty() && waiting_.begin()->first <= seq)
  {
    model = waiting_.begin()->second;
    waiting_.erase(waiting_.begin());
  }
  std::swap(model, model_);
  return model->stiffness() != model_->stiffness() || model->clearance() != model_->clearance();
}

void StreamSimulation::noteContactChange(std::uint64_t seq)
{
  answer_.contact_changes.push_back({seq, rules_.clock().at(seq), model_});
}

void StreamSimulation::take(const double* acceleration, std::size_t count, double* gap, double* force)
{
  if (observer_ == nullptr)
  {
    simulation_->advance(acceleration, count, gap, force, *this);
    return;
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    simulation_->advance(acceleration + i, 1, gap + i, force + i, *this);
    observer_->onSample(simulation_->sample());
  }
}

void StreamSimulation::bridge(std::uint64_t seq, std::uint64_t missing, double from, double to)
{
  constexpr std::uint64_t chunk = 256;
  std::array<double, chunk> acceleration;
  std::array<double, chunk> gap;
  std::array<double, chunk> force;
  const double slope = (to - from) / static_cast<double>(missing + 1);
  for (std::uint64_t first = 0; first < missing; first += chunk)
  {
    const std::uint64_t count = std::min(chunk, missing - first);
    for (std::uint64_t i = 0; i < count; ++i)
    {
      acceleration[i] = from + slope * static_cast<double>(first + i + 1);
    }
    advanceSamples(seq + first, acceleration.data(), count, gap.data(), force.data());
  }
}

void StreamSimulation::clearAnswer()
{
  answer_.verdict = {};
  answer_.gap.values.clear();
  answer_.force.values.clear();
  answer_.impacts.clear();
  answer_.contact_changes.clear();
  answer_.motion.coordinates.clear();
  answer_.motion.gap.clear();
  answer_.motion.force.clear();
  answer_.motion.acceleration.clear();
  answer_.switch_limits = 0;
}

}  // namespace vibro_impact::graph
