// What must hold whatever the parameters and the drive: forces only push, and every number that is reported makes
// sense.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "reference_system.h"
#include "switched_motion.h"
#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
namespace
{
class Dice
{
public:
  explicit Dice(std::uint64_t seed) : engine_(seed)
  {
  }
  double between(double low, double high)
  {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  double decades(double low, double high)
  {
    return std::pow(10.0, between(low, high));
  }
  bool chance(double probability)
  {
    return between(0.0, 1.0) < probability;
  }
  int whole(int low, int high)
  {
    return std::min(high, low + static_cast<int>(between(0.0, 1.0) * (high - low + 1)));
  }

private:
  std::mt19937_64 engine_;
};

double contactShare(Dice& dice)
{
  switch (dice.whole(0, 3))
  {
    case 0:
      return 0.5;
    case 1:
      return 1.0 / dice.whole(3, 6);
    default:
      return dice.between(0.02, 0.98);
  }
}

SystemParameters randomParameters(Dice& dice)
{
  SystemParameters parameters;
  parameters.beam1 = paperBeam();
  beamOf(parameters.beam1).contact_location = contactShare(dice) * beamOf(parameters.beam1).length;
  BeamParameters beam2 = beamOf(parameters.beam1);
  switch (dice.whole(0, 4))
  {
    case 0:
      parameters.beam2 = RigidSurface{};
      break;
    case 1:
      parameters.beam2 = beam2;  // identical
      break;
    case 2:
      beam2.youngs_modulus *= 1000.0;
      parameters.beam2 = beam2;
      break;
    default:
      beam2.youngs_modulus *= dice.decades(-1.0, 3.0);
      beam2.length *= dice.between(0.6, 1.5);
      std::get<Rectangle>(beam2.cross_section).height *= dice.between(0.6, 1.5);
      beam2.contact_location = contactShare(dice) * beam2.length;
      parameters.beam2 = beam2;
  }
  parameters.contact.stiffness = paperStiffnessUnit() * dice.decades(-3.0, 6.0);
  parameters.damping.free = dice.chance(0.3) ? 0.0 : dice.between(0.0, 0.2);
  parameters.damping.contact = dice.chance(0.3) ? 0.0 : dice.between(0.0, 0.2);
  parameters.basis = AttachmentBasis{dice.whole(1, 8)};
  // Deflections are of the order of a/omega_11^2, with a = 1 m/s^2.
  const double deflection = 1.0 / std::pow(referenceScales(parameters).frequency, 2.0);
  const double size = deflection * dice.decades(-4.0, 0.5);
  const auto sign = static_cast<double>(dice.whole(-1, 1));
  parameters.contact.clearance = sign * size;
  return parameters;
}

/// Samples of a drive of the order of 1 m/s^2.
std::vector<double> randomDrive(Dice& dice, std::size_t count, double samples_per_cycle)
{
  std::vector<double> drive(count);
  const int kind = dice.whole(0, 3);
  const double second = dice.between(0.1, 10.0);
  const double depth = dice.between(0.0, 1.0);
  double level = 0.0;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double angle = two_pi * static_cast<double>(i) / samples_per_cycle;
    switch (kind)
    {
      case 0:
        drive[i] = -std::cos(angle);
        break;
      case 1:
        drive[i] = (1.0 - depth) * std::sin(angle) + depth * std::sin(second * angle);
        break;
      case 2:
        drive[i] = dice.between(-3.0, 3.0);
        break;
      default:  // steps, with silence between them
        if (dice.chance(2.0 / samples_per_cycle))
        {
          level = dice.chance(0.3) ? 0.0 : dice.between(-2.0, 2.0);
        }
        drive[i] = level;
    }
  }
  return drive;
}

/// Watches a motion, sample by sample and impact by impact.
class Watch : public ImpactSink
{
public:
  /// Of a motion at rest, under no more than the given acceleration and slope of acceleration.
  Watch(const SwitchedMotion& motion, double interval, double acceleration, double slope)
      : motion_(motion), interval_(interval), acceleration_(acceleration), gap_(motion.gap()), energy_(motion.energy())
  {
    const LinearState& free = motion.model().free();
    deflection_norm_ = free.contact_deflection.matrix().norm();
    participation_norm_ = free.participation.matrix().norm();
    // The motion is computed from parts that follow the drive's value and slope, and is as exact as they are.
    const Eigen::ArrayXd follower =
        free.participation.abs() / free.frequency.square() * (acceleration + slope / free.frequency);
    follower_gap_ = std::abs(motion.model().clearance()) + (free.contact_deflection.abs() * follower).sum();
    follower_energy_ = (free.frequency * follower).matrix().squaredNorm() +
                       0.5 * motion.model().stiffness() * follower_gap_ * follower_gap_;
    lossless_contact_ = (motion.model().contact().damping_ratio == 0.0).all();
  }

