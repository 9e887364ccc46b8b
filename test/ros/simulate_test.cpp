// Runs the program as a user does, on tables and bags written for it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "../config/tool_test.h"
#include "synthetic_run.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
namespace
{
using testing::HasSubstr;

constexpr double sample_period = 5.0e-5;
const std::string limiting_case = std::string(CONFIG_DIRECTORY) + "/limiting_case.yaml";

std::vector<double> excitation()
{
  std::vector<double> samples;
  for (int i = 0; i < 4000; ++i)
  {
    const double time = i * sample_period;
    samples.push_back(8.0 * std::sin(2700.0 * time) + 3.0 * std::sin(2.0 + 911.0 * time));
  }
  return samples;
}

std::vector<std::string> split(const std::string& text, char separator)
{
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);)
  {
    parts.push_back(part);
  }
  return parts;
}

class Simulate : public ToolTest
{
protected:
  Simulate() : ToolTest(SIMULATE, "simulate"), parameters_(config::loadFile(limiting_case))
  {
    parameters_.basis = core::AttachmentBasis{3};
    parameters_.contact.stiffness = 3.0e4;  // not that of any file
    configuration_ = directory_.file("configuration.yaml", config::toYaml(parameters_));
  }

  SyntheticRun recorded() const
  {
    return {parameters_, excitation(), sample_period};
  }

  std::string bag(const SyntheticRun& run) const
  {
    const std::string path = directory_.path() + "/run.bag";
    run.write(path);
    return path;
  }

  /// A bag with nothing but the excitation.
  std::string excitationBag() const
  {
    const std::string path = directory_.path() + "/excitation.bag";
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    for (const BaseExcitation& block : recorded().excitations)
    {
      bag.write("/shaker/measured", block.header.stamp, block);
    }
    return path;
  }

  std::string excitationTable() const
  {
    std::string text = "time,acceleration\n";
    const std::vector<double> samples = excitation();
    for (std::size_t i = 0; i < samples.size(); ++i)
    {
      text +=
          config::formatNumber(static_cast<double>(i) * sample_period) + "," + config::formatNumber(samples[i]) + "\n";
    }
    return directory_.file("excitation.csv", text);
  }

  std::map<std::string, std::vector<double>> table(const std::string& folder, const std::string& name) const
  {
    std::map<std::string, std::vector<double>> columns;
    const std::vector<std::string> lines = split(readText(folder + "/" + name), '\n');
    const std::vector<std::string> names = split(lines.at(0), ',');
    for (std::size_t line = 1; line < lines.size(); ++line)
    {
      const std::vector<std::string> cells = split(lines[line], ',');
      for (std::size_t i = 0; i < names.size(); ++i)
      {
        columns[names[i]].push_back(config::parseNumber(cells.at(i)).value());
      }
    }
    return columns;
  }

  /// What was written is what was recorded, bit for bit.
  void expectAnswersOf(const SyntheticRun& recording) const
  {
    const auto impacts = table(results(), "impacts.csv");
    ASSERT_EQ(impacts.at("number").size(), recording.impacts.size());
    for (std::size_t i = 0; i < recording.impacts.size(); ++i)
    {
      const Impact& expected = recording.impacts[i];
      EXPECT_EQ(impacts.at("number")[i], static_cast<double>(expected.number));
      EXPECT_EQ(impacts.at("onset_s")[i], static_cast<double>(expected.seq) * sample_period + expected.offset);
      EXPECT_EQ(impacts.at("duration_s")[i], expected.duration);
      EXPECT_EQ(impacts.at("impulse")[i], expected.impulse);
      EXPECT_EQ(impacts.at("peak_force")[i], expected.peak_force);
      EXPECT_EQ(impacts.at("approach_speed")[i], expected.approach_speed);
      EXPECT_EQ(impacts.at("separation_speed")[i], expected.separation_speed);
      EXPECT_EQ(impacts.at("energy_lost")[i], expected.energy_lost);
      EXPECT_EQ(impacts.at("cut_short")[i], expected.cut_short ? 1.0 : 0.0);
    }
    // And the answers to every sample.
    const auto history = table(results(), "history.csv");
    std::size_t row = 0;
    for (std::size_t block = 0; block < recording.gaps.size(); ++block)
    {
      for (std::size_t i = 0; i < recording.gaps[block].gap.size(); ++i, ++row)
      {
        EXPECT_EQ(history.at("gap").at(row), recording.gaps[block].gap[i]);
        EXPECT_EQ(history.at("force").at(row), recording.forces[block].force[i]);
      }
    }
    EXPECT_EQ(row, history.at("gap").size());
  }

