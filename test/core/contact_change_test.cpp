// Clearance and stiffness changed while the structures move.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "direct_integrator.h"
#include "reference_system.h"
#include "switched_motion.h"
#include "vibro_impact/core/simulation.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
namespace
{
constexpr double sample_period = 2.0e-5;
constexpr double typical_gap = 1.0e-5;  // m, at the drive below

SystemParameters undamped(const BasisParameters& basis = AttachmentBasis{3})
{
  SystemParameters parameters = limitingCase(1000.0, basis);
  parameters.damping = {0.0, 0.0};
  return parameters;
}

std::shared_ptr<const SwitchedModel> modelWith(SystemParameters parameters, double stiffness_factor, double clearance)
{
  parameters.contact.stiffness *= stiffness_factor;
  parameters.contact.clearance = clearance;
  return std::make_shared<const SwitchedModel>(parameters);
}

/// Near the resonance: an impact in every cycle of 115 samples.
double acceleration(std::size_t i)
{
  return 10.0 * std::sin(1.6 * 1705.6 * static_cast<double>(i) * sample_period);
}

/// A simulation and all that came of it, sample by sample.
class Motion
{
public:
  explicit Motion(std::shared_ptr<const SwitchedModel> model) : simulation(std::move(model), sample_period)
  {
  }
  void advanceTo(std::size_t end)
  {
    while (gap.size() < end)
    {
      const double sample = acceleration(gap.size());
      gap.emplace_back();
      force.emplace_back();
      simulation.advance(&sample, 1, &gap.back(), &force.back(), recorder);
    }
  }
  /// The first sample from `at_least` on with the wanted state.
  std::size_t advanceUntil(bool in_contact, std::size_t at_least)
  {
    do
    {
      advanceTo(gap.size() + 1);
    } while (gap.size() < at_least || simulation.inContact() != in_contact);
    return gap.size();
  }

