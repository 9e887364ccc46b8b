// SUNDIALS CVODE: Adams' methods of variable order and step, with its own search for roots.

#include <cmath>
#include <memory>
#include <vector>

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "march.h"
#include "peer.h"

namespace vibro_impact::peers
{
namespace
{
class AdamsRun : public Run
{
public:
  AdamsRun(const Problem& problem, double tolerance)
      : problem_(problem), y_(2 * problem.mapping.rows()), scratch_(y_.size())
  {
    SUNContext_Create(nullptr, &context_);
    values_ = N_VMake_Serial(y_.size(), y_.data(), context_);
    memory_ = CVodeCreate(CV_ADAMS, context_);
    y_.setZero();
    CVodeInit(memory_, &AdamsRun::evaluate, 0.0, values_);
    CVodeSStolerances(memory_, 0.0, tolerance);
    solver_ = SUNNonlinSol_FixedPoint(values_, 0, context_);
    CVodeSetNonlinearSolver(memory_, solver_);
    CVodeSetUserData(memory_, this);
    CVodeRootInit(memory_, 1, &AdamsRun::root);
    CVodeSetNoInactiveRootWarn(memory_);
  }
  ~AdamsRun() override
  {
    CVodeFree(&memory_);
    SUNNonlinSolFree(solver_);
    N_VDestroy(values_);
    SUNContext_Free(&context_);
  }
  AdamsRun(const AdamsRun&) = delete;
  AdamsRun& operator=(const AdamsRun&) = delete;

  bool run(int initial_state, double end, Trace* trace) override
  {
    double time = 0.0;
    y_.setZero();
    enter(initial_state, time);
    for (long steps = 0; time < end; ++steps)
    {
      const int result = CVode(memory_, end, values_, &time, CV_ONE_STEP);
      if (steps == most_steps || result < 0)
      {
        return false;
      }
      if (trace != nullptr)
      {
        trace->note(time, gapAndRate(problem_.states[static_cast<std::size_t>(state_)], y_.data()).gap);
      }
      if (result == CV_ROOT_RETURN)
      {
        mapToOther(problem_, state_, y_, scratch_);
        enter(1 - state_, time);
        if (trace != nullptr)
        {
          ++trace->switches;
        }
      }
    }
    return true;
  }

private:
  void enter(int state, double time)
  {
    state_ = state;
    int direction = state == 0 ? -1 : 1;
    CVodeReInit(memory_, time, values_);
    CVodeSetRootDirection(memory_, &direction);
  }
  static int evaluate(double time, N_Vector y, N_Vector result, void* self)
  {
    const auto* run = static_cast<const AdamsRun*>(self);
    derivative(run->problem_.states[static_cast<std::size_t>(run->state_)],
               std::cos(run->problem_.drive_frequency * time), N_VGetArrayPointer(y), N_VGetArrayPointer(result));
    return 0;
  }
  static int root(double /*time*/, N_Vector y, double* gap, void* self)
  {
    const auto* run = static_cast<const AdamsRun*>(self);
    const State& state = run->problem_.states[static_cast<std::size_t>(run->state_)];
    *gap = state.deflection.dot(VectorView(N_VGetArrayPointer(y), state.size()));
    return 0;
  }

  Problem problem_;
  Vector y_;
  Vector scratch_;
  int state_ = 0;
  SUNContext context_ = nullptr;
  N_Vector values_ = nullptr;
  SUNNonlinearSolver solver_ = nullptr;
  void* memory_ = nullptr;
};

class CvodePeer : public Peer
{
public:
  std::string name() const override
  {
    return "CVODE Adams";
  }
  std::string settingName() const override
  {
    return "tolerance";
  }
  std::vector<double> settings(const Problem& /*problem*/) const override
  {
    // The least exact ones break down, and every one takes seconds.
    std::vector<double> result = tolerances();
    result.erase(result.begin(), result.begin() + 8);
    return result;
  }
  std::unique_ptr<Run> prepare(const Problem& problem, double setting) const override
  {
    return std::make_unique<AdamsRun>(problem, setting);
  }
};
}  // namespace

std::unique_ptr<Peer> makeAdams()
{
  return std::make_unique<CvodePeer>();
}
}  // namespace vibro_impact::peers
