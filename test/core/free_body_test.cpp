// Coordinates without stiffness: the motions of a body that nothing holds.

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "independent_integrator.h"
#include "switched_motion.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
namespace
{
constexpr double mass = 4.0;          // kg
constexpr double stiffness = 1600.0;  // N/m: 20 rad/s on the stop
constexpr double omega = 20.0;

/// The one mode of that mass: it moves as a whole.
Mode bodyMode()
{
  return Mode{0.0, 1.0 / std::sqrt(mass), std::sqrt(mass)};
}

std::shared_ptr<const SwitchedModel> freeMass(double clearance, const DampingParameters& damping = {})
{
  return std::make_shared<const SwitchedModel>(std::vector<Mode>{bodyMode()}, ContactParameters{stiffness, clearance},
                                               damping);
}

/// Displacement (m) and velocity (m/s) of that mass.
void setMass(SwitchedMotion& motion, double displacement, double velocity)
{
  motion.setFreeCoordinates(Eigen::VectorXd::Constant(1, displacement * std::sqrt(mass)),
                            Eigen::VectorXd::Constant(1, velocity * std::sqrt(mass)));
}

double onsetTime(const Impact& impact, double interval)
{
  return static_cast<double>(impact.interval) * interval + impact.offset;
}

TEST(FreeBody, thrownAtASpringStop)
{
  const double speed = 1.5;
  for (const bool phasor : {false, true})
  {
    for (const double interval : {1e-3, 0.3, 2.0})
    {
      SwitchedMotion motion(freeMass(0.3), phasor);
      Recorder recorder;
      if (phasor)
      {
        motion.setHarmonicDrive(2.0 * pi / interval, 0.0);
      }
      else
      {
        motion.setInterval(interval);
      }
      setMass(motion, 0.0, -speed);
      for (double time = 0.0; time < 1.0; time += interval)
      {
        phasor ? motion.advanceHarmonic(recorder) : motion.advanceLinear(0.0, 0.0, recorder);
      }
      ASSERT_EQ(recorder.impacts.size(), 1u);
      const Impact& impact = recorder.impacts[0];
      EXPECT_NEAR(onsetTime(impact, interval), 0.3 / speed, 1e-12);
      EXPECT_NEAR(impact.duration, pi / omega, 1e-12);
      EXPECT_NEAR(impact.impulse, 2.0 * mass * speed, 1e-11);
      EXPECT_NEAR(impact.peak_force, speed * std::sqrt(stiffness * mass), 1e-8);
      EXPECT_NEAR(impact.separation_speed, speed, 1e-12);
      EXPECT_NEAR(impact.energy_lost, 0.0, 1e-12);
      EXPECT_NEAR(motion.gapRate(), speed, 1e-12);
    }
  }
}

TEST(FreeBody, bouncesInParabolasOnABaseOfConstantAcceleration)
{
  const double acceleration = 9.0;
  const double height = 0.5;
  const double speed = std::sqrt(2.0 * acceleration * height);
  const double flight = 2.0 * speed / acceleration;
  // In contact g = -a/omega^2 (1 - cos omega t) - v/omega sin omega t, zero again where tan(omega t/2) = -omega v/a.
  const double contact = 2.0 * (pi - std::atan(omega * speed / acceleration)) / omega;
  for (const double interval : {1e-3, 0.0937, 5.0})
  {
    SwitchedMotion motion(freeMass(0.0), false);
    motion.setInterval(interval);
    setMass(motion, height, 0.0);
    Recorder recorder;
    for (double time = 0.0; time < 20.0; time += interval)
    {
      motion.advanceLinear(acceleration, acceleration, recorder);
    }
    ASSERT_GT(recorder.impacts.size(), 20u);
    for (std::size_t i = 0; i < recorder.impacts.size(); ++i)
    {
      const Impact& impact = recorder.impacts[i];
      EXPECT_NEAR(onsetTime(impact, interval), 0.5 * flight + static_cast<double>(i) * (flight + contact), 1e-10);
      EXPECT_NEAR(impact.duration, contact, 1e-11);
      EXPECT_NEAR(impact.approach_speed, speed, 1e-10);
      EXPECT_NEAR(impact.impulse, mass * (2.0 * speed + acceleration * contact), 1e-9);
    }
  }
}

TEST(FreeBody, flightUnderARampIsACubic)
{
  // h = v t - a t^2/2 - s t^3/6, back at t = 1 for v = a/2 + s/6.
  const double acceleration = 3.0;
  const double slope = 24.0;
  const double speed = acceleration / 2.0 + slope / 6.0;
  for (const double interval : {0.01, 0.3, 1.7})
  {
    SwitchedMotion motion(freeMass(0.0), false);
    motion.setInterval(interval);
    setMass(motion, 0.0, speed);
    Recorder recorder;
    for (int i = 0; recorder.impacts.empty(); ++i)
    {
      const double start = i * interval;
      motion.advanceLinear(acceleration + slope * start, acceleration + slope * (start + interval), recorder);
      const double t = start + interval;
      if (t < 1.0)
      {
        EXPECT_NEAR(motion.gap(), t * (speed - t * (acceleration / 2.0 + slope * t / 6.0)), 1e-13);
        EXPECT_NEAR(motion.gapRate(), speed - t * (acceleration + slope * t / 2.0), 1e-13);
      }
    }
    EXPECT_NEAR(onsetTime(recorder.impacts[0], interval), 1.0, 1e-12);
    EXPECT_NEAR(recorder.impacts[0].approach_speed, -(speed - acceleration - slope / 2.0), 1e-11);
  }
}

TEST(FreeBody, followsAHarmonicBase)
{
  // Absolutely at rest, or in uniform motion, while the base moves by e = A/Omega^2 cos(Omega t).
  const double frequency = 7.0;
  const double amplitude = 3.0;
  SwitchedMotion motion(freeMass(0.2), true);
  motion.setHarmonicDrive(frequency, amplitude);
  setMass(motion, 0.0, 0.05);
  Recorder recorder;
  for (int i = 1; i <= 50; ++i)
  {
    motion.advanceHarmonic(recorder);
    EXPECT_NEAR(motion.gap(), 0.2 + 0.05 * i * 2.0 * pi / frequency, 1e-12);
    EXPECT_NEAR(motion.gapRate(), 0.05, 1e-13);
  }
  EXPECT_TRUE(recorder.impacts.empty());
  EXPECT_EQ(motion.switches(), 0u);
}

TEST(FreeBody, comesToRestOnItsSpringUnderAConstantAcceleration)
{
  const double acceleration = 9.0;
  SwitchedMotion motion(freeMass(0.0, {0.0, 0.3}), false);
  motion.setInterval(1e-3);
  Recorder recorder;
  for (int i = 0; i < 10000; ++i)
  {
    motion.advanceLinear(acceleration, acceleration, recorder);
  }
  EXPECT_TRUE(recorder.impacts.empty());
  EXPECT_NEAR(motion.force(), mass * acceleration, 1e-9);
  EXPECT_NEAR(motion.gap(), -mass * acceleration / stiffness, 1e-12);
}

TEST(FreeBody, restsWhereNothingPressesIt)
{
  for (const double clearance : {0.1, 0.0, -0.1})
  {
    SwitchedMotion motion(freeMass(clearance), false);
    motion.setInterval(0.01);
    Recorder recorder;
    for (int i = 0; i < 100; ++i)
    {
      EXPECT_FALSE(motion.inContact());
      EXPECT_NEAR(motion.gap(), std::max(0.0, clearance), 1e-16);
      EXPECT_EQ(motion.force(), 0.0);
      motion.advanceLinear(0.0, 0.0, recorder);
    }
    EXPECT_TRUE(recorder.impacts.empty());
  }
}

TEST(FreeBody, twoFreeBodiesKeepTheirCommonMotion)
{
  // 4 kg against 1 kg: momentum and energy as of a collision of two masses.
  const std::vector<Mode> modes = {Mode{0.0, 0.5, 2.0}, Mode{0.0, -1.0, 1.0}};
  const SwitchedModel model(modes, {stiffness, 0.0}, {});
  ASSERT_EQ(model.contact().size(), 2);
  EXPECT_EQ(model.contact().frequency(0), 0.0);
  EXPECT_EQ(model.contact().contact_deflection(0), 0.0);
  EXPECT_NEAR(model.contact().frequency(1), std::sqrt(stiffness * 1.25), 1e-12);
  // The base moves both alike: not the gap, but with all of their mass.
  EXPECT_EQ(model.free().participation(0), 0.0);
  EXPECT_NEAR(model.free().participation(1), std::sqrt(5.0), 1e-15);
}

TEST(FreeBody, energyIsConstantOverAThousandImpacts)
{
  // A free body with an elastic mode falls on an elastic structure; the work of the base is -m a times its height.
  const std::vector<Mode> modes = {bodyMode(), Mode{9.0, 0.6, 0.0}, Mode{5.0, -0.4, 0.0}, Mode{13.0, -0.3, 0.0}};
  const double acceleration = 2.0;
  SwitchedMotion motion(
      std::make_shared<const SwitchedModel>(modes, ContactParameters{500.0, 0.0}, DampingParameters{}), false);
  motion.setInterval(0.01);
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(4);
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(4);
  displacement(0) = 1.0;
  motion.setFreeCoordinates(displacement, velocity);
  const auto total = [&]
  {
    motion.coordinates(displacement, velocity);
    if (motion.inContact())
    {
      displacement = motion.model().mapping() * displacement;
    }
    return motion.energy() + acceleration * std::sqrt(mass) * displacement(0);
  };
  const double start = total();
  Recorder recorder;
  while (recorder.impacts.size() < 1000)
  {
    motion.advanceLinear(acceleration, acceleration, recorder);
    ASSERT_NEAR(total(), start, 1e-9 * start);
  }
}

/// A free body with an elastic mode, an elastic structure opposite, and a body that does not touch.
std::shared_ptr<const SwitchedModel> bodyOnAStructure(double clearance)
{
  const std::vector<Mode> modes = {Mode{0.0, 1.0, 1.0}, Mode{6.0, 0.7, 0.0}, Mode{2.5, -0.5, 0.8}, Mode{7.0, -0.4, 0.2},
                                   Mode{0.0, 0.0, 1.3}};
  return std::make_shared<const SwitchedModel>(modes, ContactParameters{300.0, clearance},
                                               DampingParameters{0.02, 0.05});
}

class FreeBodyIntegrated : public ::testing::Test
{
protected:
  void compare(const SwitchedMotion& motion, const Integrator& integrator, double time)
  {
    ASSERT_EQ(motion.inContact(), integrator.inContact()) << time;
    Eigen::VectorXd displacement;
    Eigen::VectorXd velocity;
    motion.coordinates(displacement, velocity);
    greatest_ = std::max(greatest_, integrator.displacement().norm());
    EXPECT_LE((displacement - integrator.displacement()).norm(), 1e-9 * greatest_) << time;
    EXPECT_NEAR(motion.gap(), integrator.gap(), 1e-9 * greatest_) << time;
  }
  static void compareImpacts(const std::vector<Impact>& impacts, const std::vector<Episode>& episodes, double interval)
  {
    ASSERT_EQ(impacts.size(), episodes.size());
    for (std::size_t i = 0; i < impacts.size(); ++i)
    {
      SCOPED_TRACE(::testing::Message() << "impact " << i);
      EXPECT_NEAR(onsetTime(impacts[i], interval), episodes[i].onset, 1e-8);
      EXPECT_NEAR(impacts[i].duration, episodes[i].duration, 1e-8);
      EXPECT_NEAR(impacts[i].impulse, episodes[i].impulse, 1e-8);
      EXPECT_NEAR(impacts[i].peak_force, episodes[i].peak_force, 1e-7);
      EXPECT_NEAR(impacts[i].approach_speed, episodes[i].approach_speed, 1e-8);
      EXPECT_NEAR(impacts[i].separation_speed, episodes[i].separation_speed, 1e-8);
      EXPECT_NEAR(impacts[i].energy_lost, episodes[i].energy_lost, 1e-8);
    }
  }
  double greatest_ = 0.0;
};

TEST_F(FreeBodyIntegrated, agreesUnderASampledDrive)
{
  const auto model = bodyOnAStructure(0.0);
  const double period = 0.05;
  const auto sample = [](int i) { return 1.0 + 0.8 * std::sin(1.3 * 0.05 * i) + 0.3 * std::cos(4.1 * 0.05 * i); };
  int interval = 0;
  SwitchedMotion motion(model, false);
  Integrator integrator(model,
                        [&](double time)
                        {
                          const double share = time / period - interval;
                          return (1.0 - share) * sample(interval) + share * sample(interval + 1);
                        });
  motion.setInterval(period);
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(model->free().size());
  displacement(0) = 0.5;
  const Eigen::VectorXd velocity = Eigen::VectorXd::Constant(displacement.size(), -0.1);
  motion.setFreeCoordinates(displacement, velocity);
  integrator.startFree(displacement, velocity);
  Recorder recorder;
  for (; interval < 800; ++interval)
  {
    motion.advanceLinear(sample(interval), sample(interval + 1), recorder);
    integrator.advance((interval + 1) * period);
    compare(motion, integrator, (interval + 1) * period);
  }
  compareImpacts(recorder.impacts, integrator.episodes(), period);
  EXPECT_GT(recorder.impacts.size(), 15u);
}

TEST_F(FreeBodyIntegrated, agreesUnderAHarmonicDrive)
{
  // Nothing brings the body back for ever: it is thrown at the structure, which hits it several times.
  const auto model = bodyOnAStructure(0.4);
  const double frequency = 1.1;
  const double cycle = 2.0 * pi / frequency;
  SwitchedMotion motion(model, true);
  Integrator integrator(model, [&](double time) { return -1.5 * std::cos(frequency * time); });
  const Eigen::VectorXd displacement = Eigen::VectorXd::Zero(model->free().size());
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(displacement.size());
  velocity(0) = -1.0;
  velocity(1) = 0.3;
  motion.setFreeCoordinates(displacement, velocity);
  integrator.startFree(displacement, velocity);
  motion.setHarmonicDrive(frequency, 1.5);
  Recorder recorder;
  for (int i = 1; i <= 10; ++i)
  {
    motion.advanceHarmonic(recorder);
    integrator.advance(i * cycle);
    compare(motion, integrator, i * cycle);
  }
  compareImpacts(recorder.impacts, integrator.episodes(), cycle);
  EXPECT_GT(recorder.impacts.size(), 2u);
}

}  // namespace
}  // namespace vibro_impact::core
