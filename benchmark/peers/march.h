#pragma once

#include <cmath>
#include <utility>

#include "peer.h"

namespace vibro_impact::peers
{
/// Of the cubic through both ends of a step (value and rate times the length of the step): where in (0, 1] it passes
/// zero downwards first, to about 1e-9, or 2 where it does not. A dip below zero inside a step is seen, too.
double crossing(double value0, double slope0, double value1, double slope1);

/// More steps than this in one run are a breakdown.
constexpr long most_steps = 20'000'000;

/// Advances a step-by-step method through the switches. `Method` has
///   void reset()                        forget the length of the step
///   void start(int state, double t, const Vector& y)  start there, with the step's length of before
///   bool step()                         make one accepted step; false if that fails
///   double time() const                 its end
///   const double* y() const             the motion there
///   void reach(double time, Vector& y)  the motion inside the last step at `time`: from its start if it is the first
///                                       call after it, and from where the last call got otherwise
/// Events are located to where the gap is `landing` of its unit from zero, by Newton's method on what reach() gives.
template <class Method>
class MarchingRun : public Run
{
public:
  template <class... Arguments>
  explicit MarchingRun(const Problem& problem, Arguments&&... arguments)
      : problem_(problem),
        method_(problem_, std::forward<Arguments>(arguments)...),
        y_(2 * problem.mapping.rows()),
        scratch_(y_.size())
  {
  }

  bool run(int initial_state, double end, Trace* trace) override
  {
    int state = initial_state;
    y_.setZero();
    method_.reset();
    method_.start(state, 0.0, y_);
    double time = 0.0;
    GapAndRate now{0.0, 0.0};
    for (long steps = 0; time < end; ++steps)
    {
      if (steps == most_steps || !method_.step())
      {
        return false;
      }
      const State& linear = problem_.states[static_cast<std::size_t>(state)];
      const double side = state == 0 ? 1.0 : -1.0;
      const double length = method_.time() - time;
      const GapAndRate next = gapAndRate(linear, method_.y());
      if (!std::isfinite(next.gap))
      {
        return false;
      }
      const double where =
          crossing(side * now.gap, side * now.rate * length, side * next.gap, side * next.rate * length);
      if (where > 1.0)
      {
        time = method_.time();
        now = next;
      }
      else
      {
        time = land(linear, time, time + where * length, now);
        mapToOther(problem_, state, y_, scratch_);
        state = 1 - state;
        method_.start(state, time, y_);
        if (trace != nullptr)
        {
          ++trace->switches;
        }
      }
      if (trace != nullptr)
      {
        trace->note(time, now.gap);
      }
    }
    return true;
  }

private:
  static constexpr double landing = 1.0e-12;
  static constexpr int most_corrections = 8;

  /// The motion at the root near `guess`, in y_; returns its time.
  double land(const State& linear, double from, double guess, GapAndRate& now)
  {
    double time = guess;
    for (int i = 0;; ++i)
    {
      method_.reach(time, y_);
      now = gapAndRate(linear, y_.data());
      const double correction = -now.gap / now.rate;
      if (std::abs(now.gap) <= landing || i == most_corrections || !(time + correction > from) ||
          time + correction > method_.time())
      {
        return time;
      }
      time += correction;
    }
  }

  Problem problem_;
  Method method_;
  Vector y_;
  Vector scratch_;
};
}  // namespace vibro_impact::peers