  void onImpact(const Impact& impact) override
  {
    EXPECT_EQ(impact.number, impacts_);
    ++impacts_;
    EXPECT_TRUE(std::isfinite(impact.offset) && std::isfinite(impact.duration) && std::isfinite(impact.impulse) &&
                std::isfinite(impact.peak_force) && std::isfinite(impact.peak_time) &&
                std::isfinite(impact.approach_speed) && std::isfinite(impact.separation_speed) &&
                std::isfinite(impact.energy_lost));
    EXPECT_GE(impact.impulse, 0.0);
    EXPECT_GE(impact.duration, 0.0);
    EXPECT_GE(impact.peak_force, sampled_peak_);
    EXPECT_GE(impact.approach_speed, 0.0);
    EXPECT_GE(impact.separation_speed, 0.0);
    EXPECT_GE(impact.peak_time, 0.0);
    EXPECT_LE(impact.peak_time, impact.duration + slack());
    EXPECT_LE(impact.impulse, impact.peak_force * (impact.duration + slack()) * (1.0 + 1.0e-9) +
                                  motion_.model().stiffness() * gapRounding() * interval_);
    sampled_peak_ = 0.0;

    EXPECT_GE(impact.offset, -slack());
    EXPECT_LE(impact.offset, interval_ + slack());
    const double onset = static_cast<double>(impact.interval) * interval_ + impact.offset;
    EXPECT_GE(onset, release_ - slack());
    release_ = onset + impact.duration;

    noteEnergy();
    EXPECT_GE(impact.energy_lost, -energyRounding());
    if (lossless_contact_)
    {
      EXPECT_LE(impact.energy_lost, energyRounding());
    }
    if (!impact.cut_short)
    {
      // The motion is past the switch already, in the free state, and the gap is where contact left it.
      EXPECT_FALSE(motion_.inContact());
      EXPECT_LE(std::abs(motion_.gap()), slack() * impact.separation_speed + gapRounding());
    }
  }

  /// After each interval.
  void takeSample()
  {
    const double gap = motion_.gap();
    const double force = motion_.force();
    EXPECT_TRUE(std::isfinite(gap) && std::isfinite(force));
    EXPECT_GE(force, 0.0);
    if (force > 0.0)
    {
      EXPECT_TRUE(motion_.inContact());
      EXPECT_EQ(force, -motion_.model().stiffness() * gap);
      sampled_peak_ = std::max(sampled_peak_, force);
    }
    else
    {
      // No gap below zero without a force.
      EXPECT_GE(gap, -slack() * std::abs(motion_.gapRate()) - gapRounding());
    }
    // |g'| <= |b| |eta'| <= |b| sqrt(2 energy), and the base adds no more than |Gamma| a to that root in a second.
    const double velocity = std::sqrt(2.0 * energy_) + participation_norm_ * acceleration_ * interval_;
    EXPECT_LE(std::abs(gap - gap_), deflection_norm_ * velocity * interval_ + gapRounding());
    gap_ = gap;
    noteEnergy();
    energy_ = motion_.energy();
  }

  std::uint64_t impacts() const
  {
    return impacts_;
  }

private:
  void noteEnergy()
  {
    EXPECT_TRUE(std::isfinite(motion_.energy()));
    greatest_energy_ = std::max(greatest_energy_, motion_.energy());
  }

  /// How far past a root the motion may be, s.
  double slack() const
  {
    return 2048.0 * motion_.tick() + 1.0e-15 * static_cast<double>(motion_.intervals() + 1) * interval_;
  }

