#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "common.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
/// A contact episode as the integrator finds it.
struct Episode
{
  double onset = 0.0;
  double duration = 0.0;
  double impulse = 0.0;
  double peak_force = 0.0;
  double approach_speed = 0.0;
  double separation_speed = 0.0;
  double energy_lost = 0.0;
};

/// The motion by an independent way: the modal equations of both states integrated in time steps by a Runge-Kutta
/// method, with impulse and dissipated energy as further unknowns, and the switches located by bisection of a step.
class Integrator
{
public:
  /// Starts in S0 with the given coordinates, or in S1 at rest where the structures are pressed together.
  Integrator(std::shared_ptr<const SwitchedModel> model, std::function<double(double)> drive)
      : model_(std::move(model)), drive_(std::move(drive))
  {
    for (const LinearState* linear : {&model_->free(), &model_->contact()})
    {
      longest_step_ = std::min(longest_step_, 0.12 * two_pi / linear->frequency.maxCoeff());
    }
  }

  void startFree(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity)
  {
    contact_ = false;
    setState(displacement, velocity);
  }

  void startAtRestInContact()
  {
    contact_ = true;
    const LinearState& s1 = model_->contact();
    setState((s1.preload / s1.frequency.square()).matrix(), Eigen::VectorXd::Zero(s1.size()));
    whole_ = false;
  }

  /// The drive must be smooth on the way.
  void advance(double end)
  {
    double step = longest_step_;
    while (time_ < end)
    {
      step = std::min({step, longest_step_, end - time_});
      const bool last = step == end - time_;
      State next(state_.size());
      const double start = time_;
      if (controlled_.try_step(std::cref(*this), state_, time_, next, step) ==
          boost::numeric::odeint::controlled_step_result::fail)
      {
        continue;
      }
      if (last)
      {
        time_ = end;
      }
      takeStep(start, time_ - start, next);
    }
  }

  bool inContact() const
  {
    return contact_;
  }
  Eigen::VectorXd displacement() const
  {
    return Eigen::Map<const Eigen::VectorXd>(state_.data(), linear().size());
  }
  double gap() const
  {
    return gap(state_);
  }
  const std::vector<Episode>& episodes() const
  {
    return episodes_;
  }

  /// The equations of motion: displacements, velocities, impulse, dissipated energy.
  void operator()(const std::vector<double>& x, std::vector<double>& dxdt, double time) const
  {
    const LinearState& s = linear();
    const auto size = static_cast<std::size_t>(s.size());
    const double acceleration = drive_(time);
    dxdt.resize(x.size());
    double dissipation = 0.0;
    for (std::size_t n = 0; n < size; ++n)
    {
      const auto i = static_cast<Eigen::Index>(n);
      const double damping = 2.0 * s.damping_ratio(i) * s.frequency(i) * x[size + n];
      dxdt[n] = x[size + n];
      dxdt[size + n] =
          -damping - s.frequency(i) * s.frequency(i) * x[n] - s.participation(i) * acceleration + s.preload(i);
      dissipation += damping * x[size + n];
    }
    dxdt[2 * size] = contact_ ? -model_->stiffness() * gap(x) : 0.0;
    dxdt[2 * size + 1] = dissipation;
  }

private:
  using State = std::vector<double>;
  using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<State>;
  using Checker = boost::numeric::odeint::default_error_checker<double, boost::numeric::odeint::range_algebra,
                                                                boost::numeric::odeint::default_operations>;

  const LinearState& linear() const
  {
    return contact_ ? model_->contact() : model_->free();
  }

  void setState(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity)
  {
    state_.assign(displacement.data(), displacement.data() + displacement.size());
    state_.insert(state_.end(), velocity.data(), velocity.data() + velocity.size());
    state_.insert(state_.end(), {0.0, 0.0});
  }

