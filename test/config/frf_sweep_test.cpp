// Runs the program as a user does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tool_test.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/config/response_table.h"

namespace vibro_impact::config
{
namespace
{
using testing::HasSubstr;

const std::string limiting_case = std::string(CONFIG_DIRECTORY) + "/limiting_case.yaml";

class FrfSweep : public ToolTest
{
protected:
  FrfSweep() : ToolTest(FRF_SWEEP, "frf_sweep")
  {
  }

  /// The value of a key of model.csv.
  static double modelValue(const std::string& folder, const std::string& key)
  {
    const std::string text = readText(folder + "/model.csv");
    const std::size_t at = text.find("\n" + key + ",");
    if (at == std::string::npos)
    {
      ADD_FAILURE() << key << " is not in " << text;
      return 0.0;
    }
    const std::size_t begin = at + key.size() + 2;
    return parseNumber(text.substr(begin, text.find('\n', begin) - begin)).value_or(0.0);
  }
};

TEST_F(FrfSweep, WritesTheTables)
{
  const Outcome outcome =
      run(limiting_case + " --from 1.2 --to 1.6 --points 3 --cycles 100 --threads 2 --out " + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("lowest frequency that moves the contact: free 271.4"));
  EXPECT_THAT(outcome.out, HasSubstr("mapping loss at a switch: "));
  EXPECT_THAT(outcome.out, HasSubstr("greatest mean impulse: "));
  EXPECT_THAT(outcome.out, HasSubstr("at omega* 1.6, period 1\n"));

  const std::vector<core::ResponseRow> rows = readResponseTable(results() + "/frf.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].omega_star, 1.2);
  EXPECT_EQ(rows[2].omega_star, 1.6);
  EXPECT_NEAR(rows[2].frequency_hz, 1.6 * 271.45, 0.1);
  EXPECT_GT(rows[2].impulse_mean, rows[0].impulse_mean);
  int impacts = 0;
  for (const core::ResponseRow& row : rows)
  {
    EXPECT_EQ(row.acceleration, 1.0);
    EXPECT_EQ(row.period, 1);
    EXPECT_TRUE(row.steady);
    EXPECT_GT(row.impulse_min, 0.0);
    impacts += row.impacts;
  }
  EXPECT_EQ(readImpactTable(results() + "/impacts.csv").size(), static_cast<std::size_t>(impacts));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(results()), {}), 3);
}

TEST_F(FrfSweep, SaysWhereThereAreNoImpactsAndWhy)
{
  const std::string pressed = std::string(CONFIG_DIRECTORY) + "/interference_fit.yaml";
  const std::string arguments = " --from 0.8 --to 1.6 --points 2 --cycles 200 --acceleration 0.2 --out ";
  Outcome outcome = run(pressed + arguments + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("no impacts: 1 of 2 frequencies (always in contact 1, never 0)\n"));
  std::vector<core::ResponseRow> rows = readResponseTable(results() + "/frf.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].impacts, 0);
  EXPECT_EQ(rows[0].contact_share, 1.0);
  EXPECT_EQ(rows[0].impulse_mean, 0.0);
  EXPECT_EQ(rows[1].impacts, 15);
  EXPECT_GT(rows[1].contact_share, 0.2);
  EXPECT_LT(rows[1].contact_share, 0.8);
  EXPECT_EQ(rows[1].clearance, -1.0e-7);
  EXPECT_EQ(readImpactTable(results() + "/impacts.csv").size(), 15u);

  core::SystemParameters parameters = loadFile(pressed);
  parameters.contact.clearance = 1.0e-3;
  const std::string open = directory_.file("open.yaml", toYaml(parameters));
  outcome = run(open + arguments + results("open"));
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("no impacts: 2 of 2 frequencies (always in contact 0, never 2)\n"));
  rows = readResponseTable(results("open") + "/frf.csv");
  ASSERT_EQ(rows.size(), 2u);
  for (const core::ResponseRow& row : rows)
  {
    EXPECT_EQ(row.impacts, 0);
    EXPECT_EQ(row.contact_share, 0.0);
    EXPECT_EQ(row.impulse_star_max, 0.0);
    EXPECT_EQ(row.peak_force, 0.0);
  }
  EXPECT_TRUE(readImpactTable(results("open") + "/impacts.csv").empty());
}

TEST_F(FrfSweep, WritesTheFrequencyRatioOfTheModel)
{
  core::SystemParameters parameters = loadFile(limiting_case);
  parameters.beam2 = core::RigidSurface{};
  const std::string rigid = directory_.file("rigid.yaml", toYaml(parameters));
  ASSERT_EQ(run(rigid + " --from 1 --to 1 --points 1 --cycles 20 --out " + results()).status, 0);
  EXPECT_NEAR(modelValue(results(), "frequency_ratio"), 4.0053, 5.0e-5);
  EXPECT_NEAR(modelValue(results(), "free_frequency_hz"), 271.45, 0.01);
  EXPECT_EQ(modelValue(results(), "free_1_hz"), modelValue(results(), "free_frequency_hz"));
  EXPECT_EQ(readResponseTable(results() + "/frf.csv").size(), 1u);

  // Of two identical beams the lowest mode in contact moves both alike; it is not the one asked for.
  parameters.beam2 = parameters.beam1;
  parameters.basis = core::AttachmentBasis{3};
  const std::string twins = directory_.file("twins.yaml", toYaml(parameters));
  ASSERT_EQ(run(twins + " --from 1 --to 1 --points 1 --cycles 20 --out " + results("twins")).status, 0);
  EXPECT_NEAR(modelValue(results("twins"), "frequency_ratio"), 4.8614, 5.0e-5);
  EXPECT_EQ(modelValue(results("twins"), "contact_1_hz"), modelValue(results("twins"), "free_1_hz"));

  // Two modes in contact leave it out.
  parameters.basis = core::ConjoinedBasis{2, 2};
  const std::string truncated = directory_.file("truncated.yaml", toYaml(parameters));
  const Outcome outcome = run(truncated + " --from 1 --to 1 --points 1 --cycles 20 --out " + results("truncated"));
  EXPECT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("in contact none\n"));
  EXPECT_EQ(readText(results("truncated") + "/model.csv").find("frequency_ratio"), std::string::npos);
}

