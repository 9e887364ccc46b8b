// Runs the program as a user does, on bags written for it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <std_msgs/Float64.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "../config/temporary_directory.h"
#include "../core/common.h"
#include "synthetic_run.h"
#include "vibro_impact/config/response_table.h"
#include "vibro_impact/core/drive_signal.h"
#include "vibro_impact/core/response.h"

namespace vibro_impact::graph
{
namespace
{
using core::two_pi;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double sample_rate = 20000.0;

core::SystemParameters limitingCase()
{
  return config::loadFile(std::string(CONFIG_DIRECTORY) + "/limiting_case.yaml");
}

/// Five steps of ninety cycles, and what is to be found in them.
struct Sweep
{
  explicit Sweep(double noise = 0.0) : signal(sample_rate)
  {
    for (int i = 0; i < 5; ++i)
    {
      const double first = signal.position();
      frequencies.push_back(380.0 + 7.0 * i);
      signal.step(frequencies.back(), 2.0, 90.0);
      steps.push_back({two_pi * frequencies.back(), 2.0, first / sample_rate, signal.position() / sample_rate});
    }
    signal.addNoise(noise, 1);
  }

  SyntheticRun run()
  {
    return {limitingCase(), signal.samples(), signal.samplePeriod()};
  }

  /// Rows of the response table by the steps as they were played.
  std::vector<core::ResponseRow> expected(const SyntheticRun& run) const
  {
    const core::ReferenceScales scales = core::referenceScales(limitingCase());
    std::vector<core::ResponseRow> rows;
    for (const core::DriveStep& step : steps)
    {
      std::vector<core::TimedImpact> impacts;
      for (const Impact& message : run.impacts)
      {
        core::TimedImpact timed;
        timed.onset = static_cast<double>(message.seq) / sample_rate + message.offset;
        timed.impact.impulse = message.impulse;
        timed.impact.duration = message.duration;
        timed.impact.cut_short = message.cut_short;
        if (timed.onset >= step.start && timed.onset < step.end)
        {
          impacts.push_back(timed);
        }
      }
      rows.push_back(core::evaluateResponse(step, impacts, scales).row);
    }
    return rows;
  }

  core::PlayedSignal signal;
  std::vector<double> frequencies;
  std::vector<core::DriveStep> steps;
};

struct Outcome
{
  int status = -1;
  std::string out;
  std::string error;
};

class ExtractFrf : public testing::Test
{
protected:
  Outcome run(const std::string& arguments) const
  {
    const std::string out = directory_.path() + "/stdout";
    const std::string error = directory_.path() + "/stderr";
    const std::string command = std::string(EXTRACT_FRF) + " " + arguments + " >" + out + " 2>" + error + " </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readText(out), readText(error)};
  }

  std::string path(const std::string& name) const
  {
    return directory_.path() + "/" + name;
  }

  /// Writes the run to a bag and extracts it.
  Outcome extract(const SyntheticRun& run_to_write, const std::string& options = "") const
  {
    run_to_write.write(path("run.bag"));
    return run(path("run.bag") + " --out " + path("results") + " " + options);
  }