  SampledSimulation simulation;
  Recorder recorder;
  std::vector<double> gap;
  std::vector<double> force;
};

void advance(DirectIntegrator& integrator, std::size_t from, std::size_t to)
{
  for (std::size_t i = from; i < to; ++i)
  {
    const double start = acceleration(i - 1);
    const double slope = (acceleration(i) - start) / sample_period;
    integrator.advance(sample_period, [=](double time) { return start + slope * time; });
  }
}

/// The contact changes at these samples, in contact and apart, open and pressed, softer and stiffer.
struct Change
{
  std::size_t sample;
  double stiffness_factor;
  double clearance;
};

TEST(ContactChange, AgreesWithADirectIntegration)
{
  const std::vector<Change> changes = {{150, 1.0, 0.2 * typical_gap},  {310, 2.0, 0.2 * typical_gap},
                                       {420, 0.3, -0.5 * typical_gap}, {505, 0.3, 0.1 * typical_gap},
                                       {560, 4.0, -0.3 * typical_gap}, {700, 1.0, 0.0},
                                       {760, 1.0, -3.0 * typical_gap}, {850, 1.5, 0.05 * typical_gap}};
  auto model = modelWith(undamped(), 1.0, 0.0);
  Motion run(model);
  DirectIntegrator integrator(model);
  run.advanceTo(1);
  std::size_t now = 1;
  int in_contact = 0;
  const auto follow = [&](std::size_t end)
  {
    while (now < end)
    {
      run.advanceTo(now + 1);
      advance(integrator, now, now + 1);
      ASSERT_NEAR(run.gap[now], integrator.gap(), 1.0e-6 * typical_gap) << "sample " << now;
      ++now;
    }
  };
  for (const Change& change : changes)
  {
    follow(change.sample);
    in_contact += run.simulation.inContact() ? 1 : 0;
    model = modelWith(undamped(), change.stiffness_factor, change.clearance);
    run.simulation.setModel(model, run.recorder);
    integrator.setModel(model);
  }
  follow(1000);
  EXPECT_GE(in_contact, 2);
  EXPECT_LE(in_contact, 6);
  // Nothing of the force is missing in the impulses: every episode counts, whole or cut short.
  run.simulation.finish(run.recorder);
  double impulse = 0.0;
  for (const Impact& impact : run.recorder.impacts)
  {
    impulse += impact.impulse;
    EXPECT_NEAR(impact.energy_lost, 0.0, 1.0e-9 * impact.peak_force * typical_gap);
  }
  EXPECT_NEAR(impulse, integrator.impulse(), 1.0e-6 * impulse);
}

TEST(ContactChange, ThatChangesNothingIsNotFelt)
{
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{3}), BasisParameters(ConjoinedBasis{3, 2})})
  {
    SystemParameters parameters = limitingCase(1000.0, basis);
    parameters.contact.clearance = -0.01 * typical_gap;
    const auto model = std::make_shared<const SwitchedModel>(parameters);
    Motion expected(model);
    Motion run(model);
    expected.advanceTo(6000);
    for (std::size_t i = 37; i <= 6000; i += 37)
    {
      run.advanceTo(i);
      run.simulation.setModel(model, run.recorder);
    }
    run.advanceTo(6000);
    for (std::size_t i = 0; i < 6000; ++i)
    {
      ASSERT_NEAR(run.gap[i], expected.gap[i], 1.0e-9 * typical_gap) << i;
    }
    ASSERT_GT(expected.recorder.impacts.size(), 40u);
    ASSERT_EQ(run.recorder.impacts.size(), expected.recorder.impacts.size());
    for (std::size_t i = 0; i < expected.recorder.impacts.size(); ++i)
    {
      const Impact& impact = run.recorder.impacts[i];
      const Impact& reference = expected.recorder.impacts[i];
      EXPECT_EQ(impact.number, reference.number);
      EXPECT_EQ(impact.interval, reference.interval);
      EXPECT_EQ(impact.cut_short, reference.cut_short);
      EXPECT_NEAR(impact.duration, reference.duration, 1.0e-9 * reference.duration);
      EXPECT_NEAR(impact.impulse, reference.impulse, 1.0e-9 * reference.impulse);
      EXPECT_NEAR(impact.peak_force, reference.peak_force, 1.0e-8 * reference.peak_force);
      EXPECT_NEAR(impact.peak_time, reference.peak_time, 1.0e-5 * reference.duration);
      EXPECT_NEAR(impact.energy_lost, reference.energy_lost, 1.0e-7 * reference.peak_force * typical_gap);
    }
  }
}

TEST(ContactChange, OpenEpisodeGoesOnWhileInContact)
{
  const SystemParameters parameters = undamped();
  Motion run(modelWith(parameters, 1.0, 0.0));
  const std::size_t at = run.advanceUntil(true, 1000);
  const std::size_t before = run.recorder.impacts.size();
  run.simulation.setModel(modelWith(parameters, 2.0, -0.01 * typical_gap), run.recorder);
  EXPECT_EQ(run.recorder.impacts.size(), before);
  EXPECT_TRUE(run.simulation.inContact());
  run.advanceUntil(false, at + 1);
  ASSERT_EQ(run.recorder.impacts.size(), before + 1);
  const Impact& impact = run.recorder.impacts.back();
  EXPECT_FALSE(impact.cut_short);
  EXPECT_LT(impact.interval, at) << "its onset is before the change";
  const auto first = run.force.begin() + static_cast<std::ptrdiff_t>(impact.interval);
  EXPECT_GE(impact.peak_force, *std::max_element(first, run.force.end()));
}

