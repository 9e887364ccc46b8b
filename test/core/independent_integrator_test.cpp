// The motion by an independent way: the modal equations of both states integrated in time steps by a Runge-Kutta
// method, with impulse and dissipated energy as further unknowns, and the switches located by bisection of a step.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "reference_system.h"
#include "switched_motion.h"
#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
namespace
{
constexpr double two_pi = 6.28318530717958647693;

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

  void startFree(const Eigen::VectorXd& displacement)
  {
    contact_ = false;
    setState(displacement, Eigen::VectorXd::Zero(displacement.size()));
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
    double sum = model_->clearance();
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
    double sum = contact_ ? 0.5 * model_->stiffness() * model_->clearance() * model_->clearance() : 0.0;
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

class Recorder : public ImpactSink
{
public:
  void onImpact(const Impact& impact) override
  {
    if (!impact.cut_short)
    {
      impacts.push_back(impact);
    }
  }
  std::vector<Impact> impacts;
};

struct Case
{
  std::string name;
  SystemParameters parameters;
  double relative_clearance = 0.0;  // in static deflections a/omega_11^2
  double omega_star = 0.0;
};

// NOLINTNEXTLINE(readability-identifier-naming): Google Test looks for this name.
void PrintTo(const Case& c, std::ostream* stream)
{
  *stream << c.name;
}

constexpr int cycles = 20;
constexpr double tolerance = 1.0e-8;

class IndependentIntegrator : public ::testing::TestWithParam<Case>
{
protected:
  IndependentIntegrator()
  {
    SystemParameters parameters = GetParam().parameters;
    const double frequency = referenceScales(parameters.beam1).frequency;
    const double deflection = 1.0 / (frequency * frequency);
    parameters.contact.clearance = GetParam().relative_clearance * deflection;
    model_ = std::make_shared<const SwitchedModel>(parameters);
    frequency_ = GetParam().omega_star * frequency;
    cycle_ = two_pi / frequency_;
    // Open a little: a start from rest with the surfaces touching is degenerate.
    const LinearState& free = model_->free();
    start_ = Eigen::VectorXd::Zero(free.size());
    start_(0) = 0.1 * deflection / free.contact_deflection(0);
  }

  void start(SwitchedMotion& motion, Integrator& integrator) const
  {
    if (GetParam().relative_clearance < 0.0)
    {
      motion.rest();
      integrator.startAtRestInContact();
    }
    else
    {
      motion.setFreeCoordinates(start_, Eigen::VectorXd::Zero(start_.size()));
      integrator.startFree(start_);
    }
  }

  void compareDisplacements(const SwitchedMotion& motion, const Integrator& integrator, double time)
  {
    ASSERT_EQ(motion.inContact(), integrator.inContact()) << "at cycle " << time / cycle_;
    Eigen::VectorXd displacement;
    Eigen::VectorXd velocity;
    motion.coordinates(displacement, velocity);
    greatest_displacement_ = std::max(greatest_displacement_, integrator.displacement().norm());
    greatest_gap_ = std::max(greatest_gap_, std::abs(integrator.gap()));
    EXPECT_LE((displacement - integrator.displacement()).norm(), tolerance * greatest_displacement_)
        << "at cycle " << time / cycle_;
    EXPECT_LE(std::abs(motion.gap() - integrator.gap()), tolerance * greatest_gap_) << "at cycle " << time / cycle_;
    EXPECT_LE(std::abs(motion.force() - (integrator.inContact() ? -model_->stiffness() * integrator.gap() : 0.0)),
              tolerance * model_->stiffness() * greatest_gap_);
    greatest_energy_ = std::max(greatest_energy_, motion.energy());
  }

  void compareImpacts(const std::vector<Impact>& impacts, const std::vector<Episode>& episodes, double interval) const
  {
    ASSERT_EQ(impacts.size(), episodes.size());
    ASSERT_GT(impacts.size(), 8u);
    Episode greatest;
    for (const Episode& episode : episodes)
    {
      greatest.duration = std::max(greatest.duration, episode.duration);
      greatest.impulse = std::max(greatest.impulse, episode.impulse);
      greatest.peak_force = std::max(greatest.peak_force, episode.peak_force);
      greatest.approach_speed = std::max({greatest.approach_speed, episode.approach_speed, episode.separation_speed});
    }
    for (std::size_t i = 0; i < impacts.size(); ++i)
    {
      const Impact& impact = impacts[i];
      const Episode& episode = episodes[i];
      SCOPED_TRACE(::testing::Message() << "impact " << i);
      EXPECT_NEAR(static_cast<double>(impact.interval) * interval + impact.offset, episode.onset, tolerance * cycle_);
      EXPECT_NEAR(impact.duration, episode.duration, tolerance * greatest.duration);
      EXPECT_NEAR(impact.impulse, episode.impulse, tolerance * greatest.impulse);
      EXPECT_NEAR(impact.peak_force, episode.peak_force, tolerance * greatest.peak_force);
      EXPECT_NEAR(impact.approach_speed, episode.approach_speed, tolerance * greatest.approach_speed);
      EXPECT_NEAR(impact.separation_speed, episode.separation_speed, tolerance * greatest.approach_speed);
      EXPECT_NEAR(impact.energy_lost, episode.energy_lost, tolerance * greatest_energy_);
    }
  }

  std::shared_ptr<const SwitchedModel> model_;
  double frequency_ = 0.0;
  double cycle_ = 0.0;
  Eigen::VectorXd start_;
  double greatest_displacement_ = 0.0;
  double greatest_gap_ = 0.0;
  double greatest_energy_ = 0.0;
};

TEST_P(IndependentIntegrator, AgreesUnderAHarmonicDrive)
{
  SwitchedMotion motion(model_, true);
  Integrator integrator(model_, [this](double time) { return -std::cos(frequency_ * time); });
  start(motion, integrator);
  motion.setHarmonicDrive(frequency_, 1.0);
  Recorder recorder;
  for (int i = 1; i <= cycles; ++i)
  {
    motion.advanceHarmonic(recorder);
    integrator.advance(i * cycle_);
    compareDisplacements(motion, integrator, i * cycle_);
  }
  compareImpacts(recorder.impacts, integrator.episodes(), cycle_);
}

TEST_P(IndependentIntegrator, AgreesUnderASampledDrive)
{
  constexpr int samples_per_cycle = 24;
  const double period = cycle_ / samples_per_cycle;
  const auto sample = [](int i)
  {
    const double angle = two_pi * i / samples_per_cycle;
    return -std::cos(angle) + 0.2 * std::sin(2.0 * angle);
  };
  int interval = 0;
  SwitchedMotion motion(model_, false);
  Integrator integrator(model_,
                        [&](double time)
                        {
                          const double share = time / period - interval;
                          return (1.0 - share) * sample(interval) + share * sample(interval + 1);
                        });
  motion.setInterval(period);
  start(motion, integrator);
  Recorder recorder;
  for (; interval < cycles * samples_per_cycle; ++interval)
  {
    motion.advanceLinear(sample(interval), sample(interval + 1), recorder);
    integrator.advance((interval + 1) * period);
    compareDisplacements(motion, integrator, (interval + 1) * period);
  }
  compareImpacts(recorder.impacts, integrator.episodes(), period);
}

std::string caseName(const ::testing::TestParamInfo<Case>& tested)
{
  return tested.param.name;
}

SystemParameters conjoined()
{
  return limitingCase(1000.0, ConjoinedBasis{2, 2});
}

SystemParameters attachment()
{
  return limitingCase(1000.0, AttachmentBasis{3});
}

SystemParameters offCentre()
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{2});
  parameters.beam1.contact_location = 0.02;
  return parameters;
}

INSTANTIATE_TEST_SUITE_P(LimitingCase, IndependentIntegrator,
                         ::testing::Values(Case{"conjoined_touching_1_2", conjoined(), 0.0, 1.2},
                                           Case{"conjoined_touching_1_6", conjoined(), 0.0, 1.6},
                                           Case{"conjoined_open_1_6", conjoined(), 0.3, 1.6},
                                           Case{"conjoined_pressed_1_6", conjoined(), -0.1, 1.6},
                                           Case{"attachment_touching_1_6", attachment(), 0.0, 1.6},
                                           Case{"attachment_touching_2_0", attachment(), 0.0, 2.0},
                                           Case{"attachment_open_1_2", attachment(), 0.3, 1.2},
                                           Case{"attachment_pressed_1_6", attachment(), -0.3, 1.6},
                                           Case{"rigid_surface_1_6", rigidCase(1000.0, AttachmentBasis{3}), 0.0, 1.6},
                                           Case{"off_centre_1_6", offCentre(), 0.0, 1.6}),
                         caseName);

}  // namespace
}  // namespace vibro_impact::core
