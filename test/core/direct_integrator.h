#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
/// The undamped structures in their free modes, with the spring as a force -k g while g < 0: no second state, no
/// mapping, no preload vector, no located switch. Runge-Kutta steps whose error is kept below 1e-12.
class DirectIntegrator
{
public:
  explicit DirectIntegrator(std::shared_ptr<const SwitchedModel> model)
      : model_(std::move(model)), state_(2 * static_cast<std::size_t>(model_->free().size()) + 1)
  {
  }

  void setDisplacement(const Eigen::VectorXd& displacement)
  {
    std::copy(displacement.data(), displacement.data() + displacement.size(), state_.begin());
  }

  /// Another contact from now on.
  void setModel(std::shared_ptr<const SwitchedModel> model)
  {
    model_ = std::move(model);
  }

  /// Over `duration` in which the base acceleration is `acceleration` of the time since its start.
  void advance(double duration, const std::function<double(double)>& acceleration)
  {
    namespace odeint = boost::numeric::odeint;
    const LinearState& free = model_->free();
    const auto size = static_cast<std::size_t>(free.size());
    const auto equations = [&](const std::vector<double>& x, std::vector<double>& dxdt, double time)
    {
      const double now = force(x);
      const double a = acceleration(time);
      for (std::size_t n = 0; n < size; ++n)
      {
        const auto i = static_cast<Eigen::Index>(n);
        dxdt[n] = x[size + n];
        dxdt[size + n] = -free.frequency(i) * free.frequency(i) * x[n] - free.participation(i) * a +
                         free.contact_deflection(i) * now;
      }
      dxdt[2 * size] = now;
    };
    odeint::integrate_adaptive(
        odeint::make_controlled<odeint::runge_kutta_fehlberg78<std::vector<double>>>(1.0e-19, 1.0e-12), equations,
        state_, 0.0, duration, std::min(duration, 0.05 / free.frequency.maxCoeff()));
  }

  double gap() const
  {
    return gap(state_);
  }
  double force() const
  {
    return force(state_);
  }
  /// Integral of the contact force since the start, N s.
  double impulse() const
  {
    return state_.back();
  }

private:
  double gap(const std::vector<double>& x) const
  {
    const LinearState& free = model_->free();
    double sum = model_->clearance();
    for (Eigen::Index n = 0; n < free.size(); ++n)
    {
      sum += free.contact_deflection(n) * x[static_cast<std::size_t>(n)];
    }
    return sum;
  }
  double force(const std::vector<double>& x) const
  {
    return std::max(0.0, -model_->stiffness() * gap(x));
  }

  std::shared_ptr<const SwitchedModel> model_;
  std::vector<double> state_;  // displacements, velocities, impulse
};
}  // namespace vibro_impact::core