  core::SystemParameters parameters_;
  std::string configuration_;
};

TEST_F(Simulate, WritesTheTablesOfAHarmonicRun)
{
  const Outcome outcome =
      run(configuration_ + " --omega-star 1.6 --acceleration 10 --cycles 150 --samples-per-cycle 64" + " --out " +
          results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("harmonic drive: omega* 1.6 (434."));
  EXPECT_THAT(outcome.out, HasSubstr("; period 1 cycles\n"));
  EXPECT_THAT(outcome.out, HasSubstr("history.csv (9601 rows), impacts.csv (15"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(results()), {}), 3);
  EXPECT_EQ(table(results(), "history.csv").at("gap").size(), 9601u);
  const auto impacts = table(results(), "impacts.csv");
  EXPECT_EQ(impacts.at("omega_star").front(), 1.6);

  // The same drive in Hz, which is read back with a rounding of omega*.
  const std::string frequency =
      config::formatNumber(1.6 * core::SwitchedModel(parameters_).scales().frequency / (2.0 * M_PI));
  ASSERT_EQ(
      run(configuration_ + " --frequency " + frequency + " --acceleration 10 --cycles 150 --out " + results("hertz"))
          .status,
      0);
  const auto other = table(results("hertz"), "impacts.csv");
  EXPECT_NEAR(other.at("impulse").back() / impacts.at("impulse").back(), 1.0, 1e-9);
}

TEST_F(Simulate, GivesTheImpactsOfTheBagBitForBit)
{
  const SyntheticRun recording = recorded();
  const std::string path = bag(recording);
  const Outcome outcome = run("--bag " + path + " --out " + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("4000 samples taken, 0 bridged, 0 restarts from rest, 0 blocks refused\n"));
  ASSERT_GT(recording.impacts.size(), 20u);
  expectAnswersOf(recording);
}

TEST_F(Simulate, FollowsTheChangesOfTheContactInTheBag)
{
  const core::ContactParameters first = parameters_.contact;
  const SyntheticRun recording(parameters_, excitation(), sample_period,
                               {{1200, {0.8 * first.stiffness, 1.0e-7}},
                                {1600, {0.8 * first.stiffness, -1.0e-7}},
                                {2800, {1.5 * first.stiffness, 5.0e-8}}});
  const SyntheticRun unchanged = recorded();
  ASSERT_GT(recording.impacts.size(), 20u);
  ASSERT_NE(recording.impacts.back().impulse, unchanged.impacts.back().impulse);
  const Outcome outcome = run("--bag " + bag(recording) + " --out " + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("4000 samples taken, 0 bridged, 0 restarts from rest, 0 blocks refused\n"));
  expectAnswersOf(recording);
}

