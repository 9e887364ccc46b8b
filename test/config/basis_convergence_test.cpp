#include "vibro_impact/config/convergence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "vibro_impact/config/configuration.h"

namespace vibro_impact::config
{
namespace
{
core::SystemParameters shipped(const std::string& name)
{
  return loadFile(std::string(CONFIG_DIRECTORY) + "/" + name);
}

core::SystemParameters shippedInAttachmentBasis(const std::string& name)
{
  core::SystemParameters parameters = shipped(name);
  parameters.basis = core::AttachmentBasis{5};
  return parameters;
}

Convergence convergeAt(const core::SystemParameters& parameters, double omega_star, ConvergenceOptions options = {})
{
  options.omega_stars = {omega_star};
  return converge(parameters, options, [](const ConvergenceProgress&) {}).front();
}

int settledModes(const Convergence& convergence)
{
  return convergence.settled ? convergence.runs[*convergence.settled].modes : 0;
}

const BasisRun& withModes(const Convergence& convergence, int modes)
{
  for (const BasisRun& run : convergence.runs)
  {
    if (run.modes == modes)
    {
      return run;
    }
  }
  throw std::out_of_range("no run with " + std::to_string(modes) + " modes");
}

TEST(CompareImpacts, TakesTheGreatestDifferenceOfPartners)
{
  const ImpactChange change = compareImpacts({{0.1, 2.0}, {0.6, 1.0}}, {{0.1, 2.0}, {0.65, 1.1}}, 1);
  EXPECT_NEAR(change.impulse, 0.1 / 2.0, 1e-15);
  EXPECT_NEAR(change.onset, 0.05, 1e-15);
}

TEST(CompareImpacts, KnowsThatTheCycleIsRound)
{
  const ImpactChange change = compareImpacts({{0.001, 2.0}, {0.6, 1.0}}, {{0.6, 1.0}, {0.999, 2.0}}, 1);
  EXPECT_EQ(change.impulse, 0.0);
  EXPECT_NEAR(change.onset, 0.002, 1e-15);
}

TEST(CompareImpacts, LetsAPeriodBeginAtAnyOfItsCycles)
{
  const std::vector<PhasedImpact> one = {{0.2, 1.0}, {1.3, 2.0}, {2.2, 3.0}};
  const std::vector<PhasedImpact> later = {{0.2, 3.0}, {1.2, 1.0}, {2.3, 2.0}};
  const ImpactChange change = compareImpacts(one, later, 3);
  EXPECT_EQ(change.impulse, 0.0);
  EXPECT_NEAR(change.onset, 0.0, 1e-15);
}

TEST(CompareImpacts, CountsAnImpactWithoutPartnerWhole)
{
  const std::vector<PhasedImpact> one = {{0.1, 4.0}, {0.6, 1.0}};
  const std::vector<PhasedImpact> more = {{0.1, 4.0}, {0.6, 1.0}, {0.62, 0.2}};
  EXPECT_NEAR(compareImpacts(one, more, 1).impulse, 0.05, 1e-15);
  EXPECT_NEAR(compareImpacts(more, one, 1).impulse, 0.05, 1e-15);
  EXPECT_EQ(compareImpacts(one, {}, 1).impulse, 1.0);
  EXPECT_EQ(compareImpacts({}, one, 1).impulse, 1.0);
  EXPECT_EQ(compareImpacts({}, {}, 1).impulse, 0.0);
}

TEST(ImpactStatistics, OfIndependentImpactsHaveTheTextbookErrors)
{
  // One impact in four of five cycles, impulses of mean 3 and standard deviation 0.5, no memory.
  std::mt19937 random(1);
  std::normal_distribution<double> impulse(3.0, 0.5);
  std::bernoulli_distribution there(0.8);
  constexpr std::uint64_t cycles = 100000;
  std::vector<CountedImpact> impacts;
  for (std::uint64_t cycle = 0; cycle < cycles; ++cycle)
  {
    if (there(random))
    {
      impacts.push_back({cycle, impulse(random)});
    }
  }
  const ImpactStatistics statistics = impactStatistics(impacts, cycles);
  const auto count = static_cast<double>(impacts.size());
  const auto expect = [](const Estimate& estimate, double value, double error)
  {
    EXPECT_NEAR(estimate.value, value, 4.0 * error);
    // A standard error from fifty batches is itself known to a tenth.
    EXPECT_NEAR(estimate.error, error, 0.35 * error);
  };
  expect(statistics.impulse_mean, 3.0, 0.5 / std::sqrt(count));
  expect(statistics.impulse_spread, 0.5, 0.5 / std::sqrt(2.0 * count));
  expect(statistics.impacts_per_cycle, 0.8, std::sqrt(0.8 * 0.2 / cycles));
  expect(statistics.impulse_per_cycle, 2.4, std::sqrt((0.8 * (9.0 + 0.25) - 2.4 * 2.4) / cycles));
}

TEST(ImpactStatistics, KnowThatImpactsDependOnThoseBefore)
{
  // Each impulse is held for ten cycles: a tenth of the independent values, so errors greater by the root of ten.
  std::mt19937 random(1);
  std::normal_distribution<double> impulse(3.0, 0.5);
  std::vector<CountedImpact> impacts;
  double held = 0.0;
  for (std::uint64_t cycle = 0; cycle < 100000; ++cycle)
  {
    held = cycle % 10 == 0 ? impulse(random) : held;
    impacts.push_back({cycle, held});
  }
  const double error = 0.5 / std::sqrt(10000.0);
  EXPECT_NEAR(impactStatistics(impacts, 100000).impulse_mean.error, error, 0.35 * error);
}

TEST(ImpactStatistics, OfFewCyclesAreRefused)
{
  EXPECT_THROW(impactStatistics({}, 99), std::invalid_argument);
  const ImpactStatistics none = impactStatistics({}, 100);
  EXPECT_EQ(none.impulse_mean.value, 0.0);
  EXPECT_EQ(standardErrorsApart(none, none), 0.0);
}

TEST(StandardErrorsApart, IsTheGreatestOfTheFour)
{
  ImpactStatistics one;
  one.impulse_mean = {1.0, 0.3};
  one.impacts_per_cycle = {2.0, 0.03};
  ImpactStatistics other = one;
  other.impulse_mean = {1.5, 0.4};
  other.impacts_per_cycle = {2.1, 0.04};
  EXPECT_NEAR(standardErrorsApart(one, other), 2.0, 1e-12);
}

TEST(Converge, ThreeModesPerBeamAreEnoughAtAThousand)
{
  for (const double omega_star : {1.2, 1.6, 2.0, 3.2})
  {
    const Convergence convergence = convergeAt(shippedInAttachmentBasis("limiting_case.yaml"), omega_star);
    EXPECT_EQ(settledModes(convergence), 3) << omega_star;
    // At midspan the even modes change nothing, and agreement of 1 and 2 proves nothing.
    EXPECT_NEAR(withModes(convergence, 1).impulse_mean / withModes(convergence, 2).impulse_mean, 1.0, 1e-9);
    EXPECT_FALSE(withModes(convergence, 2).agrees);
    for (const BasisRun& run : convergence.runs)
    {
      EXPECT_LT(run.mapping_loss, 1e-12);
      EXPECT_GT(run.cost, 0.0);
    }
  }
}

TEST(Converge, GivesMoreModesForMoreAccuracy)
{
  ConvergenceOptions options;
  options.accuracy = 1e-4;
  EXPECT_EQ(settledModes(convergeAt(shippedInAttachmentBasis("limiting_case.yaml"), 1.2, options)), 3);
  EXPECT_EQ(settledModes(convergeAt(shippedInAttachmentBasis("limiting_case.yaml"), 1.6, options)), 7);
  options.accuracy = 1e-6;
  EXPECT_EQ(settledModes(convergeAt(shippedInAttachmentBasis("limiting_case.yaml"), 1.2, options)), 7);
}

TEST(Converge, TwelveModesPerBeamDoNotDoForTheTable)
{
  ConvergenceOptions options;
  options.statistics_cycles = 500;
  const Convergence convergence = convergeAt(shipped("table1.yaml"), 1.2, options);
  // Twelve have an impact more in every cycle than sixteen.
  EXPECT_EQ(withModes(convergence, 12).impacts_per_cycle, 3.0);
  EXPECT_EQ(withModes(convergence, 16).impacts_per_cycle, 2.0);
  EXPECT_FALSE(withModes(convergence, 12).agrees);
  EXPECT_TRUE(withModes(convergence, 16).agrees);
  EXPECT_EQ(settledModes(convergence), 14);
}

TEST(Converge, ARigidSurfaceNeedsOneModeMoreAtItsResonance)
{
  const core::SystemParameters rigid = shippedInAttachmentBasis("rigid_surface.yaml");
  const Convergence convergence = convergeAt(rigid, 1.6);
  // At midspan 3 and 5 are neighbours: the even modes have a node there.
  EXPECT_EQ(settledModes(convergeAt(rigid, 1.2)), 3);
  EXPECT_EQ(settledModes(convergence), 5);
  EXPECT_EQ(convergence.runs.front().moving_coordinates, 2);  // a mode and an attachment shape of beam 1
  // The first frequency in contact with a rigid surface at k* = 1000 over the first free one.
  const BasisRun& last = convergence.runs.back();
  EXPECT_NEAR(*last.contact_frequency_hz / *last.free_frequency_hz, 4.0053, 5e-5);
}

TEST(Converge, TellsTheLossOfTheConjoinedBasis)
{
  const Convergence convergence = convergeAt(shipped("limiting_case.yaml"), 1.6);
  // T_11 of two and two modes is 0.974.
  EXPECT_NEAR(withModes(convergence, 2).mapping_loss, 1.0 - 0.974 * 0.974, 2e-3);
  EXPECT_FALSE(withModes(convergence, 2).agrees);
  // With enough modes it comes to what the attachment basis has with three.
  const Convergence attachment = convergeAt(shippedInAttachmentBasis("limiting_case.yaml"), 1.6);
  EXPECT_NEAR(convergence.runs.back().impulse_mean / attachment.runs.back().impulse_mean, 1.0, 1e-5);
}

TEST(Converge, ComparesStatisticsWhereTheResponseIsChaotic)
{
  const Convergence convergence = convergeAt(shippedInAttachmentBasis("limiting_case.yaml"), 2.4);
  EXPECT_EQ(settledModes(convergence), 3);
  for (const BasisRun& run : convergence.runs)
  {
    if (run.modes < 3)
    {
      EXPECT_GT(run.period, 0);
      EXPECT_FALSE(run.statistics);
      continue;
    }
    EXPECT_EQ(run.period, 0);
    ASSERT_TRUE(run.separation) << run.modes;
    EXPECT_GT(*run.separation, 1.1);
    EXPECT_LT(*run.separation, 2.0);
    ASSERT_TRUE(run.statistics);
    EXPECT_LT(run.statistics_apart.value_or(0.0), 4.0);
    EXPECT_FALSE(run.impulse_change);
    EXPECT_NEAR(run.statistics->impulse_mean.value, 1.9346e-7, 1e-9);
  }
}

TEST(Converge, DoesNotCallABeatChaotic)
{
  ConvergenceOptions options;
  options.most_modes = 5;
  const Convergence convergence = convergeAt(shippedInAttachmentBasis("limiting_case.yaml"), 2.2, options);
  EXPECT_EQ(withModes(convergence, 5).period, 0);
  EXPECT_TRUE(withModes(convergence, 5).statistics);
  EXPECT_FALSE(withModes(convergence, 5).separation);
}

TEST(Converge, SaysWhenTheLargestBasisIsNotEnough)
{
  ConvergenceOptions options;
  options.most_modes = 13;
  options.statistics_cycles = 500;
  options.omega_stars = {1.2};
  const core::SystemParameters table = shipped("table1.yaml");
  const auto results = converge(table, options, [](const ConvergenceProgress&) {});
  EXPECT_FALSE(results.front().settled);
  EXPECT_EQ(results.front().runs.back().modes, 13);
  const std::string report = convergenceReport(table, options, results);
  EXPECT_NE(report.find("Not settled up to modes_per_beam = 13"), std::string::npos) << report;
  EXPECT_NE(report.find("None was found for omega* 1.2"), std::string::npos) << report;
}

TEST(Converge, WithoutImpactsSettlesAtOnce)
{
  core::SystemParameters open = shippedInAttachmentBasis("limiting_case.yaml");
  open.contact.clearance = 1.0;
  const Convergence convergence = convergeAt(open, 1.2);
  EXPECT_EQ(settledModes(convergence), 1);
  EXPECT_EQ(convergence.runs.front().impacts_per_cycle, 0.0);
}

TEST(Converge, IsTheSameOnAnyNumberOfThreads)
{
  ConvergenceOptions options;
  options.omega_stars = {1.2, 1.3, 1.6};
  const core::SystemParameters parameters = shippedInAttachmentBasis("limiting_case.yaml");
  std::size_t done = 0;
  const auto one = converge(parameters, options, [&](const ConvergenceProgress& p) { done = p.frequencies; });
  EXPECT_EQ(done, 3u);
  options.threads = 3;
  const auto three = converge(parameters, options, [](const ConvergenceProgress&) {});
  for (std::size_t i = 0; i < 3; ++i)
  {
    EXPECT_EQ(one[i].omega_star, options.omega_stars[i]);
    ASSERT_EQ(one[i].runs.size(), three[i].runs.size());
    for (std::size_t j = 0; j < one[i].runs.size(); ++j)
    {
      EXPECT_EQ(one[i].runs[j].impulse_mean, three[i].runs[j].impulse_mean);
    }
  }
}

TEST(Converge, PassesOnWhatTheModelRefuses)
{
  core::SystemParameters undamped = shippedInAttachmentBasis("limiting_case.yaml");
  undamped.damping = {};
  EXPECT_THROW(convergeAt(undamped, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace vibro_impact::config
