// The motion against an independent integrator.

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "independent_integrator.h"
#include "reference_system.h"
#include "sanitized.h"
#include "switched_motion.h"
#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
namespace
{
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

constexpr int cycles = sanitized ? 8 : 20;
constexpr double tolerance = 1.0e-8;

class IndependentIntegrator : public ::testing::TestWithParam<Case>
{
protected:
  IndependentIntegrator()
  {
    SystemParameters parameters = GetParam().parameters;
    const double frequency = referenceScales(parameters).frequency;
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
      integrator.startFree(start_, Eigen::VectorXd::Zero(start_.size()));
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

  void compareImpacts(std::vector<Impact> impacts, const std::vector<Episode>& episodes, double interval) const
  {
    // The integrator counts whole episodes only.
    impacts.erase(std::remove_if(impacts.begin(), impacts.end(), [](const Impact& impact) { return impact.cut_short; }),
                  impacts.end());
    ASSERT_EQ(impacts.size(), episodes.size());
    ASSERT_GT(impacts.size(), 2u * cycles / 5u);
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
  beamOf(parameters.beam1).contact_location = 0.02;
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