TEST(ContactChange, EpisodeThatItEndsIsCutShort)
{
  const SystemParameters parameters = undamped();
  Motion run(modelWith(parameters, 1.0, 0.0));
  const std::size_t at = run.advanceUntil(true, 1000);
  const std::size_t before = run.recorder.impacts.size();
  run.simulation.setModel(modelWith(parameters, 1.0, 10.0 * typical_gap), run.recorder);
  EXPECT_FALSE(run.simulation.inContact());
  ASSERT_EQ(run.recorder.impacts.size(), before + 1);
  const Impact& impact = run.recorder.impacts.back();
  EXPECT_TRUE(impact.cut_short);
  EXPECT_EQ(impact.number, before);
  EXPECT_EQ(impact.separation_speed, 0.0);
  const double end = static_cast<double>(impact.interval) * sample_period + impact.offset + impact.duration;
  EXPECT_NEAR(end, static_cast<double>(at - 1) * sample_period, 1.0e-9 * sample_period);
  run.advanceTo(at + 20);
  EXPECT_EQ(run.force.back(), 0.0);
}

TEST(ContactChange, EpisodeThatItBeginsIsCutShort)
{
  const SystemParameters parameters = undamped();
  Motion run(modelWith(parameters, 1.0, 0.0));
  const std::size_t at = run.advanceUntil(false, 1000);
  run.simulation.setModel(modelWith(parameters, 1.0, -10.0 * typical_gap), run.recorder);
  EXPECT_TRUE(run.simulation.inContact());
  run.simulation.finish(run.recorder);
  const Impact& impact = run.recorder.impacts.back();
  EXPECT_TRUE(impact.cut_short);
  EXPECT_EQ(impact.interval, at - 1);
  EXPECT_EQ(impact.offset, 0.0);
  EXPECT_EQ(impact.approach_speed, 0.0);
}

TEST(ContactChange, PressedTogetherItSettlesInTheNewEquilibrium)
{
  const SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{3});
  const auto worn = modelWith(parameters, 0.5, -2.0e-6);
  SampledSimulation simulation(modelWith(parameters, 1.0, -1.0e-6), sample_period);
  SampledSimulation rested(worn, sample_period);
  Recorder recorder;
  const std::vector<double> quiet(20000, 0.0);
  std::vector<double> gap(quiet.size());
  std::vector<double> force(quiet.size());
  rested.advance(quiet.data(), 1, gap.data(), force.data(), recorder);
  const double expected = force[0];
  simulation.advance(quiet.data(), 10, gap.data(), force.data(), recorder);
  simulation.setModel(worn, recorder);
  simulation.advance(quiet.data(), quiet.size(), gap.data(), force.data(), recorder);
  EXPECT_GT(std::abs(force[0] - expected), 0.01 * expected) << "beforehand it vibrates";
  EXPECT_NEAR(force.back(), expected, 1.0e-9 * expected);
}

TEST(ContactChange, BeforeTheFirstSampleItIsAtRest)
{
  const SystemParameters parameters = undamped();
  Motion run(modelWith(parameters, 1.0, 0.0));
  const auto pressed = modelWith(parameters, 1.0, -typical_gap);
  run.simulation.setModel(pressed, run.recorder);
  Motion expected(pressed);
  run.advanceTo(500);
  expected.advanceTo(500);
  EXPECT_EQ(run.gap, expected.gap);
  EXPECT_EQ(run.force, expected.force);
}

TEST(ContactChange, EnergyChangesByThatOfTheSpringAlone)
{
  const SystemParameters parameters = undamped();
  const auto model = modelWith(parameters, 1.0, -typical_gap);
  SwitchedMotion motion(model, false);
  motion.setInterval(sample_period);
  Recorder recorder;
  for (std::size_t i = 0; i < 300; ++i)
  {
    motion.advanceLinear(acceleration(i), acceleration(i + 1), recorder);
  }
  for (const double factor : {0.5, 3.0})
  {
    for (const double clearance : {-2.0 * typical_gap, -0.9 * typical_gap})
    {
      const auto worn = modelWith(parameters, factor, clearance);
      SwitchedMotion before = motion;
      ASSERT_TRUE(before.inContact());
      const double gap = before.gap() + clearance + typical_gap;
      const double spring = 0.5 * (gap < 0.0 ? worn->stiffness() * gap * gap : 0.0) -
                            0.5 * model->stiffness() * before.gap() * before.gap();
      SwitchedMotion after(worn, false);
      after.setInterval(sample_period);
      const double energy = before.energy();
      after.takeOver(before, recorder);
      EXPECT_NEAR(after.energy(), energy + spring, 1.0e-12 * energy);
      EXPECT_NEAR(after.gap(), gap, 1.0e-12 * typical_gap);
    }
  }
}