  double gapRounding() const
  {
    const double reach = std::sqrt(2.0 * greatest_energy_) / motion_.model().free().frequency(0);  // bounds |eta|
    return 1.0e-12 * (follower_gap_ + deflection_norm_ * reach);
  }

  double energyRounding() const
  {
    const auto intervals = static_cast<double>(motion_.intervals() + 1);
    return 1.0e-11 * greatest_energy_ + 1.0e-12 * intervals * follower_energy_;
  }

  const SwitchedMotion& motion_;
  double interval_;
  double acceleration_;
  double deflection_norm_ = 0.0;
  double participation_norm_ = 0.0;
  double follower_gap_ = 0.0;
  double follower_energy_ = 0.0;
  bool lossless_contact_ = false;
  double gap_;
  double energy_;
  double greatest_energy_ = 0.0;
  double sampled_peak_ = 0.0;
  double release_ = -1.0;
  std::uint64_t impacts_ = 0;
};

struct Totals
{
  std::uint64_t impacts = 0;
  std::uint64_t intervals = 0;
  std::uint64_t steps = 0;
  int moving = 0;  // configurations with an impact
};

void check(SwitchedMotion& motion, Watch& watch, Totals& totals)
{
  motion.interrupt(watch);
  EXPECT_EQ(motion.switchLimitReached(), 0u);
  totals.impacts += watch.impacts();
  totals.intervals += motion.intervals();
  totals.steps += motion.steps();
  totals.moving += watch.impacts() > 1 ? 1 : 0;
}

void runSampled(const std::shared_ptr<const SwitchedModel>& model, Dice& dice, Totals& totals)
{
  const double omega_star = dice.decades(-0.5, 0.9);
  const double samples_per_cycle = dice.chance(0.5) ? dice.between(50.0, 1000.0) : dice.between(1.5, 20.0);
  const double period = two_pi / (omega_star * model->scales().frequency * samples_per_cycle);
  const std::size_t count = std::min<std::size_t>(400, static_cast<std::size_t>(20.0 * samples_per_cycle));
  const std::vector<double> drive = randomDrive(dice, count, samples_per_cycle);
  SwitchedMotion motion(model, false);
  motion.setInterval(period);
  motion.rest();
  double greatest = std::abs(drive[0]);
  double steepest = 0.0;
  for (std::size_t i = 1; i < count; ++i)
  {
    greatest = std::max(greatest, std::abs(drive[i]));
    steepest = std::max(steepest, std::abs(drive[i] - drive[i - 1]) / period);
  }
  Watch watch(motion, period, greatest, steepest);
  for (std::size_t i = 1; i < count; ++i)
  {
    motion.advanceLinear(drive[i - 1], drive[i], watch);
    watch.takeSample();
  }
  check(motion, watch, totals);
}

void runHarmonic(const std::shared_ptr<const SwitchedModel>& model, Dice& dice, Totals& totals)
{
  const double frequency = dice.decades(-0.5, 0.9) * model->scales().frequency;
  SwitchedMotion motion(model, true);
  motion.setHarmonicDrive(frequency, 1.0);
  Watch watch(motion, two_pi / frequency, 1.0, frequency);
  for (int cycle = 0; cycle < 20; ++cycle)
  {
    motion.advanceHarmonic(watch);
    watch.takeSample();
  }
  check(motion, watch, totals);
}

TEST(RandomConfigurations, ForcesOnlyPushAndEveryNumberMakesSense)
{
  constexpr int configurations = 1000;
  Totals totals;
  for (int seed = 0; seed < configurations; ++seed)
  {
    SCOPED_TRACE(::testing::Message() << "configuration " << seed);
    Dice dice(static_cast<std::uint64_t>(seed));
    const auto model = std::make_shared<const SwitchedModel>(randomParameters(dice));
    if (dice.chance(0.75))
    {
      runSampled(model, dice, totals);
    }
    else
    {
      runHarmonic(model, dice, totals);
    }
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
  // The configurations are worth the name, and none of them costs much.
  EXPECT_GT(totals.moving, configurations / 2);
  EXPECT_GT(totals.impacts, 10u * configurations);
  EXPECT_LT(totals.steps, 100u * totals.intervals);
}

}  // namespace
}  // namespace vibro_impact::core