TEST_F(FrfSweep, ShowsTheLandmarksOfTheFigure)
{
  const auto sweep = [this](const std::string& range)
  {
    EXPECT_EQ(run(limiting_case + range + " --out " + results()).status, 0);
    return readResponseTable(results() + "/frf.csv");
  };
  const auto peak = [](const std::vector<core::ResponseRow>& rows)
  {
    return *std::max_element(rows.begin(), rows.end(),
                             [](const core::ResponseRow& a, const core::ResponseRow& b)
                             { return a.impulse_mean < b.impulse_mean; });
  };
  const core::ResponseRow resonance = peak(sweep(" --from 1.5 --to 1.7 --points 41"));
  EXPECT_GE(resonance.omega_star, 1.59);
  EXPECT_LE(resonance.omega_star, 1.605);
  EXPECT_EQ(resonance.period, 1);

  const core::ResponseRow harmonic = peak(sweep(" --from 3.1 --to 3.3 --points 41"));
  EXPECT_GE(harmonic.omega_star, 3.185);
  EXPECT_LE(harmonic.omega_star, 3.205);
  EXPECT_EQ(harmonic.period, 2);
  EXPECT_GE(harmonic.impulse_mean / resonance.impulse_mean, 0.29);
  EXPECT_LE(harmonic.impulse_mean / resonance.impulse_mean, 0.33);

  for (const core::ResponseRow& row : sweep(" --from 2.36 --to 2.44 --points 9"))
  {
    if (row.omega_star < 2.395 || row.omega_star > 2.405)
    {
      EXPECT_EQ(row.period, row.omega_star < 2.4 ? 1 : 2) << row.omega_star;
    }
  }
}

TEST_F(FrfSweep, IsTheSameOnAnyNumberOfThreads)
{
  const std::string arguments = limiting_case + " --from 0.7 --to 3.1 --points 13 --cycles 60 --out ";
  ASSERT_EQ(run(arguments + results("one") + " --threads 1").status, 0);
  ASSERT_EQ(run(arguments + results("many") + " --threads 7").status, 0);
  for (const std::string name : {"/frf.csv", "/impacts.csv", "/model.csv"})
  {
    EXPECT_EQ(readText(results("one") + name), readText(results("many") + name)) << name;
  }
}

TEST_F(FrfSweep, FollowsUpAndDown)
{
  const std::string arguments = limiting_case + " --from 2.05 --to 2.5 --points 10 --cycles 150 --out ";
  ASSERT_EQ(run(arguments + results("rest")).status, 0);
  ASSERT_EQ(run(arguments + results("up") + " --follow up").status, 0);
  ASSERT_EQ(run(arguments + results("down") + " --follow down").status, 0);
  const auto rest = readResponseTable(results("rest") + "/frf.csv");
  const auto up = readResponseTable(results("up") + "/frf.csv");
  const auto down = readResponseTable(results("down") + "/frf.csv");
  ASSERT_EQ(up.size(), 10u);
  ASSERT_EQ(down.size(), 10u);
  // The first frequency of each way starts from rest; what follows does not, so impact numbers run on.
  EXPECT_EQ(up.front().impulse_mean, rest.front().impulse_mean);
  EXPECT_EQ(down.back().impulse_mean, rest.back().impulse_mean);
  EXPECT_EQ(down.front().omega_star, 2.05);
  EXPECT_NE(readText(results("up") + "/impacts.csv"), readText(results("down") + "/impacts.csv"));
}