TEST(ContactChange, OfTheClearanceAloneLosesNothingInTheConjoinedBasis)
{
  const SystemParameters parameters = undamped(ConjoinedBasis{3, 4});
  SwitchedMotion before(modelWith(parameters, 1.0, -typical_gap), false);
  SwitchedMotion after(modelWith(parameters, 1.0, -1.1 * typical_gap), false);
  before.setInterval(sample_period);
  after.setInterval(sample_period);
  Recorder recorder;
  for (std::size_t i = 0; i < 50; ++i)
  {
    before.advanceLinear(acceleration(i), acceleration(i + 1), recorder);
  }
  ASSERT_TRUE(before.inContact());
  Eigen::VectorXd displacement[2];
  Eigen::VectorXd velocity[2];
  before.coordinates(displacement[0], velocity[0]);
  after.takeOver(before, recorder);
  after.coordinates(displacement[1], velocity[1]);
  EXPECT_EQ(displacement[1], displacement[0]);
  EXPECT_EQ(velocity[1], velocity[0]);
}

TEST(ContactChange, TheEnergyAccountCloses)
{
  const std::vector<Change> changes = {{150, 1.0, 0.2 * typical_gap},  {310, 2.0, -0.2 * typical_gap},
                                       {420, 0.3, -0.5 * typical_gap}, {505, 0.3, 0.1 * typical_gap},
                                       {560, 4.0, -0.3 * typical_gap}, {700, 1.0, 0.0},
                                       {760, 1.0, -3.0 * typical_gap}, {850, 1.5, 0.05 * typical_gap}};
  for (const BasisParameters& basis : {BasisParameters(AttachmentBasis{3}), BasisParameters(ConjoinedBasis{2, 2})})
  {
    const SystemParameters parameters = limitingCase(1000.0, basis);
    Motion run(modelWith(parameters, 1.0, -0.1 * typical_gap));
    for (const Change& change : changes)
    {
      run.advanceTo(change.sample);
      const EnergyAccount before = run.simulation.energyAccount();
      EXPECT_LT(before.closure(), 1.0e-9) << "sample " << change.sample;
      run.simulation.setModel(modelWith(parameters, change.stiffness_factor, change.clearance), run.recorder);
      const EnergyAccount after = run.simulation.energyAccount();
      EXPECT_LT(after.closure(), 1.0e-9) << "sample " << change.sample;
      EXPECT_EQ(after.work, before.work);
    }
    run.advanceTo(1000);
    const EnergyAccount account = run.simulation.energyAccount();
    EXPECT_LT(account.closure(), 1.0e-9);
    EXPECT_NE(account.contact_work, 0.0);
    EXPECT_EQ(account.mapping_loss == 0.0, std::holds_alternative<AttachmentBasis>(basis));
  }
}

TEST(ContactChange, OtherStructuresAreRefused)
{
  SystemParameters parameters = undamped();
  Motion expected(modelWith(parameters, 1.0, 0.0));
  Motion run(modelWith(parameters, 1.0, 0.0));
  expected.advanceTo(2000);
  run.advanceTo(1000);
  beamOf(parameters.beam1).density *= 1.0 + 1.0e-12;
  EXPECT_THROW(run.simulation.setModel(modelWith(parameters, 1.0, 0.0), run.recorder), std::invalid_argument);
  EXPECT_THROW(run.simulation.setModel(modelWith(undamped(AttachmentBasis{4}), 1.0, 0.0), run.recorder),
               std::invalid_argument);
  run.advanceTo(2000);
  EXPECT_EQ(run.gap, expected.gap);
}

}  // namespace
}  // namespace vibro_impact::core
