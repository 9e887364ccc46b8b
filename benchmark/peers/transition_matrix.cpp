// The exact transition over a fixed step. In modal coordinates its matrix is diagonal, one complex factor a coordinate,
// and the harmonic response is exact, too: only what happens between two grid points can go unseen.

#include <cmath>
#include <complex>
#include <vector>

#include "march.h"
#include "peer.h"

namespace vibro_impact::peers
{
namespace
{
using Complex = std::complex<double>;

/// x = Re z + Re(H D),  z' = lambda z,  D = exp(i Omega t). The phasor D is the last entry of z.
struct Motion
{
  Eigen::VectorXd re;
  Eigen::VectorXd im;
};

void multiply(const Motion& from, const Eigen::VectorXd& factor_re, const Eigen::VectorXd& factor_im, Motion& to)
{
  to.re = from.re.array() * factor_re.array() - from.im.array() * factor_im.array();
  to.im = from.re.array() * factor_im.array() + from.im.array() * factor_re.array();
}

class TransitionMatrixRun : public Run
{
public:
  TransitionMatrixRun(const Problem& problem, double steps_per_cycle)
      : problem_(problem), length_(problem.cycle / steps_per_cycle), y_(2 * problem.mapping.rows()), scratch_(y_.size())
  {
    const Eigen::Index n = problem.mapping.rows();
    for (Motion* motion : {&now_, &next_})
    {
      motion->re = motion->im = Eigen::VectorXd::Zero(n + 1);
    }
    for (std::size_t s = 0; s < 2; ++s)
    {
      const State& state = problem.states[s];
      Table& table = tables_[s];
      table.gap_re = table.gap_im = table.rate_re = table.rate_im = Eigen::VectorXd::Zero(n + 1);
      table.factor_re = table.factor_im = Eigen::VectorXd::Zero(n + 1);
      Complex gap_transfer = 0.0;
      for (Eigen::Index i = 0; i < n; ++i)
      {
        const double decay = 0.5 * state.damping(i);
        table.lambda.emplace_back(-decay, std::sqrt(state.stiffness(i) - decay * decay));
        table.transfer.push_back(state.load(i) /
                                 Complex(state.stiffness(i) - problem.drive_frequency * problem.drive_frequency,
                                         state.damping(i) * problem.drive_frequency));
        gap_transfer += state.deflection(i) * table.transfer.back();
        table.gap_re(i) = state.deflection(i);
        const Complex rate = state.deflection(i) * table.lambda.back();
        table.rate_re(i) = rate.real();
        table.rate_im(i) = -rate.imag();
      }
      table.lambda.emplace_back(0.0, problem.drive_frequency);
      table.gap_re(n) = gap_transfer.real();
      table.gap_im(n) = -gap_transfer.imag();
      const Complex rate = gap_transfer * table.lambda.back();
      table.rate_re(n) = rate.real();
      table.rate_im(n) = -rate.imag();
      for (Eigen::Index i = 0; i <= n; ++i)
      {
        const Complex factor = std::exp(table.lambda[static_cast<std::size_t>(i)] * length_);
        table.factor_re(i) = factor.real();
        table.factor_im(i) = factor.imag();
      }
    }
  }

  bool run(int initial_state, double end, Trace* trace) override
  {
    const Eigen::Index n = problem_.mapping.rows();
    int state = initial_state;
    double time = 0.0;
    y_.setZero();
    enter(state, time);
    for (long steps = 0; time < end; ++steps)
    {
      if (steps == most_steps)
      {
        return false;
      }
      const Table& table = tables_[static_cast<std::size_t>(state)];
      multiply(now_, table.factor_re, table.factor_im, next_);
      const double side = state == 0 ? 1.0 : -1.0;
      // Of the gap only the phasor has a part with Im z.
      double gap = table.gap_re.dot(next_.re) + table.gap_im(n) * next_.im(n);
      if (side * gap > 0.0)
      {
        std::swap(now_, next_);
        time += length_;
      }
      else
      {
        const GapAndRate from = evaluate(table, now_);
        const GapAndRate to = evaluate(table, next_);
        const double where =
            crossing(side * from.gap, side * from.rate * length_, side * to.gap, side * to.rate * length_);
        const double elapsed = land(table, where * length_);
        time += elapsed;
        gap = 0.0;
        leave(table);
        mapToOther(problem_, state, y_, scratch_);
        state = 1 - state;
        enter(state, time);
        if (trace != nullptr)
        {
          ++trace->switches;
        }
      }
      if (trace != nullptr)
      {
        trace->note(time, gap);
      }
    }
    return true;
  }

private:
  static constexpr double landing = 1.0e-12;
  static constexpr int most_corrections = 8;

