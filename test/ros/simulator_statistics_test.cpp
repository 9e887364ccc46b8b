#include <map>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "vibro_impact/ros/simulator_statistics.h"

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;
using vibro_impact::core::EnergyAccount;
using vibro_impact::graph::ComputingStatistics;
using vibro_impact::graph::DiagnosticThresholds;
using vibro_impact::graph::InputStatistics;
using vibro_impact::graph::ModelStatistics;
using vibro_impact::graph::StreamSimulation;
using vibro_impact::graph::Verdict;
using Action = Verdict::Action;

namespace
{
/// A status as a reader of /diagnostics finds it.
struct Report
{
  explicit Report(const DiagnosticStatusWrapper& status) : level(status.level), message(status.message)
  {
    for (const auto& entry : status.values)
    {
      value[entry.key] = entry.value;
    }
  }

  int level;
  std::string message;
  std::map<std::string, std::string> value;
};

testing::AssertionResult says(const Report& report, int level, const std::string& part)
{
  if (report.level == level && report.message.find(part) != std::string::npos)
  {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "level " << report.level << ": " << report.message;
}

class InputStatisticsTest : public testing::Test
{
protected:
  Report report(std::optional<double> age = 0.1, bool paused = false)
  {
    DiagnosticStatusWrapper status;
    statistics_.report(age, paused, status);
    return Report(status);
  }

  InputStatistics statistics_{"/base_excitation", DiagnosticThresholds()};
};

TEST_F(InputStatisticsTest, waitsForTheFirstBlock)
{
  Report now = report(std::nullopt);
  EXPECT_TRUE(says(now, DiagnosticStatus::STALE, "still waiting for data on topic /base_excitation"));
  EXPECT_EQ(now.value["Input age (s)"], "none");
  EXPECT_EQ(now.value["Blocks accepted"], "0");
}

TEST_F(InputStatisticsTest, allIsWell)
{
  statistics_.count({Action::Start, 0, {}}, 0, 100);
  statistics_.count({Action::Continue, 0, {}}, 100, 50);
  Report now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::OK, "receiving"));
  EXPECT_EQ(now.value["Blocks accepted"], "2");
  EXPECT_EQ(now.value["Samples accepted"], "150");
  EXPECT_EQ(now.value["Blocks refused"], "0");
  EXPECT_EQ(now.value["Input age (s)"], "0.100");
  EXPECT_EQ(now.value["Last refusal"], "none");
}

TEST_F(InputStatisticsTest, silenceIsStale)
{
  statistics_.count({Action::Start, 0, {}}, 0, 100);
  EXPECT_TRUE(
      says(report(3.25), DiagnosticStatus::STALE, "no data on topic /base_excitation for 3.2 s: time stands still"));
}

TEST_F(InputStatisticsTest, refusalIsAnErrorOnce)
{
  statistics_.count({Action::Refuse, 0, "the reason"}, 100, 100);
  Report now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::ERROR, "block refused: the reason"));
  EXPECT_EQ(now.value["Blocks refused"], "1");
  EXPECT_EQ(now.value["Samples refused"], "100");
  EXPECT_EQ(now.value["Blocks accepted"], "0");
  EXPECT_EQ(now.value["Last refusal"], "the reason");
  now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::OK, "receiving"));
  EXPECT_EQ(now.value["Blocks refused"], "1");
}

TEST_F(InputStatisticsTest, bridgeIsAWarningAndCounted)
{
  statistics_.count({Action::Start, 0, {}}, 0, 100);
  statistics_.count({Action::Bridge, 150, "the reason"}, 250, 100);
  Report now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::WARN, "150 missing samples bridged"));
  EXPECT_EQ(now.value["Gaps bridged"], "1");
  EXPECT_EQ(now.value["Samples bridged"], "150");
  EXPECT_EQ(now.value["Samples lost"], "150");
  EXPECT_EQ(now.value["Blocks lost"], "2");
  EXPECT_EQ(now.value["Restarts"], "0");
}

