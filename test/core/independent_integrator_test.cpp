// The closed forms against a numerical integration of the same modal equations: Boost.Odeint's Runge-Kutta-Fehlberg
// 7(8) with a step of a fortieth of the shortest period, and every switch located by bisection of that step. The
// impulse and the energy that damping takes during a contact are two more differential equations there.

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <boost/numeric/odeint.hpp>

#include "reference_system.h"
#include "switched_motion.h"

namespace vibro_impact::core
{
namespace
{
constexpr double two_pi = 6.28318530717958647693;

struct Episode
{
  double onset = 0.0, duration = 0.0, impulse = 0.0, dissipated = 0.0, approach_speed = 0.0, separation_speed = 0.0;
};

class Integrator
{
public:
  Integrator(const SwitchedModel& model, std::function<double(double)> acceleration)
      : model_(model), acceleration_(std::move(acceleration))
  {
    state_ = model.clearance() < 0.0 ? 1 : 0;
    const LinearState& linear = now();
    resize();
    for (Eigen::Index n = 0; n < linear.size(); ++n)
    {
      y_[static_cast<std::size_t>(n)] = linear.preload(n) / std::pow(linear.frequency(n), 2);
    }
    seen_whole_ = false;
    step_ = two_pi / std::max(model.free().frequency.maxCoeff(), model.contact().frequency.maxCoeff()) / 40.0;
  }

  /// Integrates to `end`, in equal steps: the acceleration must be smooth in between.
  void advanceTo(double end)
  {
    const double start = time_;
    const auto steps = static_cast<int>(std::ceil((end - start) / step_));
    for (int i = 0; i < steps; ++i)
    {
      stepTo(i + 1 == steps ? end : start + (end - start) * (i + 1) / steps);
    }
  }

  int state() const
  {
    return state_;
  }
  Eigen::VectorXd displacement() const
  {
    return Eigen::Map<const Eigen::VectorXd>(y_.data(), now().size());
  }
  const std::vector<Episode>& episodes() const
  {
    return episodes_;
  }

private:
  using Vector = std::vector<double>;

  const LinearState& now() const
  {
    return state_ == 0 ? model_.free() : model_.contact();
  }

  void resize()
  {
    y_.assign(2 * static_cast<std::size_t>(now().size()) + 2, 0.0);
  }

  double gap(const Vector& y) const
  {
    return model_.clearance() +
           now().contact_deflection.matrix().dot(Eigen::Map<const Eigen::VectorXd>(y.data(), now().size()));
  }

  double rate(const Vector& y) const
  {
    return now().contact_deflection.matrix().dot(
        Eigen::Map<const Eigen::VectorXd>(y.data() + now().size(), now().size()));
  }

  /// [eta, eta', impulse, dissipated energy]
  void derivative(const Vector& y, Vector& dydt, double t) const
  {
    const LinearState& linear = now();
    const auto size = static_cast<std::size_t>(linear.size());
    const double a = acceleration_(t);
    double dissipation = 0.0;
    for (std::size_t n = 0; n < size; ++n)
    {
      const auto i = static_cast<Eigen::Index>(n);
      const double damping = 2.0 * linear.damping_ratio(i) * linear.frequency(i);
      dydt[n] = y[size + n];
      dydt[size + n] = -damping * y[size + n] - linear.frequency(i) * linear.frequency(i) * y[n] -
                       linear.participation(i) * a + linear.preload(i);
      dissipation += damping * y[size + n] * y[size + n];
    }
    dydt[2 * size] = state_ == 1 ? -model_.stiffness() * gap(y) : 0.0;
    dydt[2 * size + 1] = state_ == 1 ? dissipation : 0.0;
  }

  Vector stepped(double duration)
  {
    Vector y = y_;
    boost::numeric::odeint::runge_kutta_fehlberg78<Vector> stepper;
    stepper.do_step([this](const Vector& x, Vector& dxdt, double t) { derivative(x, dxdt, t); }, y, time_, duration);
    return y;
  }

  bool crossed(const Vector& y) const
  {
    return state_ == 0 ? gap(y) < 0.0 && rate(y) < 0.0 : gap(y) > 0.0 && rate(y) > 0.0;
  }