  struct Table
  {
    std::vector<Complex> lambda;    // of the phasor, too
    std::vector<Complex> transfer;  // H
    Eigen::VectorXd gap_re, gap_im, rate_re, rate_im;
    Eigen::VectorXd factor_re, factor_im;  // exp(lambda length)
  };

  static GapAndRate evaluate(const Table& table, const Motion& motion)
  {
    return {table.gap_re.dot(motion.re) + table.gap_im.dot(motion.im),
            table.rate_re.dot(motion.re) + table.rate_im.dot(motion.im)};
  }

  /// Leaves in next_ the motion at the root, `elapsed` after now_; returns that.
  double land(const Table& table, double elapsed)
  {
    for (int i = 0;; ++i)
    {
      for (Eigen::Index m = 0; m < now_.re.size(); ++m)
      {
        const Complex z =
            Complex(now_.re(m), now_.im(m)) * std::exp(table.lambda[static_cast<std::size_t>(m)] * elapsed);
        next_.re(m) = z.real();
        next_.im(m) = z.imag();
      }
      const GapAndRate here = evaluate(table, next_);
      const double corrected = elapsed - here.gap / here.rate;
      if (std::abs(here.gap) <= landing || i == most_corrections || !(corrected > 0.0 && corrected <= length_))
      {
        return elapsed;
      }
      elapsed = corrected;
    }
  }

  /// Displacement and velocity at the root.
  void leave(const Table& table)
  {
    const Eigen::Index n = problem_.mapping.rows();
    const Complex drive(next_.re(n), next_.im(n));
    for (Eigen::Index i = 0; i < n; ++i)
    {
      const auto m = static_cast<std::size_t>(i);
      const Complex forced = table.transfer[m] * drive;
      y_(i) = next_.re(i) + forced.real();
      y_(n + i) = table.lambda[m].real() * next_.re(i) - table.lambda[m].imag() * next_.im(i) -
                  problem_.drive_frequency * forced.imag();
    }
  }

  void enter(int state, double time)
  {
    const Table& table = tables_[static_cast<std::size_t>(state)];
    const Eigen::Index n = problem_.mapping.rows();
    const Complex drive = std::polar(1.0, problem_.drive_frequency * time);
    for (Eigen::Index i = 0; i < n; ++i)
    {
      const auto m = static_cast<std::size_t>(i);
      const Complex forced = table.transfer[m] * drive;
      const double displacement = y_(i) - forced.real();
      const double velocity = y_(n + i) + problem_.drive_frequency * forced.imag();
      now_.re(i) = displacement;
      now_.im(i) = (table.lambda[m].real() * displacement - velocity) / table.lambda[m].imag();
    }
    now_.re(n) = drive.real();
    now_.im(n) = drive.imag();
  }

  Problem problem_;
  double length_;
  std::array<Table, 2> tables_;
  Motion now_;
  Motion next_;
  Vector y_;
  Vector scratch_;
};

class TransitionMatrixPeer : public Peer
{
public:
  std::string name() const override
  {
    return "transition matrix";
  }
  std::string settingName() const override
  {
    return "steps per cycle";
  }
  std::vector<double> settings(const Problem& /*problem*/) const override
  {
    std::vector<double> result;
    for (double steps = 8.0; steps < 1.0e6; steps *= std::pow(2.0, 0.25))
    {
      result.push_back(std::ceil(steps));
    }
    return result;
  }
  std::unique_ptr<Run> prepare(const Problem& problem, double setting) const override
  {
    return std::make_unique<TransitionMatrixRun>(problem, setting);
  }
};
}  // namespace

std::unique_ptr<Peer> makeTransitionMatrix()
{
  return std::make_unique<TransitionMatrixPeer>();
}
}  // namespace vibro_impact::peers