TEST_F(InputStatisticsTest, whatWasRefusedIsNotLostAsWell)
{
  statistics_.count({Action::Start, 0, {}}, 0, 100);
  statistics_.count({Action::Refuse, 0, "a repetition"}, 0, 100);
  statistics_.count({Action::Refuse, 0, "not a number"}, 100, 100);
  statistics_.count({Action::Refuse, 0, "not a number"}, 200, 100);
  statistics_.count({Action::Refuse, 0, "the same again"}, 200, 100);
  statistics_.count({Action::Bridge, 250, "the reason"}, 350, 50);  // 300 to 350 never came
  Report now = report();
  EXPECT_EQ(now.value["Samples accepted"], "150");
  EXPECT_EQ(now.value["Samples refused"], "400");
  EXPECT_EQ(now.value["Samples lost"], "50");
  EXPECT_EQ(now.value["Samples bridged"], "250");
  EXPECT_EQ(now.value["Blocks lost"], "1");
  statistics_.count({Action::Bridge, 100, "the reason"}, 500, 100);
  EXPECT_EQ(report().value["Samples lost"], "150");
}

TEST_F(InputStatisticsTest, lossesBelowTheThresholdAreCountedOnly)
{
  DiagnosticThresholds thresholds;
  thresholds.warn_lost_samples = 150.0;
  InputStatistics statistics("/base_excitation", thresholds);
  statistics.count({Action::Start, 0, {}}, 0, 100);
  statistics.count({Action::Bridge, 150, "the reason"}, 250, 100);
  DiagnosticStatusWrapper status;
  statistics.report(0.1, false, status);
  EXPECT_TRUE(says(Report(status), DiagnosticStatus::OK, "receiving"));
  EXPECT_EQ(Report(status).value["Samples lost"], "150");
}

TEST_F(InputStatisticsTest, restartIsAWarningAndCounted)
{
  statistics_.count({Action::Start, 0, {}}, 0, 100);
  statistics_.count({Action::Restart, 5000, "the reason"}, 5100, 100);
  Report now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::WARN, "restarted from rest"));
  EXPECT_EQ(now.value["Restarts"], "1");
  EXPECT_EQ(now.value["Samples bridged"], "0");
  EXPECT_EQ(now.value["Samples lost"], "5000");
  EXPECT_EQ(now.value["Blocks lost"], "50");
}

TEST_F(InputStatisticsTest, twoPublishersAreNamed)
{
  statistics_.count({Action::Start, 0, {}}, 0, 100);
  statistics_.countSecondPublisher("/shaker", "/play_1", 100);
  Report now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::ERROR, "two publishers on topic /base_excitation: /shaker and /play_1"));
  EXPECT_EQ(now.value["Blocks refused"], "1");
  EXPECT_EQ(now.value["Samples refused"], "100");
}

TEST_F(InputStatisticsTest, whatComesDuringAPauseIsCounted)
{
  statistics_.count({Action::Start, 0, {}}, 0, 100);
  statistics_.countDiscarded(100);
  Report now = report(0.1, true);
  EXPECT_TRUE(says(now, DiagnosticStatus::WARN, "paused"));
  EXPECT_EQ(now.value["Blocks discarded"], "1");
  EXPECT_EQ(now.value["Samples discarded"], "100");
  EXPECT_TRUE(says(report(), DiagnosticStatus::OK, "receiving"));
}

class ComputingStatisticsTest : public testing::Test
{
protected:
  Report report()
  {
    DiagnosticStatusWrapper status;
    statistics_.report(status);
    return Report(status);
  }

  ComputingStatistics statistics_{DiagnosticThresholds()};
};