  void stepTo(double end)
  {
    for (;;)
    {
      Vector y = stepped(end - time_);
      if (!crossed(y))
      {
        y_ = y;
        time_ = end;
        return;
      }
      double low = 0.0;
      double high = end - time_;
      for (int i = 0; i < 60; ++i)
      {
        const double middle = 0.5 * (low + high);
        (crossed(stepped(middle)) ? high : low) = middle;
      }
      y_ = stepped(high);
      time_ += high;
      switchState();
    }
  }

  void switchState()
  {
    const Eigen::Index from = now().size();
    const Eigen::VectorXd displacement = Eigen::Map<Eigen::VectorXd>(y_.data(), from);
    const Eigen::VectorXd velocity = Eigen::Map<Eigen::VectorXd>(y_.data() + from, from);
    const double speed = std::abs(rate(y_));
    if (state_ == 1)
    {
      episode_.duration = time_ - episode_.onset;
      episode_.impulse = y_[2 * static_cast<std::size_t>(from)];
      episode_.dissipated = y_[2 * static_cast<std::size_t>(from) + 1];
      episode_.separation_speed = speed;
      if (seen_whole_)
      {
        episodes_.push_back(episode_);
      }
    }
    else
    {
      episode_ = Episode();
      episode_.onset = time_;
      episode_.approach_speed = speed;
      seen_whole_ = true;
    }
    state_ = 1 - state_;
    resize();
    const Eigen::MatrixXd map = state_ == 1 ? Eigen::MatrixXd(model_.mapping().transpose()) : model_.mapping();
    Eigen::Map<Eigen::VectorXd>(y_.data(), now().size()) = map * displacement;
    Eigen::Map<Eigen::VectorXd>(y_.data() + now().size(), now().size()) = map * velocity;
  }