  void expectRows(const std::vector<core::ResponseRow>& expected) const
  {
    const auto rows = config::readResponseTable(path("results/frf.csv"));
    ASSERT_EQ(rows.size(), expected.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
    {
      SCOPED_TRACE(expected[i].frequency_hz);
      EXPECT_NEAR(rows[i].omega_star, expected[i].omega_star, 1.0e-5 * expected[i].omega_star);
      EXPECT_NEAR(rows[i].acceleration, expected[i].acceleration, 1.0e-3 * expected[i].acceleration);
      EXPECT_EQ(rows[i].period, expected[i].period);
      EXPECT_EQ(rows[i].steady, expected[i].steady);
      EXPECT_EQ(rows[i].impacts, expected[i].impacts);
      EXPECT_NEAR(rows[i].impulse_mean, expected[i].impulse_mean, 1.0e-12);
      EXPECT_NEAR(rows[i].impulse_max, expected[i].impulse_max, 1.0e-12);
      EXPECT_NEAR(rows[i].impulse_per_cycle, expected[i].impulse_per_cycle, 1.0e-12);
      EXPECT_GT(rows[i].impulse_mean, 0.0);
    }
  }

  /// Expects a refusal with one line that holds `reason`, beside the progress, and no results.
  void expectRefusal(const Outcome& outcome, int status, const std::string& reason) const
  {
    EXPECT_EQ(outcome.status, status);
    EXPECT_EQ(outcome.out, "");
    std::vector<std::string> lines;
    std::istringstream text(outcome.error);
    for (std::string line; std::getline(text, line);)
    {
      if (line.rfind("reading ", 0) != 0)
      {
        lines.push_back(line);
      }
    }
    ASSERT_EQ(lines.size(), 1u) << outcome.error;
    EXPECT_THAT(lines[0], AllOf(StartsWith("extract_frf: "), HasSubstr(reason)));
    EXPECT_FALSE(std::filesystem::exists(path("results/frf.csv")));
    EXPECT_FALSE(std::filesystem::exists(path("results/impacts.csv")));
  }

  TemporaryDirectory directory_;
};

TEST_F(ExtractFrf, findsTheStepsAndEvaluatesTheirImpacts)
{
  Sweep sweep;
  const SyntheticRun run = sweep.run();
  const Outcome outcome = extract(run);
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  expectRows(sweep.expected(run));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr(std::to_string(run.excitations.size()) + " blocks, " +
                                           std::to_string(sweep.signal.samples().size()) + " samples, none lost"),
                                 Not(HasSubstr("warning")), HasSubstr("5 steps found, 0 left out"),
                                 HasSubstr("frf.csv (5 rows)"), HasSubstr("(75 rows)")));
  const auto impacts = config::readImpactTable(path("results/impacts.csv"));
  ASSERT_EQ(impacts.size(), 75u);
  for (const config::ImpactRow& row : impacts)
  {
    const Impact& message = run.impacts.at(row.number);
    EXPECT_NEAR(row.onset_s, static_cast<double>(message.seq) / sample_rate + message.offset, 1.0e-12);
    EXPECT_EQ(row.impulse, message.impulse);
    EXPECT_EQ(row.peak_force, message.peak_force);
    EXPECT_EQ(row.duration_s, message.duration);
    EXPECT_EQ(row.approach_speed, message.approach_speed);
    EXPECT_EQ(row.separation_speed, message.separation_speed);
  }
}

TEST_F(ExtractFrf, measuredExcitationIsNotClean)
{
  Sweep sweep(0.02);
  const SyntheticRun run = sweep.run();
  const Outcome outcome = extract(run);
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  const auto rows = config::readResponseTable(path("results/frf.csv"));
  ASSERT_EQ(rows.size(), 5u);
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    EXPECT_NEAR(rows[i].frequency_hz, sweep.frequencies[i], 1.0e-4 * sweep.frequencies[i]);
    EXPECT_EQ(rows[i].impacts, 15);
  }
}

TEST_F(ExtractFrf, splitBagIsOneRun)
{
  Sweep sweep;
  SyntheticRun run = sweep.run();
  ModelInfo repeated = run.infos.front();  // as --repeat-latched writes it to every part
  repeated.header.stamp = run.excitations[run.excitations.size() / 2].header.stamp;
  run.infos.push_back(repeated);
  run.write(path("run_0.bag"), 0.0, 0.35);
  run.write(path("run_1.bag"), 0.35, 0.6);
  run.write(path("run_2.bag"), 0.6, 1.0);
  // In any order.
  const Outcome outcome =
      this->run(path("run_2.bag") + " " + path("run_0.bag") + " " + path("run_1.bag") + " --out " + path("results"));
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  expectRows(sweep.expected(run));
}

TEST_F(ExtractFrf, partOfASplitBagIsIncomplete)
{
  Sweep sweep;
  const SyntheticRun run = sweep.run();
  run.write(path("run_0.bag"), 0.0, 0.3);
  run.write(path("run_2.bag"), 0.35, 1.0);
  expectRefusal(this->run(path("run_0.bag") + " " + path("run_2.bag") + " --out " + path("results")), 1,
                "topic /base_excitation: seq ");
}

TEST_F(ExtractFrf, sameBagTwiceIsReadOnce)
{
  Sweep sweep;
  const SyntheticRun run = sweep.run();
  run.write(path("run.bag"));
  std::filesystem::copy_file(path("run.bag"), path("copy.bag"));
  const Outcome outcome = this->run(path("run.bag") + " " + path("copy.bag") + " --out " + path("results"));
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  expectRows(sweep.expected(run));
  EXPECT_THAT(outcome.out, HasSubstr("repeated blocks ignored"));
}

