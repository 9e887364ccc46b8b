// Boost.Odeint: Dormand-Prince 5 with dense output, and Fehlberg 7(8), each with control of the step.

#include <cmath>
#include <functional>
#include <vector>

#include <boost/numeric/odeint/integrate/max_step_checker.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/dense_output_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "march.h"
#include "peer.h"

namespace vibro_impact::peers
{
namespace
{
namespace odeint = boost::numeric::odeint;
using Values = std::vector<double>;

constexpr double first_step = 1.0e-3;  // of a cycle

struct System
{
  double frequency;
  const State* state;
  void operator()(const Values& y, Values& result, double time) const
  {
    derivative(*state, std::cos(frequency * time), y.data(), result.data());
  }
};

class DormandPrince
{
public:
  DormandPrince(const Problem& problem, double tolerance)
      : problem_(problem),
        system_{problem.drive_frequency, nullptr},
        stepper_(odeint::make_dense_output(tolerance, 0.0, odeint::runge_kutta_dopri5<Values>())),
        values_(static_cast<std::size_t>(2 * problem.mapping.rows()))
  {
  }
  void reset()
  {
    length_ = first_step * problem_.cycle;
  }
  void start(int state, double time, const Vector& y)
  {
    system_.state = &problem_.states[static_cast<std::size_t>(state)];
    values_.assign(y.data(), y.data() + y.size());
    stepper_.initialize(values_, time, length_);
  }
  bool step()
  {
    stepper_.do_step(std::cref(system_));
    length_ = stepper_.current_time_step();
    return true;
  }
  double time() const
  {
    return stepper_.current_time();
  }
  const double* y() const
  {
    return stepper_.current_state().data();
  }
  void reach(double time, Vector& y)
  {
    stepper_.calc_state(time, values_);
    y = VectorView(values_.data(), y.size());
  }

private:
  const Problem& problem_;
  System system_;
  odeint::result_of::make_dense_output<odeint::runge_kutta_dopri5<Values>>::type stepper_;
  Values values_;
  double length_ = 0.0;
};

class Fehlberg78
{
public:
  Fehlberg78(const Problem& problem, double tolerance)
      : problem_(problem),
        system_{problem.drive_frequency, nullptr},
        stepper_(odeint::make_controlled(tolerance, 0.0, odeint::runge_kutta_fehlberg78<Values>())),
        values_(static_cast<std::size_t>(2 * problem.mapping.rows())),
        before_(values_.size())
  {
  }
  void reset()
  {
    length_ = first_step * problem_.cycle;
  }
  void start(int state, double time, const Vector& y)
  {
    system_.state = &problem_.states[static_cast<std::size_t>(state)];
    values_.assign(y.data(), y.data() + y.size());
    time_ = time;
  }
  bool step()
  {
    before_ = values_;
    time_before_ = time_;
    for (int attempt = 0; attempt < 500; ++attempt)
    {
      if (stepper_.try_step(std::cref(system_), values_, time_, length_) == odeint::success)
      {
        return true;
      }
    }
    return false;
  }
  double time() const
  {
    return time_;
  }
  const double* y() const
  {
    return values_.data();
  }
  void reach(double time, Vector& y)
  {
    landing_.do_step(std::cref(system_), before_, time_before_, time - time_before_);
    time_before_ = time;
    y = VectorView(before_.data(), y.size());
  }

private:
  const Problem& problem_;
  System system_;
  odeint::result_of::make_controlled<odeint::runge_kutta_fehlberg78<Values>>::type stepper_;
  odeint::runge_kutta_fehlberg78<Values> landing_;
  Values values_;
  Values before_;
  double time_ = 0.0;
  double time_before_ = 0.0;
  double length_ = 0.0;
};

template <class Method>
class OdeintPeer : public Peer
{
public:
  explicit OdeintPeer(std::string name) : name_(std::move(name))
  {
  }
  std::string name() const override
  {
    return name_;
  }
  std::string settingName() const override
  {
    return "tolerance";
  }
  std::vector<double> settings(const Problem& /*problem*/) const override
  {
    return tolerances();
  }
  std::unique_ptr<Run> prepare(const Problem& problem, double setting) const override
  {
    return std::make_unique<MarchingRun<Method>>(problem, setting);
  }

private:
  std::string name_;
};
}  // namespace

std::unique_ptr<Peer> makeDormandPrince()
{
  return std::make_unique<OdeintPeer<DormandPrince>>("Odeint Dormand-Prince 5");
}

std::unique_ptr<Peer> makeFehlberg78()
{
  return std::make_unique<OdeintPeer<Fehlberg78>>("Odeint Fehlberg 7(8)");
}
}  // namespace vibro_impact::peers
