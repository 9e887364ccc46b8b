// GSL: Prince-Dormand 8(9) with its own control of the step.

#include <cmath>
#include <memory>
#include <vector>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include "march.h"
#include "peer.h"

namespace vibro_impact::peers
{
namespace
{
constexpr double first_step = 1.0e-3;  // of a cycle

class Rk8pd
{
public:
  Rk8pd(const Problem& problem, double tolerance)
      : problem_(problem),
        size_(static_cast<std::size_t>(2 * problem.mapping.rows())),
        step_(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, size_), gsl_odeiv2_step_free),
        landing_(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, size_), gsl_odeiv2_step_free),
        control_(gsl_odeiv2_control_y_new(tolerance, 0.0), gsl_odeiv2_control_free),
        evolve_(gsl_odeiv2_evolve_alloc(size_), gsl_odeiv2_evolve_free),
        system_{&Rk8pd::evaluate, nullptr, size_, this},
        values_(size_),
        before_(size_),
        error_(size_)
  {
  }
  Rk8pd(const Rk8pd&) = delete;
  Rk8pd& operator=(const Rk8pd&) = delete;

  void reset()
  {
    length_ = first_step * problem_.cycle;
  }
  void start(int state, double time, const Vector& y)
  {
    state_ = &problem_.states[static_cast<std::size_t>(state)];
    values_.assign(y.data(), y.data() + y.size());
    time_ = time;
    gsl_odeiv2_evolve_reset(evolve_.get());
    gsl_odeiv2_step_reset(step_.get());
  }
  bool step()
  {
    constexpr double never = 1.0e9;
    before_ = values_;
    time_before_ = time_;
    return gsl_odeiv2_evolve_apply(evolve_.get(), control_.get(), step_.get(), &system_, &time_, never, &length_,
                                   values_.data()) == GSL_SUCCESS;
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
    gsl_odeiv2_step_apply(landing_.get(), time_before_, time - time_before_, before_.data(), error_.data(), nullptr,
                          nullptr, &system_);
    time_before_ = time;
    y = VectorView(before_.data(), y.size());
  }

private:
  static int evaluate(double time, const double* y, double* result, void* self)
  {
    const auto* method = static_cast<const Rk8pd*>(self);
    derivative(*method->state_, std::cos(method->problem_.drive_frequency * time), y, result);
    return GSL_SUCCESS;
  }

  const Problem& problem_;
  std::size_t size_;
  std::unique_ptr<gsl_odeiv2_step, decltype(&gsl_odeiv2_step_free)> step_;
  std::unique_ptr<gsl_odeiv2_step, decltype(&gsl_odeiv2_step_free)> landing_;
  std::unique_ptr<gsl_odeiv2_control, decltype(&gsl_odeiv2_control_free)> control_;
  std::unique_ptr<gsl_odeiv2_evolve, decltype(&gsl_odeiv2_evolve_free)> evolve_;
  gsl_odeiv2_system system_;
  const State* state_ = nullptr;
  std::vector<double> values_;
  std::vector<double> before_;
  std::vector<double> error_;
  double time_ = 0.0;
  double time_before_ = 0.0;
  double length_ = 0.0;
};

class GslPeer : public Peer
{
public:
  std::string name() const override
  {
    return "GSL rk8pd";
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
    return std::make_unique<MarchingRun<Rk8pd>>(problem, setting);
  }
};
}  // namespace

std::unique_ptr<Peer> makeRk8pd()
{
  return std::make_unique<GslPeer>();
}
}  // namespace vibro_impact::peers