/// Removes a block in the middle of the third step from one of the topics.
class ExtractFrfWithLoss : public ExtractFrf, public testing::WithParamInterface<const char*>
{
protected:
  static void spoil(SyntheticRun& run, const std::string& topic)
  {
    const std::size_t middle = run.excitations.size() / 2;
    const auto at = [](auto& messages, std::size_t i) { return messages.begin() + static_cast<std::ptrdiff_t>(i); };
    if (topic == "base_excitation")
    {
      run.excitations.erase(at(run.excitations, middle));
    }
    else if (topic == "gap")
    {
      run.gaps.erase(at(run.gaps, middle));
    }
    else if (topic == "contact_force")
    {
      run.forces.erase(at(run.forces, middle));
    }
    else
    {
      run.impacts.erase(at(run.impacts, run.impacts.size() / 2));
    }
  }
};

TEST_P(ExtractFrfWithLoss, isRefused)
{
  SyntheticRun run = Sweep().run();
  spoil(run, GetParam());
  expectRefusal(extract(run), 1, "the recording is not complete: topic /" + std::string(GetParam()) + ": ");
}

TEST_P(ExtractFrfWithLoss, leavesTheStepOutIfAllowed)
{
  Sweep sweep;
  SyntheticRun run = sweep.run();
  auto expected = sweep.expected(run);
  expected.erase(expected.begin() + 2);
  spoil(run, GetParam());
  const Outcome outcome = extract(run, "--allow-gaps");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  expectRows(expected);
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("samples, not complete"), HasSubstr("lost: topic /" + std::string(GetParam())),
                    HasSubstr("left out: omega* 1.4")));
}

INSTANTIATE_TEST_SUITE_P(OneBlock, ExtractFrfWithLoss,
                         testing::Values("base_excitation", "gap", "contact_force", "impact"));

TEST_F(ExtractFrf, lossesAtTheEndsAreSeen)
{
  const SyntheticRun whole = Sweep().run();
  SyntheticRun run = whole;
  run.excitations.erase(run.excitations.begin());
  expectRefusal(extract(run), 1, "topic /base_excitation: seq 0 to 399 (1 block, answered) is missing");
  run = whole;
  run.excitations.pop_back();
  expectRefusal(extract(run), 1, "(1 block, answered) is missing");
  run = whole;
  run.impacts.resize(run.impacts.size() - 3);
  expectRefusal(extract(run), 1, "topic /impact: what follows number ");
}

TEST_F(ExtractFrf, aRecordingFromTheMiddleOfTheStreamSaysSo)
{
  Sweep sweep;
  SyntheticRun run = sweep.run();
  run.infos.front().header.stamp = run.excitations.back().header.stamp;
  run.write(path("run.bag"), 0.25, 1.0);
  const Outcome outcome = this->run(path("run.bag") + " --out " + path("results"));
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("the recording begins in the middle of the stream, at seq "));
}

TEST_F(ExtractFrf, losesEverything)
{
  SyntheticRun run = Sweep().run();
  std::vector<Gap> few(run.gaps.begin(), run.gaps.begin() + 1);
  run.gaps = few;
  expectRefusal(extract(run, "--allow-gaps"), 1, "no step is left: all 5 are left out, the first: topic /gap");
}

TEST_F(ExtractFrf, refusesARestartWithinTheBag)
{
  SyntheticRun run = Sweep().run();
  BaseExcitation restarted = run.excitations.front();
  restarted.header.stamp = run.excitations.back().header.stamp + ros::Duration(0.5);
  run.excitations.push_back(restarted);
  expectRefusal(extract(run), 1, "seq 0: the stream restarts");
  expectRefusal(extract(run, "--allow-gaps"), 1, "seq 0: the stream restarts");
}

TEST_F(ExtractFrf, refusesSeveralModels)
{
  SyntheticRun run = Sweep().run();
  core::SystemParameters other = limitingCase();
  other.contact.stiffness *= 2.0;
  ModelInfo info;
  info.configuration = config::toYaml(other);
  info.header.stamp = run.excitations[7].header.stamp;
  run.infos.push_back(info);
  expectRefusal(extract(run), 1, "topic /model_info: the configuration changes within the recording");
}

