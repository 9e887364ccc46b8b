#pragma once

#include <memory>
#include <string>
#include <vector>

#include "problem.h"

namespace vibro_impact::peers
{
/// What a run leaves behind for the comparison with the reference: the gap now and then.
class Trace
{
public:
  /// At most one sample every `interval`.
  explicit Trace(double interval) : interval_(interval)
  {
  }
  struct Sample
  {
    double time;
    double gap;
  };
  void note(double time, double gap)
  {
    if (time >= next_)
    {
      samples_.push_back({time, gap});
      next_ = time + interval_;
    }
  }
  const std::vector<Sample>& samples() const
  {
    return samples_;
  }
  std::size_t switches = 0;

private:
  double interval_;
  double next_ = 0.0;
  std::vector<Sample> samples_;
};

/// A competitor made ready for one problem: whatever can be computed beforehand is there.
class Run
{
public:
  virtual ~Run() = default;
  /// From rest, in the state given, to `end` or a step beyond; notes in `trace`, if there is one, what it passes.
  /// False where the integration broke down.
  virtual bool run(int initial_state, double end, Trace* trace) = 0;
};

/// A competitor. Its `setting` (tolerance, or steps in a drive cycle) is found by search.
class Peer
{
public:
  virtual ~Peer() = default;
  virtual std::string name() const = 0;
  /// What a setting is, for the table.
  virtual std::string settingName() const = 0;
  /// Settings to search, from the cheapest to the most exact.
  virtual std::vector<double> settings(const Problem& problem) const = 0;
  virtual std::unique_ptr<Run> prepare(const Problem& problem, double setting) const = 0;
};

/// 10^(-2) to 10^(-14), four to a decade.
std::vector<double> tolerances();

std::unique_ptr<Peer> makeTransitionMatrix();
std::unique_ptr<Peer> makeRungeKutta4();
std::unique_ptr<Peer> makeDormandPrince();  ///< Boost.Odeint
std::unique_ptr<Peer> makeFehlberg78();     ///< Boost.Odeint
std::unique_ptr<Peer> makeRk8pd();          ///< GSL
std::unique_ptr<Peer> makeAdams();          ///< SUNDIALS CVODE

}  // namespace vibro_impact::peers
