// Structures that are pressed together at rest, against closed forms and an integrator that knows nothing of two
// states.

#include <cmath>
#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "direct_integrator.h"
#include "eigenmodes.h"
#include "reference_system.h"
#include "switched_motion.h"
#include "vibro_impact/core/beam.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/simulation.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
namespace
{
constexpr double interference = 1.0e-6;  // m

struct Case
{
  std::string name;
  SystemParameters parameters;
};

SystemParameters pressed(SystemParameters parameters)
{
  parameters.contact.clearance = -interference;
  return parameters;
}

SystemParameters offCentre()
{
  SystemParameters parameters = limitingCase(300.0, AttachmentBasis{6});
  beamOf(parameters.beam1).contact_location = 0.02;
  auto& beam2 = std::get<BeamParameters>(parameters.beam2);
  beam2.youngs_modulus = 5.0e9;
  beam2.contact_location = 0.017;
  return pressed(parameters);
}

/// Of all structures in it that move.
std::vector<BeamParameters> beams(const SystemParameters& parameters)
{
  std::vector<BeamParameters> result{std::get<BeamParameters>(parameters.beam1)};
  if (const auto* beam2 = std::get_if<BeamParameters>(&parameters.beam2))
  {
    result.push_back(*beam2);
  }
  return result;
}

/// -clearance/(1/k + alpha_1(0) + alpha_2(0))
double preload(const SystemParameters& parameters)
{
  double compliance = 1.0 / parameters.contact.stiffness;
  for (const BeamParameters& beam : beams(parameters))
  {
    compliance += Beam(beam).staticReceptance(0);
  }
  return -parameters.contact.clearance / compliance;
}

/// Gap per base acceleration of the structures in contact, at the drive frequency omega: modes by a general
/// eigensolver, damping ratio in contact.
std::complex<double> gapResponse(const SwitchedModel& model, double damping, double omega)
{
  const Eigen::VectorXd b = model.free().contact_deflection.matrix();
  const Eigen::MatrixXd stiffness =
      Eigen::MatrixXd(model.free().frequency.square().matrix().asDiagonal()) + model.stiffness() * b * b.transpose();
  const Eigenmodes modes = eigenmodes(stiffness);
  std::complex<double> sum = 0.0;
  for (Eigen::Index n = 0; n < b.size(); ++n)
  {
    const Eigen::VectorXd shape = modes.vectors.col(n);
    const double squared = modes.values(n);
    sum -= shape.dot(b) * shape.dot(model.free().participation.matrix()) /
           std::complex<double>(squared - omega * omega, 2.0 * damping * std::sqrt(squared) * omega);
  }
  return sum;
}

/// Deflection at the contact per base acceleration of a beam by itself: the solution of
///   E I v'''' - m' omega^2 v = -m' a,  v = a/omega^2 [1 - cos(lambda eta)/(2 cos(lambda/2)) - cosh(lambda eta)/(2
///   cosh(lambda/2))]
/// with eta = x/L - 1/2.
double baseResponse(const BeamParameters& parameters, double omega)
{
  const double lambda =
      parameters.length * std::pow(massPerLength(parameters) * omega * omega / bendingStiffness(parameters), 0.25);
  const double eta = parameters.contact_location / parameters.length - 0.5;
  return (1.0 - std::cos(lambda * eta) / (2.0 * std::cos(0.5 * lambda)) -
          std::cosh(lambda * eta) / (2.0 * std::cosh(0.5 * lambda))) /
         (omega * omega);
}

class InterferenceFit : public ::testing::TestWithParam<Case>
{
protected:
  SystemParameters parameters_ = GetParam().parameters;
  std::shared_ptr<const SwitchedModel> model_ = std::make_shared<const SwitchedModel>(parameters_);
  double omega_ = 1.3 * model_->scales().frequency;
};

TEST_P(InterferenceFit, RestsInStaticEquilibrium)
{
  const double expected = preload(parameters_);
  SampledSimulation simulation(model_, 2.0e-5);
  const std::vector<double> acceleration(500, 0.0);
  std::vector<double> gap(500);
  std::vector<double> force(500);
  Recorder recorder;
  simulation.advance(acceleration.data(), acceleration.size(), gap.data(), force.data(), recorder);
  for (std::size_t i = 0; i < force.size(); ++i)
  {
    ASSERT_NEAR(force[i], expected, 1.0e-10 * expected) << i;
    ASSERT_NEAR(gap[i], -expected / parameters_.contact.stiffness, 1.0e-10 * interference) << i;
  }
  EXPECT_TRUE(recorder.impacts.empty());
  simulation.finish(recorder);
  ASSERT_EQ(recorder.impacts.size(), 1u);
  const Impact& whole_time = recorder.impacts[0];
  EXPECT_TRUE(whole_time.cut_short);
  EXPECT_NEAR(whole_time.impulse, expected * whole_time.duration, 1.0e-10 * whole_time.impulse);
  EXPECT_NEAR(whole_time.peak_force, expected, 1.0e-10 * expected);
}

TEST_P(InterferenceFit, GapResponseIsThatOfTheReceptances)
{
  // Undamped: g (1 + k (alpha_1 + alpha_2)) = clearance + (beta_1 - beta_2) a, with the beams' own closed forms.
  double receptance = 0.0;
  for (const BeamParameters& beam : beams(parameters_))
  {
    receptance += Beam(beam).receptance(omega_);
  }
  double base_response = baseResponse(beamOf(parameters_.beam1), omega_);
  if (const auto* beam2 = std::get_if<BeamParameters>(&parameters_.beam2))
  {
    base_response -= baseResponse(*beam2, omega_);
  }
  const double expected = base_response / (1.0 + parameters_.contact.stiffness * receptance);
  EXPECT_NEAR(gapResponse(*model_, 0.0, omega_).real() / expected, 1.0, 1.0e-5);
}

TEST_P(InterferenceFit, ForceIsPreloadAndLinearResponseWhereTheDriveIsTooWeak)
{
  constexpr int samples_per_cycle = 1000;
  constexpr int cycles = 60;
  const double damping = parameters_.damping.contact;
  const std::complex<double> response = -model_->stiffness() * gapResponse(*model_, damping, omega_);
  const double rest = preload(parameters_);
  const double amplitude = 0.5 * rest / std::abs(response);
  // Samples joined by straight lines: the fundamental of what is played is lower by (sin x/x)^2.
  const double x = 0.5 * two_pi / samples_per_cycle;
  const double played = amplitude * std::pow(std::sin(x) / x, 2.0);

  SampledSimulation simulation(model_, two_pi / omega_ / samples_per_cycle);
  Recorder recorder;
  double worst = 0.0;
  for (int i = 0; i < cycles * samples_per_cycle; ++i)
  {
    const double phase = two_pi * i / samples_per_cycle;
    // Rising smoothly, so that the transient stays below the steady response.
    const double ramp = 0.5 - 0.5 * std::cos(std::min(1.0, phase / (20.0 * two_pi)) * 0.5 * two_pi);
    const double acceleration = amplitude * ramp * std::cos(phase);
    double gap = 0.0;
    double force = 0.0;
    simulation.advance(&acceleration, 1, &gap, &force, recorder);
    if (i >= (cycles - 3) * samples_per_cycle)
    {
      const double expected = rest + (response * std::polar(played, phase)).real();
      worst = std::max(worst, std::abs(force - expected));
    }
  }
  EXPECT_LT(worst, 1.0e-6 * rest);
  EXPECT_TRUE(recorder.impacts.empty());
}

TEST_P(InterferenceFit, SeparationBeginsWhereTheLinearForceReachesZero)
{
  // The drive level at which the amplitude of the linear contact force is the preload.
  const double limit = preload(parameters_) /
                       (model_->stiffness() * std::abs(gapResponse(*model_, parameters_.damping.contact, omega_)));
  const auto respond = [&](double acceleration)
  {
    HarmonicSimulation simulation(model_);
    struct Nobody : ImpactSink
    {
      void onImpact(const Impact& /*impact*/) override
      {
      }
    } nobody;
    // Up in ever smaller steps, each of which dies away: the transient takes nothing past the steady response.
    for (double missing = 1.0; missing > 1.0e-5; missing *= 0.7)
    {
      simulation.setDrive(omega_, (1.0 - missing) * acceleration);
      simulation.advance(5, nobody);
    }
    return harmonicResponse(simulation, omega_, acceleration, 200).row;
  };
  const ResponseRow below = respond(0.999 * limit);
  EXPECT_EQ(below.impacts, 0);
  EXPECT_EQ(below.contact_share, 1.0) << "always in contact";
  EXPECT_EQ(below.period, 1);
  EXPECT_EQ(below.impulse_mean, 0.0);
  EXPECT_EQ(below.clearance, -interference);
  const ResponseRow above = respond(1.001 * limit);
  EXPECT_EQ(above.impacts, 15);
  EXPECT_EQ(above.period, 1);
  EXPECT_LT(above.contact_share, 1.0);
  EXPECT_GT(above.contact_share, 0.5);
}

TEST_P(InterferenceFit, AgreesWithADirectIntegrationThroughSeparations)
{
  SystemParameters undamped = parameters_;
  undamped.damping = {0.0, 0.0};
  const auto model = std::make_shared<const SwitchedModel>(undamped);
  const double limit = preload(undamped) / (model->stiffness() * std::abs(gapResponse(*model, 0.0, omega_)));

  SwitchedMotion motion(model, true);
  Eigen::VectorXd displacement;
  Eigen::VectorXd velocity;
  motion.coordinates(displacement, velocity);
  DirectIntegrator integrator(model);
  integrator.setDisplacement(model->mapping() * displacement);
  ASSERT_NEAR(integrator.force(), preload(undamped), 1.0e-10 * preload(undamped));

  const double acceleration = 1.5 * limit;
  motion.setHarmonicDrive(omega_, acceleration);
  Recorder recorder;
  for (int cycle = 0; cycle < 6; ++cycle)
  {
    motion.advanceHarmonic(recorder);
    integrator.advance(two_pi / omega_, [&](double time) { return -acceleration * std::cos(omega_ * time); });
    EXPECT_NEAR(motion.gap(), integrator.gap(), 1.0e-5 * interference) << "cycle " << cycle;
  }
  ASSERT_GE(recorder.impacts.size(), 4u);
  motion.interrupt(recorder);
  double impulse = 0.0;
  for (const Impact& impact : recorder.impacts)
  {
    impulse += impact.impulse;
  }
  EXPECT_NEAR(impulse, integrator.impulse(), 1.0e-5 * impulse);
}

std::string caseName(const ::testing::TestParamInfo<Case>& tested)
{
  return tested.param.name;
}

INSTANTIATE_TEST_SUITE_P(Systems, InterferenceFit,
                         ::testing::Values(Case{"rigid_surface", pressed(rigidCase(1000.0, AttachmentBasis{5}))},
                                           Case{"limiting_case", pressed(limitingCase(1000.0, AttachmentBasis{5}))},
                                           Case{"soft_contact", pressed(limitingCase(10.0, AttachmentBasis{5}))},
                                           Case{"two_beams_off_centre", offCentre()}),
                         caseName);

TEST(OpenAtRest, NeverReachedGivesAnEmptyRow)
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{3});
  parameters.contact.clearance = 1.0e-3;
  HarmonicSimulation simulation(std::make_shared<const SwitchedModel>(parameters));
  const Response response = harmonicResponse(simulation, 1.6 * simulation.model().scales().frequency, 1.0, 50);
  EXPECT_TRUE(response.captured.empty());
  EXPECT_EQ(response.row.impacts, 0);
  EXPECT_EQ(response.row.contact_share, 0.0);
  EXPECT_EQ(response.row.impulse_mean, 0.0);
  EXPECT_EQ(response.row.peak_force, 0.0);
}

TEST(ConjoinedBasis, RestsInStaticEquilibriumHoweverFewItsModes)
{
  for (const SystemParameters& base : {limitingCase(1000.0, {}), rigidCase(1000.0, {}), limitingCase(10.0, {})})
  {
    for (const auto& [modes_free, modes_contact] : {std::pair{2, 2}, std::pair{1, 3}, std::pair{6, 4}})
    {
      SystemParameters parameters = pressed(base);
      parameters.basis = ConjoinedBasis{modes_free, modes_contact};
      const double expected = preload(parameters);
      const SwitchedMotion motion(std::make_shared<const SwitchedModel>(parameters), false);
      EXPECT_NEAR(motion.force(), expected, 1.0e-9 * expected) << modes_free << " and " << modes_contact;
    }
  }
}

}  // namespace
}  // namespace vibro_impact::core