TEST_F(ExtractFrf, saysWhichRowsBelongToWhichContact)
{
  // Steps of 4737, 4651, 4569, 4489 and 4412 samples: a change on the border of the second, and one within the third.
  Sweep sweep;
  core::SystemParameters parameters = limitingCase();
  const core::ContactParameters first = parameters.contact;
  const core::ContactParameters second{1.5 * first.stiffness, -1.0e-7};
  const core::ContactParameters third{1.5 * first.stiffness, 2.0e-7};
  const SyntheticRun run(parameters, sweep.signal.samples(), sweep.signal.samplePeriod(),
                         {{4800, second}, {12000, third}});
  const Outcome outcome = extract(run);
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("the contact changed 2 times during the recording:\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  from seq 0: stiffness 24309.426302924 N/m, clearance 0 m: row 1 of frf.csv\n"));
  EXPECT_THAT(outcome.out, HasSubstr("clearance -1e-07 m: rows 2 to 3 of frf.csv\n"));
  EXPECT_THAT(outcome.out,
              HasSubstr("  from seq 12000: stiffness 36464.139454386 N/m, clearance 2e-07 m: rows 4 to 6 "));
  EXPECT_THAT(outcome.out, HasSubstr("changes of the contact leave 1.2")) << "cycles of the second step before 4800";
  const auto rows = config::readResponseTable(path("results/frf.csv"));
  ASSERT_EQ(rows.size(), 6u);
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    const core::ContactParameters& contact = i == 0 ? first : i < 3 ? second : third;
    EXPECT_EQ(rows[i].stiffness, contact.stiffness) << i;
    EXPECT_EQ(rows[i].clearance, contact.clearance) << i;
    EXPECT_GT(rows[i].impacts, 0) << i;
    EXPECT_GT(rows[i].contact_share, 0.05) << i;
    EXPECT_LT(rows[i].contact_share, 0.95) << i;
  }
  EXPECT_NEAR(rows[2].frequency_hz, rows[3].frequency_hz, 1.0e-3) << "both of the third step";
}

TEST_F(ExtractFrf, aChangeThatIsNotRecordedIsALoss)
{
  Sweep sweep;
  core::SystemParameters parameters = limitingCase();
  const double stiffness = parameters.contact.stiffness;
  SyntheticRun run(parameters, sweep.signal.samples(), sweep.signal.samplePeriod(),
                   {{10000, {2.0 * stiffness, 0.0}}, {16000, {3.0 * stiffness, 0.0}}});
  run.infos.erase(run.infos.begin() + 1);
  expectRefusal(extract(run), 1, "number 1 to 1 (1 change of the contact before seq 16000) is missing");
  run.infos.erase(run.infos.begin());
  expectRefusal(extract(run), 1, "what holds before seq 16000 (number 1) is missing");
}

TEST_F(ExtractFrf, interferenceFitThatNeverSeparatesHasRowsWithoutImpacts)
{
  core::SystemParameters pressed = limitingCase();
  pressed.contact.clearance = -1.0e-3;
  Sweep sweep;
  SyntheticRun run(pressed, sweep.signal.samples(), sweep.signal.samplePeriod());
  ASSERT_EQ(run.impacts.size(), 1u) << "cut short by the end";
  run.impacts.clear();  // the recorder ended before the simulator: it knows no topic of impacts
  const Outcome outcome = extract(run);
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  const auto rows = config::readResponseTable(path("results/frf.csv"));
  ASSERT_EQ(rows.size(), 5u);
  for (const core::ResponseRow& row : rows)
  {
    EXPECT_EQ(row.impacts, 0);
    EXPECT_EQ(row.contact_share, 1.0);
    EXPECT_EQ(row.impulse_mean, 0.0);
  }
}

TEST_F(ExtractFrf, refusesASampleThatIsNotFinite)
{
  SyntheticRun run = Sweep().run();
  run.excitations[9].acceleration[3] = std::numeric_limits<double>::quiet_NaN();
  expectRefusal(extract(run), 1, "the block of seq 3600 holds a sample that is not finite");
}

TEST_F(ExtractFrf, answersThatAreNotFiniteAreLost)
{
  SyntheticRun run = Sweep().run();
  run.gaps[3].gap[7] = std::numeric_limits<double>::quiet_NaN();
  expectRefusal(extract(run), 1, "topic /gap: the block of seq 1200 holds a sample that is not finite");
  run.forces[30].force[0] = std::numeric_limits<double>::infinity();
  const Outcome outcome = extract(run, "--allow-gaps");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("5 steps found, 2 left out"));
  EXPECT_THAT(outcome.out, HasSubstr("topic /contact_force: the block of seq 12000 holds a sample that is not finite"));
}