  const SwitchedModel& model_;
  std::function<double(double)> acceleration_;
  double step_;
  double time_ = 0.0;
  int state_;
  bool seen_whole_;
  Vector y_;
  Episode episode_;
  std::vector<Episode> episodes_;
};

/// Records whole episodes.
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

/// Largest difference of the displacements over the largest displacement, over all times compared.
class Comparison
{
public:
  void add(const SwitchedMotion& motion, const Integrator& integrator)
  {
    Eigen::VectorXd displacement;
    Eigen::VectorXd velocity;
    motion.coordinates(displacement, velocity);
    ASSERT_EQ(motion.inContact() ? 1 : 0, integrator.state());
    difference_ = std::max(difference_, (displacement - integrator.displacement()).cwiseAbs().maxCoeff());
    largest_ = std::max(largest_, displacement.cwiseAbs().maxCoeff());
  }
  double relative() const
  {
    return difference_ / largest_;
  }

private:
  double difference_ = 0.0;
  double largest_ = 0.0;
};

/// Episodes that begin in the first hundredth of a cycle are left out: at a start from rest with zero clearance gap,
/// velocity and acceleration are zero, and a numerical integration cannot tell when the first contact begins.
void compareEpisodes(std::vector<Impact> impacts, std::vector<Episode> episodes, double interval, double cycle,
                     bool mapping_loses)
{
  impacts.erase(std::remove_if(impacts.begin(), impacts.end(),
                               [&](const Impact& impact) {
                                 return static_cast<double>(impact.interval) * interval + impact.offset < 0.01 * cycle;
                               }),
                impacts.end());
  episodes.erase(std::remove_if(episodes.begin(), episodes.end(),
                                [&](const Episode& episode) { return episode.onset < 0.01 * cycle; }),
                 episodes.end());
  ASSERT_EQ(impacts.size(), episodes.size());
  double impulse = 0.0;
  double duration = 0.0;
  double energy = 0.0;
  double speed = 0.0;
  for (const Episode& episode : episodes)
  {
    impulse = std::max(impulse, episode.impulse);
    duration = std::max(duration, episode.duration);
    energy = std::max(energy, episode.dissipated);
    speed = std::max(speed, episode.approach_speed);
  }
  for (std::size_t i = 0; i < impacts.size(); ++i)
  {
    const double onset = static_cast<double>(impacts[i].interval) * interval + impacts[i].offset;
    EXPECT_NEAR(onset, episodes[i].onset, 1e-7 * duration) << "impact " << i;
    EXPECT_NEAR(impacts[i].duration, episodes[i].duration, 1e-7 * duration) << "impact " << i;
    EXPECT_NEAR(impacts[i].impulse, episodes[i].impulse, 1e-8 * impulse) << "impact " << i;
    EXPECT_NEAR(impacts[i].approach_speed, episodes[i].approach_speed, 1e-7 * speed) << "impact " << i;
    EXPECT_NEAR(impacts[i].separation_speed, episodes[i].separation_speed, 1e-7 * speed) << "impact " << i;
    if (!mapping_loses)
    {
      EXPECT_NEAR(impacts[i].energy_lost, episodes[i].dissipated, 1e-7 * energy) << "impact " << i;
    }
  }
}

struct Case
{
  const char* name;
  SystemParameters parameters;
  double omega_star;
};

std::vector<Case> cases()
{
  const auto with_clearance = [](SystemParameters parameters, double clearance)
  {
    parameters.contact.clearance = clearance;
    return parameters;
  };
  const SystemParameters attachment = limitingCase(1000.0, AttachmentBasis{3});
  const SystemParameters conjoined = limitingCase(1000.0, ConjoinedBasis{2, 2});
  SystemParameters off_centre = limitingCase(1000.0, AttachmentBasis{2});
  off_centre.beam1.contact_location = 0.02;
  return {{"conjoined 1.2", conjoined, 1.2},
          {"conjoined 1.6", conjoined, 1.6},
          {"attachment 1.2", attachment, 1.2},
          {"attachment 1.6", attachment, 1.6},
          {"attachment 2.0", attachment, 2.0},
          {"attachment, open at rest", with_clearance(attachment, 1e-6), 1.6},
          {"attachment, interference", with_clearance(attachment, -1e-7), 1.6},
          {"attachment, rigid surface", rigidCase(1000.0, AttachmentBasis{3}), 1.6},
          {"attachment, off centre", off_centre, 1.6}};
}
}  // namespace

TEST(IndependentIntegrator, agreesOverTwentyCyclesOfAHarmonicDrive)
{
  for (const Case& known : cases())
  {
    SCOPED_TRACE(known.name);
    const auto model = std::make_shared<const SwitchedModel>(known.parameters);
    const double omega = known.omega_star * model->scales().frequency;
    const double cycle = two_pi / omega;
    SwitchedMotion motion(model, true);
    motion.setHarmonicDrive(omega, 10.0);
    Integrator integrator(*model, [omega](double t) { return -10.0 * std::cos(omega * t); });
    Recorder recorder;
    Comparison comparison;
    for (int i = 1; i <= 20; ++i)
    {
      motion.advanceHarmonic(recorder);
      integrator.advanceTo(cycle * i);
      comparison.add(motion, integrator);
    }
    EXPECT_LT(comparison.relative(), 1e-8);
    EXPECT_GT(recorder.impacts.size(), 15u);
    std::printf("%s: %zu impacts, displacements agree to %.1e\n", known.name, recorder.impacts.size(),
                comparison.relative());
    compareEpisodes(recorder.impacts, integrator.episodes(), cycle, cycle, known.name[0] == 'c');
  }
}

TEST(IndependentIntegrator, agreesOverTwentyCyclesOfASampledDrive)
{
  for (const Case& known : cases())
  {
    SCOPED_TRACE(known.name);
    const auto model = std::make_shared<const SwitchedModel>(known.parameters);
    const double omega = known.omega_star * model->scales().frequency;
    constexpr int per_cycle = 37;
    const double period = two_pi / omega / per_cycle;
    const auto sample = [](int i) { return 10.0 * std::sin(two_pi * i / per_cycle) + 1.5 * std::sin(0.7 * i * i); };
    SwitchedMotion motion(model, false);
    motion.setInterval(period);
    int interval = 0;
    Integrator integrator(*model,
                          [&](double t)
                          {
                            const double from = sample(interval);
                            return from + (sample(interval + 1) - from) * (t / period - interval);
                          });
    Recorder recorder;
    Comparison comparison;
    for (interval = 0; interval < 20 * per_cycle; ++interval)
    {
      motion.advanceLinear(sample(interval), sample(interval + 1), recorder);
      integrator.advanceTo(period * (interval + 1));
      comparison.add(motion, integrator);
    }
    EXPECT_LT(comparison.relative(), 1e-8);
    EXPECT_GT(recorder.impacts.size(), 15u);
    std::printf("%s: %zu impacts, displacements agree to %.1e\n", known.name, recorder.impacts.size(),
                comparison.relative());
    compareEpisodes(recorder.impacts, integrator.episodes(), period, two_pi / omega, known.name[0] == 'c');
  }
}

}  // namespace vibro_impact::core
