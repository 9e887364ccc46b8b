#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "vibro_impact/ros/simulator_statistics.h"

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;
using vibro_impact::graph::SimulatorStatistics;
using vibro_impact::graph::StreamSimulation;
using Action = vibro_impact::graph::Verdict::Action;

namespace
{
StreamSimulation::Answer answer(Action action, std::uint64_t missing = 0, std::size_t samples = 100)
{
  StreamSimulation::Answer result;
  result.verdict = {action, missing, "the reason"};
  if (action != Action::Refuse)
  {
    result.gap.sample_period = 1.0e-3;
    result.gap.values.resize(samples);
  }
  return result;
}

class SimulatorStatisticsTest : public testing::Test
{
protected:
  void report(std::optional<double> age = 0.1)
  {
    status_ = DiagnosticStatusWrapper();
    statistics_.report(age, status_);
  }

  std::string value(const std::string& key) const
  {
    for (const auto& entry : status_.values)
    {
      if (entry.key == key)
      {
        return entry.value;
      }
    }
    return "no " + key;
  }

  void expectStatus(int level, const std::string& part) const
  {
    EXPECT_EQ(status_.level, level) << status_.message;
    EXPECT_NE(status_.message.find(part), std::string::npos) << status_.message;
  }

  SimulatorStatistics statistics_{"/base_excitation", 1.0};
  DiagnosticStatusWrapper status_;
};

TEST_F(SimulatorStatisticsTest, waitsForTheFirstBlock)
{
  report(std::nullopt);
  expectStatus(DiagnosticStatus::STALE, "still waiting for data on topic /base_excitation");
  EXPECT_EQ(value("Input age (s)"), "none");
  EXPECT_EQ(value("Blocks accepted"), "0");
}

TEST_F(SimulatorStatisticsTest, allIsWell)
{
  StreamSimulation::Answer start = answer(Action::Start);
  start.impacts.resize(3);
  start.contact_changes.resize(2);
  statistics_.count(start, 0.0005);
  statistics_.count(answer(Action::Continue), 0.0005);
  report();
  expectStatus(DiagnosticStatus::OK, "simulating");
  EXPECT_EQ(value("Real-time factor"), "200");
  EXPECT_EQ(value("Blocks accepted"), "2");
  EXPECT_EQ(value("Blocks refused"), "0");
  EXPECT_EQ(value("Impacts"), "3");
  EXPECT_EQ(value("Contact changes"), "2");
  EXPECT_EQ(value("Input age (s)"), "0.100");
  EXPECT_EQ(value("Last refusal"), "none");
}

TEST_F(SimulatorStatisticsTest, realTimeFactorIsThatSinceTheLastReport)
{
  statistics_.count(answer(Action::Start), 0.001);
  report();
  statistics_.count(answer(Action::Continue), 0.2);
  report();
  EXPECT_EQ(value("Real-time factor"), "0.5");
  expectStatus(DiagnosticStatus::WARN, "slower than real time");
  report();
  EXPECT_EQ(value("Real-time factor"), "0.5");
  expectStatus(DiagnosticStatus::OK, "simulating");
}

TEST_F(SimulatorStatisticsTest, silenceIsStale)
{
  statistics_.count(answer(Action::Start), 0.001);
  report(3.25);
  expectStatus(DiagnosticStatus::STALE, "no data on topic /base_excitation for 3.2 s: time stands still");
}

TEST_F(SimulatorStatisticsTest, refusalIsAnErrorOnce)
{
  statistics_.count(answer(Action::Refuse), 0.001);
  report();
  expectStatus(DiagnosticStatus::ERROR, "block refused: the reason");
  EXPECT_EQ(value("Blocks refused"), "1");
  EXPECT_EQ(value("Blocks accepted"), "0");
  EXPECT_EQ(value("Last refusal"), "the reason");
  report();
  expectStatus(DiagnosticStatus::OK, "simulating");
  EXPECT_EQ(value("Blocks refused"), "1");
}

TEST_F(SimulatorStatisticsTest, bridgeIsAWarningAndCounted)
{
  statistics_.count(answer(Action::Start), 0.001);
  statistics_.count(answer(Action::Bridge, 150), 0.001);
  report();
  expectStatus(DiagnosticStatus::WARN, "missing samples bridged");
  EXPECT_EQ(value("Gaps bridged"), "1");
  EXPECT_EQ(value("Samples bridged"), "150");
  EXPECT_EQ(value("Samples lost"), "150");
  EXPECT_EQ(value("Blocks lost"), "2");
  EXPECT_EQ(value("Restarts"), "0");
}

TEST_F(SimulatorStatisticsTest, restartIsAWarningAndCounted)
{
  statistics_.count(answer(Action::Start), 0.001);
  statistics_.count(answer(Action::Restart, 5000), 0.001);
  report();
  expectStatus(DiagnosticStatus::WARN, "restarted from rest");
  EXPECT_EQ(value("Restarts"), "1");
  EXPECT_EQ(value("Samples bridged"), "0");
  EXPECT_EQ(value("Samples lost"), "5000");
  EXPECT_EQ(value("Blocks lost"), "50");
}

TEST_F(SimulatorStatisticsTest, twoPublishersAreNamed)
{
  statistics_.count(answer(Action::Start), 0.001);
  statistics_.countSecondPublisher("/shaker", "/play_1");
  report();
  expectStatus(DiagnosticStatus::ERROR, "two publishers on topic /base_excitation: /shaker and /play_1");
  EXPECT_EQ(value("Blocks refused"), "1");
}

TEST_F(SimulatorStatisticsTest, switchLimitIsAnError)
{
  StreamSimulation::Answer start = answer(Action::Start);
  start.switch_limits = 2;
  statistics_.count(start, 0.001);
  report();
  expectStatus(DiagnosticStatus::ERROR, "bound on switches");
  EXPECT_EQ(value("Switch limit reached"), "2");
}

TEST_F(SimulatorStatisticsTest, resetsAreCounted)
{
  StreamSimulation::Answer reset;
  reset.impacts.resize(1);
  statistics_.countReset(reset);
  report();
  expectStatus(DiagnosticStatus::OK, "simulating");
  EXPECT_EQ(value("Resets"), "1");
  EXPECT_EQ(value("Impacts"), "1");
}

TEST_F(SimulatorStatisticsTest, tellsTheEnergyAccount)
{
  vibro_impact::core::EnergyAccount account;
  account.structure1 = 0.25;
  account.work = 0.75;
  account.contact_work = 0.25;
  account.dissipated_free = 0.5;
  account.dissipated_contact = 0.125;
  account.turnover = 2.0;
  vibro_impact::graph::report(account, status_);
  EXPECT_EQ(value("Energy in structure 1 (J)"), "0.25");
  EXPECT_EQ(value("Energy in the spring (J)"), "0");
  EXPECT_EQ(value("Work of the base (J)"), "0.75");
  EXPECT_EQ(value("Work of changes of the contact (J)"), "0.25");
  EXPECT_EQ(value("Dissipated free (J)"), "0.5");
  EXPECT_EQ(value("Dissipated in contact (J)"), "0.125");
  EXPECT_EQ(value("Energy account closes to"), "0.0625");
}

}  // namespace
