// Runs the program as a user does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tool_test.h"
#include "vibro_impact/config/configuration.h"

namespace vibro_impact::config
{
namespace
{
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string limiting_case = std::string(CONFIG_DIRECTORY) + "/limiting_case.yaml";
const std::string rigid_surface = std::string(CONFIG_DIRECTORY) + "/rigid_surface.yaml";

class ConvergeTool : public ToolTest
{
protected:
  ConvergeTool() : ToolTest(CONVERGE, "converge")
  {
  }

  std::string attachment() const
  {
    core::SystemParameters parameters = loadFile(limiting_case);
    parameters.basis = core::AttachmentBasis{5};
    return directory_.file("attachment.yaml", toYaml(parameters));
  }
};

TEST_F(ConvergeTool, RecommendsTheSmallestBasis)
{
  const Outcome outcome = run(attachment() + " --at 1.6 3.2 --accuracy 1e-4 --out " + results());
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("omega* 1.6\n"));
  EXPECT_THAT(outcome.out, HasSubstr("Settled: impulses and onsets agree to 0.0001 from modes_per_beam = 7 on"));
  EXPECT_THAT(outcome.out, HasSubstr("Settled: impulses and onsets agree to 0.0001 from modes_per_beam = 5 on"));
  EXPECT_THAT(outcome.out,
              HasSubstr("Smallest basis for an accuracy of 0.0001: modes_per_beam = 7, which omega* 1.6 asks for.\n"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("mapping loss")));
  const std::string table = readText(results() + "/convergence.csv");
  EXPECT_THAT(table, StartsWith("omega_star,modes,free_frequency_hz,"));
  EXPECT_THAT(table, HasSubstr("\n1.6,1,271.4"));
  EXPECT_THAT(table, HasSubstr("\n3.2,5,271.4"));
}

TEST_F(ConvergeTool, WritesNothingWithoutADirectory)
{
  const Outcome outcome = run(rigid_surface + " --at 1.6");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("Smallest basis for an accuracy of 0.001: modes_free = modes_contact = 3.\n"));
  EXPECT_THAT(outcome.out, HasSubstr("The mapping of the conjoined basis loses energy at every switch"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("written to")));
}

TEST_F(ConvergeTool, SaysThatChaosDoesNotConverge)
{
  const Outcome outcome = run(attachment() + " --at 2.4");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out,
              HasSubstr("Chaotic: no period up to 16 cycles, and neighbouring motions part by a factor of 1."));
  EXPECT_THAT(outcome.out, HasSubstr("No number of modes makes single impacts converge"));
  EXPECT_THAT(outcome.out, HasSubstr("Statistics agree from modes_per_beam = 3 on"));
}

TEST_F(ConvergeTool, SaysThatAModalTableHasNoMoreModes)
{
  core::SystemParameters parameters = loadFile(rigid_surface);
  core::ModalTableParameters table;
  table.frequency_hz = {8.06743};
  table.contact_deflection = {1.39758};
  table.participation = {0.779067};
  parameters.beam1 = table;
  parameters.contact.stiffness = 1.0e4;
  for (const core::BasisParameters& basis :
       {core::BasisParameters(core::AttachmentBasis{5}), core::BasisParameters(core::ConjoinedBasis{2, 2})})
  {
    parameters.basis = basis;
    const Outcome outcome = run(directory_.file("one.yaml", toYaml(parameters)) + " --at 1.6");
    ASSERT_EQ(outcome.status, 0) << outcome.error;
    EXPECT_THAT(outcome.out, HasSubstr(" = 1 has all modes that the structures have: there is no larger basis, nor a "
                                       "smaller one, to compare it with. Whether a modal table lists modes enough, a "
                                       "longer one can tell.\n"));
    EXPECT_THAT(outcome.out, HasSubstr("Best basis there is: modes_"));
    EXPECT_THAT(outcome.out, Not(HasSubstr("Settled")));
    EXPECT_THAT(outcome.out, Not(HasSubstr("for an accuracy")));
  }

  table.frequency_hz.push_back(141.563);
  table.contact_deflection.push_back(-0.986064);
  table.participation.push_back(0.25315);
  parameters.beam1 = table;
  parameters.basis = core::ConjoinedBasis{2, 2};
  const Outcome outcome = run(directory_.file("two.yaml", toYaml(parameters)) + " --at 1.6 --accuracy 1e-4");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_THAT(outcome.out,
              HasSubstr("modes_free = modes_contact = 2 has all modes that the structures have: there is no "
                        "larger basis, and no smaller one agrees with it to 0.0001."));
}

TEST_F(ConvergeTool, RefusesABadCommandLine)
{
  const std::string out = " --out " + results();
  expectRefusal("--at 1.2" + out, 2, "0 configuration files are given: must be one");
  expectRefusal(limiting_case + out, 2, "--at is missing");
  expectRefusal(limiting_case + " --at" + out, 2, "--at");
  expectRefusal(limiting_case + " --at 1.2 0" + out, 2, "--at = \"0\": must be a number from 0.001 to 100000");
  expectRefusal(limiting_case + " --at 1.2 nan" + out, 2, "--at = \"nan\": must be a number");
  expectRefusal(limiting_case + " --at 1.2 --accuracy 2" + out, 2,
                "--accuracy = \"2\": must be a number from 1e-09 to 1");
  expectRefusal(limiting_case + " --at 1.2 --acceleration 0" + out, 2, "--acceleration = \"0\": must be a number");
  expectRefusal(limiting_case + " --at 1.2 --cycles 9" + out, 2, "--cycles = \"9\": must be a whole number from 10");
  expectRefusal(limiting_case + " --at 1.2 --statistics-cycles 99" + out, 2,
                "--statistics-cycles = \"99\": must be a whole number from 100");
  expectRefusal(limiting_case + " --at 1.2 --most-modes 101" + out, 2,
                "--most-modes = \"101\": must be a whole number from 1 to 100");
  expectRefusal(limiting_case + " --at 1.2 --threads 0" + out, 2, "--threads = \"0\": must be a whole number");
  expectRefusal(limiting_case + " --at 1.2 --acuracy 1" + out, 2, "--acuracy");
}

TEST_F(ConvergeTool, RefusesABadConfigurationAndAnUnwritableDirectory)
{
  expectRefusal(directory_.path() + "/absent.yaml --at 1.2 --out " + results(), 1,
                "/absent.yaml: cannot be read: No such file");
  const std::string file = directory_.file("file", "precious");
  // Computing this many cycles would take hours.
  expectRefusal(limiting_case + " --at 1.2 --cycles 1000000000 --out " + file + "/below", 1,
                file + "/below: cannot be created: ");
}

TEST_F(ConvergeTool, RefusesAnUndampedResonance)
{
  core::SystemParameters parameters = loadFile(rigid_surface);
  parameters.damping = {};
  const std::string undamped = directory_.file("undamped.yaml", toYaml(parameters));
  expectRefusal(undamped + " --at 1 --out " + results(), 1, "is a natural frequency of an undamped mode");
  // That of the third mode, before the bases without it are computed: these cycles would take hours.
  expectRefusal(undamped + " --at 1.2 9 --cycles 1000000000 --out " + results(), 1,
                "is a natural frequency of an undamped mode");
}

TEST_F(ConvergeTool, Helps)
{
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.error, "");
  for (const std::string option : {"CONFIG", "--at", "--accuracy", "--acceleration", "--cycles", "--statistics-cycles",
                                   "--most-modes", "--threads", "--out"})
  {
    EXPECT_THAT(outcome.out, HasSubstr(option));
  }
}

}  // namespace
}  // namespace vibro_impact::config
