// The classical Runge-Kutta method of fourth order, by hand, at a fixed step.

#include <algorithm>
#include <cmath>

#include "march.h"
#include "peer.h"

namespace vibro_impact::peers
{
namespace
{
class RungeKutta4
{
public:
  RungeKutta4(const Problem& problem, double steps_per_cycle)
      : problem_(problem), length_(problem.cycle / steps_per_cycle)
  {
    const Eigen::Index size = 2 * problem.mapping.rows();
    for (Vector* vector : {&y_, &before_, &k1_, &k2_, &k3_, &k4_})
    {
      *vector = Vector::Zero(size);
    }
  }

  void reset()
  {
  }
  void start(int state, double time, const Vector& y)
  {
    state_ = &problem_.states[static_cast<std::size_t>(state)];
    time_ = time;
    drive_ = std::cos(problem_.drive_frequency * time);
    y_ = y;
  }
  bool step()
  {
    before_.swap(y_);
    time_before_ = time_;
    drive_before_ = drive_;
    advance(before_, time_, drive_, length_, y_);
    time_ += length_;
    return true;
  }
  double time() const
  {
    return time_;
  }
  const double* y() const
  {
    return y_.data();
  }
  void reach(double time, Vector& y)
  {
    advance(before_, time_before_, drive_before_, time - time_before_, y);
    before_ = y;
    time_before_ = time;
  }

private:
  /// `drive` is that of the start, and becomes that of the end.
  void advance(const Vector& from, double time, double& drive, double length, Vector& to)
  {
    const double middle = std::cos(problem_.drive_frequency * (time + 0.5 * length));
    const double end = std::cos(problem_.drive_frequency * (time + length));
    derivative(*state_, drive, from.data(), k1_.data());
    to = from + (0.5 * length) * k1_;
    derivative(*state_, middle, to.data(), k2_.data());
    to = from + (0.5 * length) * k2_;
    derivative(*state_, middle, to.data(), k3_.data());
    to = from + length * k3_;
    derivative(*state_, end, to.data(), k4_.data());
    to = from + (length / 6.0) * (k1_ + 2.0 * (k2_ + k3_) + k4_);
    drive = end;
  }

  const Problem& problem_;
  double length_;
  const State* state_ = nullptr;
  double time_ = 0.0;
  double time_before_ = 0.0;
  double drive_ = 0.0;
  double drive_before_ = 0.0;
  Vector y_, before_, k1_, k2_, k3_, k4_;
};

class RungeKutta4Peer : public Peer
{
public:
  std::string name() const override
  {
    return "Runge-Kutta 4";
  }
  std::string settingName() const override
  {
    return "steps per cycle";
  }
  std::vector<double> settings(const Problem& problem) const override
  {
    // From its limit of stability, length times highest frequency = 2.83, on.
    double highest = 0.0;
    for (const State& state : problem.states)
    {
      highest = std::max(highest, std::sqrt(state.stiffness.maxCoeff()));
    }
    std::vector<double> result;
    for (double steps = std::max(16.0, problem.cycle * highest / 2.83); steps < 1.0e6; steps *= std::pow(2.0, 0.25))
    {
      result.push_back(std::ceil(steps));
    }
    return result;
  }
  std::unique_ptr<Run> prepare(const Problem& problem, double setting) const override
  {
    return std::make_unique<MarchingRun<RungeKutta4>>(problem, setting);
  }
};
}  // namespace

std::unique_ptr<Peer> makeRungeKutta4()
{
  return std::make_unique<RungeKutta4Peer>();
}
}  // namespace vibro_impact::peers