TEST_F(FrfSweep, RefusesBadOptions)
{
  const std::string rest = " --out " + results();
  const std::string good = limiting_case + rest;
  expectRefusal("", 2, "--from is missing");
  expectRefusal(good + " --to 2 --points 3", 2, "--from is missing");
  expectRefusal(good + " --from 1 --points 3", 2, "--to is missing");
  expectRefusal(good + " --from 1 --to 2", 2, "--points is missing");
  expectRefusal(limiting_case + " --from 1 --to 2 --points 3", 2, "--out is missing");
  expectRefusal("--from 1 --to 2 --points 3" + rest, 2, "0 configuration files are given: must be one");
  expectRefusal("a b --from 1 --to 2 --points 3" + rest, 2, "2 configuration files are given: must be one");
  expectRefusal(good + " --from 2 --to 1 --points 3", 2, "--from = 2: must be less than --to = 1");
  expectRefusal(good + " --from 2 --to 2 --points 3", 2, "--from = 2: must be less than --to = 2");
  expectRefusal(good + " --from 1 --to 2 --points 1", 2, "--from = 1: must be equal to --to = 2 for one point");
  expectRefusal(good + " --from=-1 --to 2 --points 3", 2, "--from = \"-1\": must be a number from 0.001 to");
  expectRefusal(good + " --from -1 --to 2 --points 3", 2, "-1");
  expectRefusal(good + " --from 0 --to 2 --points 3", 2, "--from = \"0\": must be a number");
  expectRefusal(good + " --from 1 --to nan --points 3", 2, "--to = \"nan\": must be a number");
  expectRefusal(good + " --from 1 --to inf --points 3", 2, "--to = \"inf\": must be a number");
  for (const std::string points : {"0", "-3", "2.5", "many", "1e3", "99999999999999999999", "1000001"})
  {
    expectRefusal(good + " --from 1 --to 2 --points=" + points, 2,
                  "--points = \"" + points + "\": must be a whole number from 1 to 1000000");
  }
  expectRefusal(good + " --from 1 --to 2 --points 3 --cycles 0", 2, "--cycles = \"0\": must be a whole number");
  expectRefusal(good + " --from 1 --to 2 --points 3 --threads 0", 2, "--threads = \"0\": must be a whole number");
  expectRefusal(good + " --from 1 --to 2 --points 3 --acceleration 0", 2, "--acceleration = \"0\": must be a number");
  expectRefusal(good + " --from 1 --to 2 --points 3 --follow left", 2, "--follow = \"left\": must be up or down");
  expectRefusal(good + " --from 1 --to 2 --points 3 --cylces 5", 2, "--cylces");
  expectRefusal(good + " --from 1 --to 2 --points 3 --from 1", 2, "--from");
  expectRefusal(good + " --from 1 --to 2 --points", 2, "--points");
}

TEST_F(FrfSweep, RefusesABadConfiguration)
{
  const std::string rest = " --from 1 --to 2 --points 3 --out " + results();
  expectRefusal(directory_.path() + "/absent.yaml" + rest, 1, "/absent.yaml: cannot be read: No such file");
  const std::string bad = directory_.file("bad.yaml", "beam1: [");
  expectRefusal(bad + rest, 1, bad + ": line 1, column ");
  core::SystemParameters parameters = loadFile(limiting_case);
  parameters.damping.free = 1.5;
  const std::string overdamped = directory_.file("overdamped.yaml", toYaml(parameters));
  expectRefusal(overdamped + rest, 1, overdamped + ": damping.free = 1.5: must be a number >= 0 and < 1");
}

TEST_F(FrfSweep, RefusesAnUnwritableDirectoryBeforeItComputes)
{
  const std::string file = directory_.file("file", "precious");
  // Computing this many cycles would take hours.
  expectRefusal(limiting_case + " --from 1 --to 2 --points 1000 --cycles 1000000000 --out " + file + "/below", 1,
                file + "/below: cannot be created: ");
  EXPECT_EQ(readText(file), "precious");
}

TEST_F(FrfSweep, LeavesNothingBehindWhenInterrupted)
{
  const std::string out = results();
  int channel[2];
  ASSERT_EQ(pipe(channel), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0)
  {
    dup2(channel[1], STDERR_FILENO);
    close(channel[0]);
    close(channel[1]);
    execl(FRF_SWEEP, FRF_SWEEP, limiting_case.c_str(), "--from", "1", "--to", "2", "--points", "3", "--cycles",
          "1000000000", "--out", out.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  close(channel[1]);
  // Its first line of progress tells that it computes.
  char first = 0;
  EXPECT_EQ(read(channel[0], &first, 1), 1);
  EXPECT_EQ(first, '0');
  EXPECT_EQ(kill(child, SIGINT), 0);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  close(channel[0]);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(std::filesystem::is_empty(out));
}

TEST_F(FrfSweep, Helps)
{
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.error, "");
  for (const std::string option :
       {"CONFIG", "--from", "--to", "--points", "--cycles", "--acceleration", "--follow", "--threads", "--out"})
  {
    EXPECT_THAT(outcome.out, HasSubstr(option));
  }
}

}  // namespace
}  // namespace vibro_impact::config