TEST_F(Simulate, FollowsAnyNumberOfChanges)
{
  std::map<std::uint64_t, core::ContactParameters> changes;
  for (std::uint64_t i = 1; i <= StreamSimulation::max_waiting_changes + 10; ++i)
  {
    changes[2 * i] = {parameters_.contact.stiffness, 1.0e-10 * static_cast<double>(i)};
  }
  parameters_.basis = core::AttachmentBasis{1};
  const SyntheticRun recording(parameters_, excitation(), sample_period, changes, 2);
  const Outcome outcome = run("--bag " + bag(recording) + " --out " + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  expectAnswersOf(recording);
}

TEST_F(Simulate, RefusesABagThatHasLostAChangeOfTheContact)
{
  const core::ContactParameters first = parameters_.contact;
  SyntheticRun recording(parameters_, excitation(), sample_period,
                         {{1200, {first.stiffness, 1.0e-7}}, {1600, {first.stiffness, 2.0e-7}}});
  const std::vector<ModelInfo> infos = recording.infos;
  recording.infos.erase(recording.infos.begin() + 1);
  expectRefusal("--bag " + bag(recording) + " --out " + results(), 1,
                "topic /model_info: number 1 is missing: the recording has lost a change of the contact");
  recording.infos = {infos[1], infos[2]};
  expectRefusal("--bag " + bag(recording) + " --out " + results(), 1,
                "the recording begins with sample 0, and tells the contact only from sample 1200 on");
}

TEST_F(Simulate, GivesTheSameFromATableABagAndABareExcitation)
{
  ASSERT_EQ(run("--bag " + bag(recorded()) + " --out " + results("bag")).status, 0);
  ASSERT_EQ(run(configuration_ + " --bag " + excitationBag() + " --out " + results("bare")).status, 0);
  ASSERT_EQ(run(configuration_ + " --excitation " + excitationTable() + " --out " + results("table")).status, 0);
  for (const std::string name : {"/impacts.csv", "/history.csv", "/run.csv"})
  {
    const std::string expected = readText(results("bag") + name);
    EXPECT_GT(expected.size(), 100u);
    EXPECT_EQ(readText(results("bare") + name), expected) << name;
    EXPECT_EQ(readText(results("table") + name), expected) << name;
  }
}

TEST_F(Simulate, PlaysTheSignalOfAShaker)
{
  const std::string table = directory_.file("table.yaml", "signal: {type: table, file: " + excitationTable() + "}");
  const std::string from_bag =
      directory_.file("bag.yaml", "signal: {type: bag, files: [" + excitationBag() + "], topic: /shaker/measured}");
  ASSERT_EQ(run(configuration_ + " --excitation " + excitationTable() + " --out " + results("expected")).status, 0);
  ASSERT_EQ(run(configuration_ + " --signal " + table + " --out " + results("table")).status, 0);
  ASSERT_EQ(run(configuration_ + " --signal " + from_bag + " --out " + results("bag")).status, 0);
  const std::string expected = readText(results("expected") + "/impacts.csv");
  EXPECT_GT(expected.size(), 1000u);
  EXPECT_EQ(readText(results("table") + "/impacts.csv"), expected);
  EXPECT_EQ(readText(results("bag") + "/impacts.csv"), expected);

  const std::string sine = directory_.file(
      "sine.yaml", "{sample_rate: 20000, signal: {type: sine, acceleration: 10, frequency: 400, cycles: 200}}");
  const Outcome outcome = run(configuration_ + " --signal " + sine + " --every 10 --out " + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("history.csv (1000 rows)"));
  EXPECT_NEAR(this->table(results(), "history.csv").at("acceleration")[7],
              10.0 * std::sin(2.0 * M_PI * 400.0 * 70.0 / 20000.0), 1.0e-9);
}

TEST_F(Simulate, RefusesABadSignal)
{
  const std::string out = " --out " + results();
  expectRefusal(configuration_ + " --signal " + directory_.path() + "/absent.yaml" + out, 1,
                "/absent.yaml: No such file or directory");
  const std::string bad = directory_.file("bad.yaml", "{signal: {type: sine, acceleration: 2, frequency: 10}}");
  expectRefusal(configuration_ + " --signal " + bad + out, 1, "bad.yaml: signal.cycles is missing");
  const std::string endless = directory_.file(
      "endless.yaml", "{sample_rate: 1000, signal: {type: sine, acceleration: 2, frequency: 10, cycles: 1e7}}");
  expectRefusal(configuration_ + " --signal " + endless + out, 1,
                "the signal has 1000000000 samples: at most 200000000 can be held at once");
  expectRefusal(configuration_ + " --signal " + bad + " --cycles 4" + out, 2, "--cycles is for a harmonic drive");
}

TEST_F(Simulate, PrefersTheConfigurationThatIsGiven)
{
  ASSERT_EQ(run("--bag " + bag(recorded()) + " --out " + results("recorded")).status, 0);
  ASSERT_EQ(run(limiting_case + " --bag " + bag(recorded()) + " --out " + results("given")).status, 0);
  EXPECT_NE(readText(results("given") + "/impacts.csv"), readText(results("recorded") + "/impacts.csv"));
}

TEST_F(Simulate, TakesAStreamByTheRulesOfTheNode)
{
  SyntheticRun recording = recorded();
  recording.excitations[2].acceleration[7] = 1.0e6;  // refused, and bridged over
  recording.excitations[2].acceleration.resize(100);
  recording.excitations[3].seq -= 300;
  for (std::size_t i = 3; i < recording.excitations.size(); ++i)
  {
    recording.excitations[i].header.stamp -= ros::Duration(300 * sample_period);
    if (i > 3)
    {
      recording.excitations[i].seq -= 300;
    }
  }
  for (std::size_t i = 6; i < recording.excitations.size(); ++i)
  {
    recording.excitations[i].header.stamp += ros::Duration(50.0);  // a restart
  }
  const Outcome outcome = run("--bag " + bag(recording) + " --out " + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("3600 samples taken, 100 bridged, 1 restarts from rest, 1 blocks refused\n"));
  EXPECT_THAT(outcome.out, HasSubstr("first of these: acceleration[7] is 1000000 m/s^2"));
  const auto history = table(results(), "history.csv");
  ASSERT_EQ(history.at("time").size(), 3700u);
  EXPECT_NEAR(history.at("time")[1], sample_period, 1e-12);
  EXPECT_NEAR(history.at("time")[2100] - history.at("time")[2099], 50.0 + sample_period, 1e-6);
  EXPECT_EQ(history.at("gap")[2100], 0.0);  // at rest
}

TEST_F(Simulate, BeginsAnewWhereTheRecordingSaysSo)
{
  constexpr std::uint64_t anew = 2000;
  SyntheticRun recording = recorded();
  for (const std::uint64_t seq : {std::uint64_t{0}, anew})
  {
    StreamStart start;
    start.header.stamp = SyntheticRun::stampOf(seq, sample_period);
    start.seq = seq;
    start.sample_period = sample_period;
    start.number = recording.starts.size();
    start.cause = seq == 0 ? StreamStart::FIRST : StreamStart::RESET;
    start.reason = seq == 0 ? "first block" : "reset";
    recording.starts.push_back(start);
  }
  const Outcome outcome = run("--bag " + bag(recording) + " --out " + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("1 restarts from rest, 0 blocks refused\n"));
  EXPECT_THAT(outcome.out, HasSubstr("first of these: reset"));

  const std::vector<double> samples = excitation();
  const SyntheticRun rest(parameters_, {samples.begin() + anew, samples.end()}, sample_period);
  const auto history = table(results(), "history.csv");
  std::size_t row = anew;
  for (const Gap& block : rest.gaps)
  {
    for (const double gap : block.gap)
    {
      ASSERT_EQ(history.at("gap").at(row++), gap);
    }
  }
  EXPECT_EQ(row, history.at("gap").size());
}

TEST_F(Simulate, BeginsInTheGivenMotion)
{
  parameters_.contact.clearance = 1.0;
  const std::string open = directory_.file("open.yaml", config::toYaml(parameters_));
  ASSERT_EQ(
      run(open + " --omega-star 0.5 --acceleration 0 --cycles 1 --velocity1 -0.5,0,1e-3 --displacement2 1e-6 --out " +
          results())
          .status,
      0);
  const auto history = table(results(), "history.csv");
  const double mass = 954.0 * 0.0529 * 0.00127 * 0.0127;  // rho L h b
  const double shape = std::sqrt(2.0 / mass);             // of every odd mode at midspan, with the sign of sin(m pi/2)
  EXPECT_NEAR(history.at("gap_velocity")[0], shape * (-0.5 - 1.0e-3), 1e-12 * shape);
  EXPECT_NEAR(history.at("gap")[0] - 1.0, -shape * 1.0e-6, 1e-12);
}

TEST_F(Simulate, ChoosesTheRowsOfTheHistory)
{
  ASSERT_EQ(
      run(configuration_ + " --excitation " + excitationTable() + " --history-from 0.1 --every 20 --out " + results())
          .status,
      0);
  const auto history = table(results(), "history.csv");
  ASSERT_EQ(history.at("time").size(), 100u);
  EXPECT_NEAR(history.at("time").front(), 0.1, 1e-12);
}

TEST_F(Simulate, DrawsThePicture)
{
  const Outcome outcome = run(configuration_ + " --omega-star 1.6 --cycles 20 --plot --out " + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_EQ(readText(results() + "/simulation.png").substr(1, 3), "PNG");
  EXPECT_THAT(readText(results() + "/simulation.svg"), HasSubstr("<svg"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(results()), {}), 5);
}

TEST_F(Simulate, RefusesABadCommandLine)
{
  const std::string out = " --out " + results();
  const std::string harmonic = configuration_ + " --omega-star 1.6";
  const std::string table = configuration_ + " --excitation " + excitationTable();
  expectRefusal(configuration_ + out, 2,
                "0 drives are given: must be one of --omega-star, --frequency, --excitation, --signal, --bag");
  expectRefusal(harmonic + " --frequency 400" + out, 2, "2 drives are given");
  expectRefusal("--omega-star 1.6" + out, 2, "0 configuration files are given: must be one");
  expectRefusal(harmonic + " " + limiting_case + out, 2, "2 configuration files are given: must be one");
  expectRefusal(harmonic, 2, "--out is missing");
  expectRefusal(harmonic + " --every 2" + out, 2, "--every is for a drive by samples");
  expectRefusal(harmonic + " --namespace /rig" + out, 2, "--namespace is for a bag");
  expectRefusal(table + " --cycles 5" + out, 2, "--cycles is for a harmonic drive");
  expectRefusal("--bag x.bag --velocity1 1" + out, 2, "--velocity1 is for a harmonic drive, --excitation or --signal");
  expectRefusal(configuration_ + " --omega-star 0" + out, 2, "--omega-star = \"0\": must be a number from 0.001");
  expectRefusal(configuration_ + " --frequency nan" + out, 2, "--frequency = \"nan\": must be a number");
  expectRefusal(harmonic + " --acceleration -1" + out, 2, "--acceleration = \"-1\": must be a number from 0 to");
  expectRefusal(harmonic + " --cycles 0" + out, 2, "--cycles = \"0\": must be a whole number from 1");
  expectRefusal(harmonic + " --samples-per-cycle 0" + out, 2, "--samples-per-cycle = \"0\": must be a whole number");
  expectRefusal(harmonic + " --velocity1 1,,2" + out, 2, "--velocity1 = \"\": must be a number");
  expectRefusal(harmonic + " --velocity1 1,x" + out, 2, "--velocity1 = \"x\": must be a number");
  expectRefusal(table + " --every 0" + out, 2, "--every = \"0\": must be a whole number");
  expectRefusal(harmonic + " --plto" + out, 2, "--plto");
}

TEST_F(Simulate, RefusesBadFiles)
{
  const std::string out = " --out " + results();
  expectRefusal(directory_.path() + "/absent.yaml --omega-star 1" + out, 1,
                "/absent.yaml: cannot be read: No such file");
  expectRefusal(configuration_ + " --excitation " + directory_.path() + "/absent.csv" + out, 1,
                "/absent.csv: cannot be read: No such file");
  const std::string uneven = directory_.file("uneven.csv", "time,acceleration\n0,0\n1,0\n2,0\n4,0\n");
  expectRefusal(configuration_ + " --excitation " + uneven + out, 1, uneven + ": line 5: column time = 4: ");
  const std::string nothing = directory_.file("nothing.csv", "time\n0\n1\n");
  expectRefusal(configuration_ + " --excitation " + nothing + out, 1, "columns are missing: acceleration");
  expectRefusal("--bag " + nothing + out, 1, nothing + ": is not a bag");
  expectRefusal("--bag " + excitationBag() + out, 1,
                "the recording holds no model_info: give a configuration as CONFIG");
  const std::string file = directory_.file("file", "precious");
  expectRefusal(configuration_ + " --omega-star 1.6 --cycles 1000000000 --out " + file + "/below", 1,
                file + "/below: cannot be created: ");
}

TEST_F(Simulate, RefusesARecordingThatHoldsNothingToTake)
{
  SyntheticRun recording = recorded();
  for (BaseExcitation& block : recording.excitations)
  {
    block.acceleration.front() = NAN;
  }
  expectRefusal("--bag " + bag(recording) + " --out " + results(), 1,
                "no block can be taken, the first because acceleration[0]");
}

TEST_F(Simulate, RefusesAMotionThatTheStructureDoesNotHave)
{
  parameters_.beam2 = core::RigidSurface{};
  const std::string rigid = directory_.file("rigid.yaml", config::toYaml(parameters_));
  expectRefusal(rigid + " --omega-star 1.6 --velocity2 1 --out " + results(), 1, "structure 2");
  expectRefusal(rigid + " --omega-star 1.6 --velocity1 1,1,1,1 --out " + results(), 1, "structure 1");
}

TEST_F(Simulate, Helps)
{
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.error, "");
  for (const std::string option :
       {"CONFIG", "--omega-star", "--frequency", "--acceleration", "--cycles", "--samples-per-cycle", "--excitation",
        "--signal", "--bag", "--namespace", "--every", "--displacement1", "--velocity1", "--displacement2",
        "--velocity2", "--history-from", "--plot", "--out"})
  {
    EXPECT_THAT(outcome.out, HasSubstr(option));
  }
}

}  // namespace
}  // namespace vibro_impact::graph