TEST_F(ExtractFrf, refusesASweptSine)
{
  core::PlayedSignal signal(sample_rate);
  signal.sweep(300.0, 600.0, 2.0, 4.0, true);
  expectRefusal(extract(SyntheticRun(limitingCase(), signal.samples(), signal.samplePeriod())), 1,
                "no steps of constant frequency found");
}

TEST_F(ExtractFrf, warnsOfStepsThatCoverLittleAsThoseOfNoiseDo)
{
  core::RandomParameters noise;
  noise.spectrum = {{2.0, 0.02}, {5.0, 0.1}, {50.0, 0.1}, {100.0, 0.03}};
  noise.duration = 60.0;
  const auto signal = core::makeDriveSignal(noise, 5000.0);
  std::vector<double> samples(signal->samples());
  signal->generate(0, samples.size(), samples.data());
  const SyntheticRun run(config::loadFile(std::string(CONFIG_DIRECTORY) + "/ship_tube.yaml"), samples,
                         signal->samplePeriod());
  const Outcome outcome = extract(run);
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, ContainsRegex("\nwarning: the steps cover only [1-9][.0-9]* % of the samples: the drive may "
                                         "have no steps\n"));
  // No change of the contact cuts them.
  EXPECT_THAT(outcome.out, ContainsRegex(": has 3[.][0-9][0-9]? cycles, a step has at least 4\n"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("changes of the contact")));
}

TEST_F(ExtractFrf, runWithoutContactHasRowsWithoutImpacts)
{
  core::SystemParameters apart = limitingCase();
  apart.contact.clearance = 1.0;
  Sweep sweep;
  const SyntheticRun run(apart, sweep.signal.samples(), sweep.signal.samplePeriod());
  ASSERT_TRUE(run.impacts.empty());
  const Outcome outcome = extract(run);
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  const auto rows = config::readResponseTable(path("results/frf.csv"));
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0].impacts, 0);
  EXPECT_EQ(rows[0].contact_share, 0.0);
}

TEST_F(ExtractFrf, contactWithoutImpactsIsRefused)
{
  SyntheticRun run = Sweep().run();
  run.impacts.clear();
  expectRefusal(extract(run), 1, "holds no topic of type vibro_impact/Impact");
}

TEST_F(ExtractFrf, severalRunsInOneBagNeedANamespace)
{
  Sweep sweep;
  const SyntheticRun run = sweep.run();
  run.write(path("a.bag"), 0.0, 1.0, "/rig1");
  run.write(path("b.bag"), 0.0, 1.0, "/lab/rig2");
  const std::string bags = path("a.bag") + " " + path("b.bag") + " --out " + path("results");
  expectRefusal(this->run(bags), 1,
                "(/lab/rig2/base_excitation, /rig1/base_excitation); choose the run by --namespace");
  expectRefusal(this->run(bags + " --namespace /rig"), 1, "--namespace '/rig' must hold one, holds 0");
  for (const std::string name : {"/rig1", "lab/rig2", "/lab/"})
  {
    const Outcome outcome = this->run(bags + " --namespace " + name);
    ASSERT_EQ(outcome.status, 0) << outcome.error;
    expectRows(sweep.expected(run));
  }
}

TEST_F(ExtractFrf, aNamespaceThatTheRunIsNotInIsRefused)
{
  Sweep().run().write(path("run.bag"));
  expectRefusal(this->run(path("run.bag") + " --out " + path("results") + " --namespace /rig1"), 1,
                "holds 1 topic of type vibro_impact/BaseExcitation (/base_excitation); --namespace '/rig1' must hold "
                "one, holds 0");
}

TEST_F(ExtractFrf, refusesBagsWithoutATopic)
{
  const SyntheticRun run = Sweep().run();
  SyntheticRun without = run;
  without.infos.clear();
  expectRefusal(extract(without), 1, "run.bag: holds no topic of type vibro_impact/ModelInfo");
  without = run;
  without.gaps.clear();
  expectRefusal(extract(without), 1, "run.bag: holds no topic of type vibro_impact/Gap");
  without = run;
  without.forces.clear();
  expectRefusal(extract(without), 1, "run.bag: holds no topic of type vibro_impact/ContactForce");
  {
    rosbag::Bag bag(path("other.bag"), rosbag::bagmode::Write);
    bag.write("/gap_now", ros::Time(1.0), std_msgs::Float64());
  }
  expectRefusal(this->run(path("other.bag") + " --out " + path("results")), 1,
                "other.bag: holds no topic of type vibro_impact/BaseExcitation");
}