  double gap(const State& x) const
  {
    double sum = linear().gap;
    for (Eigen::Index n = 0; n < linear().size(); ++n)
    {
      sum += linear().contact_deflection(n) * x[static_cast<std::size_t>(n)];
    }
    return sum;
  }
  double rate(const State& x) const
  {
    double sum = 0.0;
    for (Eigen::Index n = 0; n < linear().size(); ++n)
    {
      sum += linear().contact_deflection(n) * x[static_cast<std::size_t>(linear().size() + n)];
    }
    return sum;
  }
  double energy() const
  {
    double sum = contact_ ? 0.5 * model_->stiffness() * model_->clearance() * linear().gap : 0.0;
    for (Eigen::Index n = 0; n < linear().size(); ++n)
    {
      const double eta = state_[static_cast<std::size_t>(n)];
      const double velocity = state_[static_cast<std::size_t>(linear().size() + n)];
      sum += 0.5 * velocity * velocity + 0.5 * std::pow(linear().frequency(n) * eta, 2.0) - linear().preload(n) * eta;
    }
    return sum;
  }

  /// The state a part of a step later.
  State at(double start, double step)
  {
    State x(state_.size());
    stepper_.do_step(std::cref(*this), state_, start, x, step);
    return x;
  }

  /// The shortest part of a step, no longer than `step`, after which `condition` holds.
  template <class Condition>
  double bisect(double start, double step, Condition condition)
  {
    double before = 0.0;
    double after = step;
    for (double middle = 0.5 * step; middle != before && middle != after; middle = 0.5 * (before + after))
    {
      (condition(at(start, middle)) ? after : before) = middle;
    }
    return after;
  }

  /// Takes over a step, or its part up to a switch.
  void takeStep(double start, double step, const State& next)
  {
    const double side = contact_ ? -1.0 : 1.0;
    const auto crossed = [&](const State& x) { return side * gap(x) < 0.0 && side * rate(x) < 0.0; };
    const auto returning = [&](const State& x) { return side * rate(x) >= 0.0; };
    double searched = step;
    State end = next;
    if (side * rate(state_) < 0.0 && returning(next))  // the gap has an extremum
    {
      searched = bisect(start, step, returning);
      end = at(start, searched * (1.0 - 1.0e-9));
    }
    if (contact_ && rate(state_) < 0.0 && rate(next) >= 0.0)
    {
      const double turn = bisect(start, step, [&](const State& x) { return rate(x) >= 0.0; });
      episode_.peak_force = std::max(episode_.peak_force, -model_->stiffness() * gap(at(start, turn)));
    }
    if (crossed(end))
    {
      const double part = bisect(start, searched, crossed);
      state_ = at(start, part);
      time_ = start + part;
      switchState();
      return;
    }
    state_ = next;
    if (contact_)
    {
      episode_.peak_force = std::max(episode_.peak_force, -model_->stiffness() * gap(state_));
    }
  }

  void switchState()
  {
    const Eigen::Index size = linear().size();
    const Eigen::VectorXd displacement = Eigen::Map<const Eigen::VectorXd>(state_.data(), size);
    const Eigen::VectorXd velocity = Eigen::Map<const Eigen::VectorXd>(state_.data() + size, size);
    const double speed = std::abs(rate(state_));
    const double before = energy();
    const Eigen::MatrixXd& mapping = model_->mapping();
    if (contact_)
    {
      episode_.duration = time_ - episode_.onset;
      episode_.impulse = state_[2 * static_cast<std::size_t>(size)];
      episode_.separation_speed = speed;
      episode_.energy_lost += state_[2 * static_cast<std::size_t>(size) + 1];
      contact_ = false;
      setState(mapping * displacement, mapping * velocity);
      episode_.energy_lost += before - energy();
      if (whole_)
      {
        episodes_.push_back(episode_);
      }
    }
    else
    {
      contact_ = true;
      setState(mapping.transpose() * displacement, mapping.transpose() * velocity);
      episode_ = Episode();
      episode_.onset = time_;
      episode_.approach_speed = speed;
      episode_.energy_lost = before - energy();
      whole_ = true;
    }
  }

  std::shared_ptr<const SwitchedModel> model_;
  std::function<double(double)> drive_;
  double longest_step_ = 1.0;
  bool contact_ = false;
  double time_ = 0.0;
  State state_;
  Stepper stepper_;
  boost::numeric::odeint::controlled_runge_kutta<Stepper> controlled_{Checker(1.0e-26, 1.0e-13)};
  Episode episode_;
  bool whole_ = true;  // the episode under way has been seen from its onset
  std::vector<Episode> episodes_;
};

}  // namespace vibro_impact::core