TEST_F(ComputingStatisticsTest, tellsTheFactorAndTheWorstBlockSinceTheLastReport)
{
  statistics_.count(0.1, 0.0005);
  statistics_.count(0.1, 0.0015);
  Report now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::OK, "faster than real time"));
  EXPECT_EQ(now.value["Real-time factor"], "100");
  EXPECT_EQ(now.value["Worst block since last (s)"], "0.0015");
  EXPECT_EQ(now.value["Worst block since last, share of its duration"], "0.015");
  statistics_.count(0.1, 0.001);
  now = report();
  EXPECT_EQ(now.value["Worst block since last (s)"], "0.001");
  EXPECT_EQ(now.value["Worst block (s)"], "0.0015");
}

TEST_F(ComputingStatisticsTest, slownessWarnsAndThenIsAnError)
{
  statistics_.count(0.1, 0.08);
  EXPECT_TRUE(says(report(), DiagnosticStatus::WARN, "real-time factor 1.25, below 1.5"));
  statistics_.count(0.1, 0.2);
  EXPECT_TRUE(says(report(), DiagnosticStatus::ERROR, "real-time factor 0.5, below 1"));
  Report now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::OK, "nothing computed"));
  EXPECT_EQ(now.value["Real-time factor"], "0.5");
}

TEST_F(ComputingStatisticsTest, oneSlowBlockWarns)
{
  for (int i = 0; i < 100; ++i)
  {
    statistics_.count(0.005, 0.0001);
  }
  statistics_.count(0.005, 0.01);
  EXPECT_TRUE(says(report(), DiagnosticStatus::WARN, "a block took 2 times the time it lasts"));
}

class ModelStatisticsTest : public testing::Test
{
protected:
  Report report(const EnergyAccount& account = {})
  {
    DiagnosticStatusWrapper status;
    statistics_.report(account, status);
    return Report(status);
  }

  ModelStatistics statistics_{DiagnosticThresholds()};
};

TEST_F(ModelStatisticsTest, countsWhatTheModelDoes)
{
  StreamSimulation::Answer answer;
  answer.impacts.resize(3);
  answer.impacts.back().impact.cut_short = true;
  answer.contact_changes.resize(2);
  statistics_.count(answer);
  StreamSimulation::Answer reset;
  reset.impacts.resize(1);
  statistics_.countReset(reset);
  Report now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::OK, "simulating"));
  EXPECT_EQ(now.value["Impacts"], "4");
  EXPECT_EQ(now.value["Impacts cut short"], "1");
  EXPECT_EQ(now.value["Contact changes"], "2");
  EXPECT_EQ(now.value["Resets"], "1");
}

TEST_F(ModelStatisticsTest, switchLimitIsAnError)
{
  StreamSimulation::Answer answer;
  answer.switch_limits = 2;
  statistics_.count(answer);
  Report now = report();
  EXPECT_TRUE(says(now, DiagnosticStatus::ERROR, "bound on switches"));
  EXPECT_EQ(now.value["Switch limit reached"], "2");
}

TEST_F(ModelStatisticsTest, tellsTheEnergyAccountAndWarnsWhereItDoesNotClose)
{
  EnergyAccount account;
  account.structure1 = 0.25;
  account.work = 0.75;
  account.contact_work = 0.25;
  account.dissipated_free = 0.5;
  account.dissipated_contact = 0.125;
  account.turnover = 2.0;
  Report now = report(account);
  EXPECT_TRUE(says(now, DiagnosticStatus::WARN, "the energy account closes to 0.062 only"));
  EXPECT_EQ(now.value["Energy in structure 1 (J)"], "0.25");
  EXPECT_EQ(now.value["Energy in the spring (J)"], "0");
  EXPECT_EQ(now.value["Work of the base (J)"], "0.75");
  EXPECT_EQ(now.value["Work of changes of the contact (J)"], "0.25");
  EXPECT_EQ(now.value["Dissipated free (J)"], "0.5");
  EXPECT_EQ(now.value["Dissipated in contact (J)"], "0.125");
  EXPECT_EQ(now.value["Energy account closes to"], "0.0625");
}

}  // namespace
