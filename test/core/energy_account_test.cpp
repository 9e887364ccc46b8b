#include "vibro_impact/core/energy_account.h"

#include <cmath>
#include <complex>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "reference_system.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/simulation.h"

namespace vibro_impact::core
{
namespace
{
/// The sums over all episodes, cut short or not.
class Totals : public ImpactSink
{
public:
  void onImpact(const Impact& impact) override
  {
    ++impacts;
    work += impact.base_work;
    dissipated += impact.dissipated;
    mapping_loss += impact.mapping_loss;
    EXPECT_EQ(impact.energy_lost, impact.dissipated + impact.mapping_loss);
  }
  int impacts = 0;
  double work = 0.0;
  double dissipated = 0.0;
  double mapping_loss = 0.0;
};

struct Case
{
  std::string name;
  SystemParameters parameters;
  double omega_star = 0.0;
  int least_impacts = 1000;
};

// NOLINTNEXTLINE(readability-identifier-naming): Google Test looks for this name.
void PrintTo(const Case& c, std::ostream* stream)
{
  *stream << c.name;
}

class EnergyAccounts : public ::testing::TestWithParam<Case>
{
protected:
  void check(const EnergyAccount& account, const Totals& episodes)
  {
    EXPECT_LE(account.closure(), 1e-9);
    EXPECT_LE(std::abs(account.residual()), 1e-9 * std::max(std::abs(account.work), account.stored()));
    EXPECT_GE(account.structure1, 0.0);
    EXPECT_GE(account.structure2, 0.0);
    EXPECT_GE(account.spring, 0.0);
    const bool damped = GetParam().parameters.damping.contact > 0.0;
    EXPECT_NEAR(account.dissipated_contact, episodes.dissipated, 1e-12 * account.turnover);
    EXPECT_EQ(account.dissipated_contact > 0.0, damped);
    EXPECT_EQ(account.dissipated_free > 0.0, damped);
    EXPECT_NEAR(account.mapping_loss, episodes.mapping_loss, 1e-12 * account.turnover);
    if (std::holds_alternative<AttachmentBasis>(GetParam().parameters.basis))
    {
      EXPECT_EQ(account.mapping_loss, 0.0);
    }
    else
    {
      EXPECT_GT(account.mapping_loss, 1e-3 * account.work);
    }
    EXPECT_GE(episodes.impacts, GetParam().least_impacts);
  }
};

TEST_P(EnergyAccounts, closesUnderAHarmonicDrive)
{
  const auto model = std::make_shared<const SwitchedModel>(GetParam().parameters);
  const double frequency = GetParam().omega_star * model->scales().frequency;
  HarmonicSimulation simulation(model);
  Totals episodes;
  std::vector<HistorySample> history(static_cast<std::size_t>(20 * 50));
  for (const double change : {1.0, 1.01, 0.99})  // the account goes on through changes of the drive
  {
    simulation.setDrive(change * frequency, 10.0);
    simulation.advance(20, episodes, 50, history.data());
    for (std::size_t i = 2; i < history.size(); ++i)
    {
      ASSERT_LE(history[i].energy.closure(), 1e-9) << i;
    }
    simulation.advance(600, episodes);
    EXPECT_LE(simulation.energyAccount().closure(), 1e-9);
  }
  if (simulation.sample().in_contact)
  {
    // What the episode under way has dissipated so far is in the account, but in no impact yet.
    const double left = simulation.energyAccount().dissipated_contact - episodes.dissipated;
    EXPECT_GE(left, 0.0);
    episodes.dissipated += left;
    episodes.mapping_loss = simulation.energyAccount().mapping_loss;
  }
  check(simulation.energyAccount(), episodes);
}

TEST_P(EnergyAccounts, closesUnderASampledDrive)
{
  const auto model = std::make_shared<const SwitchedModel>(GetParam().parameters);
  const double frequency = GetParam().omega_star * model->scales().frequency;
  const double period = two_pi / frequency / 83.7;
  SampledSimulation simulation(model, period);
  std::vector<double> acceleration(1800 * 84);
  std::uint64_t state = 12345;
  for (std::size_t i = 0; i < acceleration.size(); ++i)
  {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const double noise = static_cast<double>(state >> 11) / 4503599627370496.0 - 1.0;
    acceleration[i] = 10.0 * std::sin(frequency * period * static_cast<double>(i)) + noise;
  }
  std::vector<double> gap(acceleration.size());
  std::vector<double> force(acceleration.size());
  Totals episodes;
  for (std::size_t i = 0; i < 1000; ++i)
  {
    simulation.advance(&acceleration[i], 1, &gap[i], &force[i], episodes);
    // Nearly nothing has happened after the first few samples from rest.
    ASSERT_LE(simulation.energyAccount().closure(), i < 10 ? 1e-7 : 1e-9) << i;
  }
  simulation.advance(&acceleration[1000], acceleration.size() - 1000, &gap[1000], &force[1000], episodes);
  const EnergyAccount account = simulation.energyAccount();
  EXPECT_EQ(account.spring, 0.5 * model->stiffness() * gap.back() * gap.back() * (simulation.inContact() ? 1.0 : 0.0));
  simulation.finish(episodes);
  EXPECT_NEAR(simulation.energyAccount().residual(), account.residual(), 1e-12 * account.turnover);
  check(simulation.energyAccount(), episodes);
}

TEST(EnergyAccount, ofAnOscillatorWithoutContactIsTheTextbooks)
{
  // Steady state of a damped mass: the base works 2 zeta omega Omega^2 |H A|^2/2 T a cycle, and damping takes it.
  const std::vector<Mode> modes = {Mode{10.0, 0.1, 10.0}};
  const auto model =
      std::make_shared<const SwitchedModel>(modes, ContactParameters{1e6, 10.0}, DampingParameters{0.05, 0.0});
  const double frequency = 8.0;
  const double amplitude = 2.0;
  HarmonicSimulation simulation(model);
  simulation.setDrive(frequency, amplitude);
  Totals episodes;
  simulation.advance(200, episodes);
  const EnergyAccount before = simulation.energyAccount();
  simulation.advance(10, episodes);
  const EnergyAccount after = simulation.energyAccount();
  const std::complex<double> stiffness(100.0 - 64.0, 2.0 * 0.05 * 10.0 * 8.0);
  const double velocity = frequency * 10.0 * amplitude / std::abs(stiffness);
  const double expected = 10.0 * (two_pi / frequency) * 0.05 * 10.0 * velocity * velocity;
  EXPECT_NEAR(after.work - before.work, expected, 1e-11 * expected);
  EXPECT_NEAR(after.dissipated_free - before.dissipated_free, expected, 1e-11 * expected);
  EXPECT_EQ(after.dissipated_contact, 0.0);
  EXPECT_EQ(after.structure2, 0.0);
}

TEST(EnergyAccount, ofADecayIsWhatDampingTook)
{
  const std::vector<Mode> modes = {Mode{10.0, 0.1, 10.0}};
  const auto model =
      std::make_shared<const SwitchedModel>(modes, ContactParameters{1e6, 10.0}, DampingParameters{0.05, 0.0});
  HarmonicSimulation simulation(model);
  InitialMotion motion;
  motion.structure1 = {{0.0}, {3.0}};
  simulation.start(motion);
  const double damped = 10.0 * std::sqrt(1.0 - 0.05 * 0.05);
  simulation.setDrive(damped, 0.0);
  Totals episodes;
  simulation.advance(3, episodes);  // three damped periods
  const EnergyAccount account = simulation.energyAccount();
  EXPECT_DOUBLE_EQ(account.initial, 4.5);
  EXPECT_EQ(account.work, 0.0);
  const double left = std::exp(-2.0 * 0.5 * 3.0 * two_pi / damped);
  EXPECT_NEAR(account.dissipated_free, 4.5 * (1.0 - left), 1e-13);
  EXPECT_NEAR(account.stored(), 4.5 * left, 1e-13);
}

TEST(EnergyAccount, closesWithABodyThatNothingHolds)
{
  const std::vector<Mode> modes = {Mode{0.0, 1.0, 1.0}, Mode{6.0, 0.7, 0.0}, Mode{2.5, -0.5, 0.8}, Mode{7.0, -0.4, 0.2},
                                   Mode{0.0, 0.0, 1.3}};
  const auto model =
      std::make_shared<const SwitchedModel>(modes, ContactParameters{300.0, 0.0}, DampingParameters{0.02, 0.05});
  const double period = 0.05;
  SampledSimulation simulation(model, period);
  std::vector<double> acceleration(200000);
  for (std::size_t i = 0; i < acceleration.size(); ++i)
  {
    const double time = period * static_cast<double>(i);
    acceleration[i] = 1.0 + 0.8 * std::sin(1.3 * time) + 0.3 * std::cos(4.1 * time);
  }
  std::vector<double> gap(acceleration.size());
  std::vector<double> force(acceleration.size());
  Totals episodes;
  simulation.advance(acceleration.data(), acceleration.size(), gap.data(), force.data(), episodes);
  EXPECT_GT(episodes.impacts, 1000);
  EXPECT_LE(simulation.energyAccount().closure(), 1e-9);

  HarmonicSimulation thrown(model);
  InitialMotion motion;
  motion.structure1 = {{1.0}, {-1.0, 0.3}};
  thrown.start(motion);
  thrown.setDrive(1.1, 1.5);
  Totals few;
  thrown.advance(20, few);
  EXPECT_GT(few.impacts, 0);
  EXPECT_LE(thrown.energyAccount().closure(), 1e-12);
}

std::string caseName(const ::testing::TestParamInfo<Case>& tested)
{
  return tested.param.name;
}

SystemParameters undamped(SystemParameters parameters)
{
  parameters.damping = {0.0, 0.0};
  return parameters;
}

SystemParameters withClearance(SystemParameters parameters, double clearance)
{
  parameters.contact.clearance = clearance;
  return parameters;
}

const BasisParameters two_and_two = ConjoinedBasis{2, 2};
const BasisParameters attachment = AttachmentBasis{5};

INSTANTIATE_TEST_SUITE_P(
    Cases, EnergyAccounts,
    ::testing::Values(Case{"periodic", limitingCase(1000.0, attachment), 1.6},
                      Case{"chaotic", limitingCase(1000.0, attachment), 2.2},
                      Case{"stiff", limitingCase(73223.0, AttachmentBasis{3}), 1.6},
                      Case{"rigid_surface", rigidCase(1000.0, attachment), 1.6},
                      Case{"clearance", withClearance(limitingCase(1000.0, attachment), 1e-7), 1.6},
                      Case{"interference", withClearance(limitingCase(1000.0, attachment), -1e-7), 1.6},
                      Case{"undamped", undamped(limitingCase(1000.0, attachment)), 1.6},
                      Case{"conjoined", limitingCase(1000.0, two_and_two), 1.6},
                      Case{"conjoined_chaotic", limitingCase(1000.0, two_and_two), 2.3, 500},
                      Case{"conjoined_interference", withClearance(limitingCase(1000.0, two_and_two), -1e-7), 1.6}),
    caseName);

}  // namespace
}  // namespace vibro_impact::core