TEST_F(ExtractFrf, refusesAConfigurationThatIsNone)
{
  SyntheticRun run = Sweep().run();
  run.infos.front().configuration = "beam1: 3";
  const Outcome outcome = extract(run);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.error, AllOf(HasSubstr("model_info"), HasSubstr("beam1")));
  EXPECT_FALSE(std::filesystem::exists(path("results/frf.csv")));
}

TEST_F(ExtractFrf, refusesWhatIsNoBag)
{
  const std::string out = " --out " + path("results");
  expectRefusal(run(path("nothing.bag") + out), 1, "nothing.bag: no such file");
  expectRefusal(run(directory_.path() + out), 1, ": is not a file");
  expectRefusal(run(directory_.file("text.bag", "omega_star,frequency_hz\n1,2\n") + out), 1, "text.bag: is not a bag");
  expectRefusal(run(directory_.file("empty.bag", "") + out), 1, "empty.bag: is not a bag");
}

TEST_F(ExtractFrf, refusesATruncatedBagWhereverItIsCut)
{
  const SyntheticRun synthetic = Sweep().run();
  synthetic.write(path("run.bag"));
  const auto size = std::filesystem::file_size(path("run.bag"));
  for (const double share : {0.0001, 0.3, 0.9, 0.999, 0.99999})
  {
    SCOPED_TRACE(share);
    std::filesystem::copy_file(path("run.bag"), path("cut.bag"), std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(path("cut.bag"), static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    expectRefusal(run(path("cut.bag") + " --out " + path("results")), 1, "'rosbag reindex'");
  }
}

TEST_F(ExtractFrf, refusesADamagedBagWithOneLine)
{
  Sweep().run().write(path("run.bag"));
  std::fstream file(path("run.bag"), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path("run.bag")) / 2));
  file << std::string(20000, '\xff');
  file.close();
  expectRefusal(run(path("run.bag") + " --out " + path("results")), 1, "is cut off or damaged");
}

TEST_F(ExtractFrf, refusesABagThatIsStillBeingRecorded)
{
  const SyntheticRun synthetic = Sweep().run();
  rosbag::Bag bag(path("run.bag.active"), rosbag::bagmode::Write);
  bag.setChunkThreshold(1000);
  for (const BaseExcitation& message : synthetic.excitations)
  {
    bag.write("/base_excitation", message.header.stamp, message);
  }
  std::filesystem::copy_file(path("run.bag.active"), path("copy.active"));
  expectRefusal(run(path("copy.active") + " --out " + path("results")), 1, "'rosbag reindex'");
}

TEST_F(ExtractFrf, refusesADirectoryThatCannotBeWritten)
{
  Sweep().run().write(path("run.bag"));
  directory_.file("taken", "a file");
  expectRefusal(run(path("run.bag") + " --out " + path("taken")), 1, "taken");
  expectRefusal(run(path("run.bag") + " --out /proc/vibro_impact"), 1, "/proc/vibro_impact");
}

TEST_F(ExtractFrf, refusesWrongUsage)
{
  const std::string bag = path("run.bag");
  expectRefusal(run("--out " + path("results")), 2, "no bag is given");
  expectRefusal(run(bag), 2, "--out is missing");
  expectRefusal(run(bag + " --out " + path("results") + " --alow-gaps"), 2, "alow-gaps");
  expectRefusal(run(bag + " --out " + path("results") + " --acceleration-tolerance 1.5"), 2,
                "--acceleration-tolerance = \"1.5\": must be a number from 0.001 to 0.9");
  expectRefusal(run(bag + " --out " + path("results") + " --shortest-step 3"), 2, "--shortest-step = \"3\"");
  expectRefusal(run(bag + " --out " + path("results") + " --lowest-frequency fast"), 2,
                "--lowest-frequency = \"fast\"");
}

TEST_F(ExtractFrf, helps)
{
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("extract_frf BAG... --out DIR"), HasSubstr("--allow-gaps")));
}
}  // namespace
}  // namespace vibro_impact::graph
