// Runs the program as a user does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../config/tool_test.h"
#include "vibro_impact/config/sampled_excitation.h"

namespace
{
using testing::HasSubstr;

class WriteSignal : public ToolTest
{
protected:
  WriteSignal() : ToolTest(WRITE_SIGNAL, "write_signal")
  {
    sine_ = directory_.file("sine.yaml",
                            "{sample_rate: 1000, signal: {type: sine, acceleration: 2, frequency: 10, cycles: 5}}");
  }

  std::string sine_;
};

TEST_F(WriteSignal, SaysWhatASignalIs)
{
  Outcome outcome = run(sine_);
  EXPECT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_EQ(outcome.out, "500 samples at 1000 Hz, 0.5 s\n");
  outcome = run(CONFIG_DIRECTORY "/excitation/half_sine_shock.yaml");
  EXPECT_THAT(outcome.out, HasSubstr("3 pulses, each of which leaves the base with a velocity of 1.0504"));
  EXPECT_THAT(outcome.out, testing::Not(HasSubstr("the fall")));
  outcome = run(CONFIG_DIRECTORY "/excitation/terminal_peak_shock.yaml");
  EXPECT_THAT(outcome.out,
              HasSubstr("velocity of 0.8325 m/s; A T/2 is 0.825 m/s, the fall from the peak takes a sample"));
  outcome = run(CONFIG_DIRECTORY "/excitation/iec_60068_2_64_random.yaml");
  EXPECT_THAT(outcome.out, HasSubstr("root mean square 2.7167"));
  outcome = run(CONFIG_DIRECTORY "/excitation/mil_std_167_exploratory.yaml");
  EXPECT_THAT(outcome.out, HasSubstr("30 dwells of at least 15 s"));
}

TEST_F(WriteSignal, WritesATableThatReadsBack)
{
  ASSERT_EQ(run(sine_ + " --out " + results()).status, 0);
  const auto whole = vibro_impact::config::readExcitation(results() + "/signal.csv");
  EXPECT_EQ(whole.start, 0.0);
  EXPECT_EQ(whole.sample_period, 1.0e-3);
  ASSERT_EQ(whole.acceleration.size(), 500u);
  for (std::size_t i = 0; i < 500; ++i)
  {
    EXPECT_NEAR(whole.acceleration[i], 2.0 * std::sin(2.0 * M_PI * 0.01 * static_cast<double>(i)), 1.0e-12);
  }
  ASSERT_EQ(run(sine_ + " --from 0.1 --to 0.2 --out " + results("part")).status, 0);
  const auto part = vibro_impact::config::readExcitation(results("part") + "/signal.csv");
  EXPECT_EQ(part.start, 0.1);
  ASSERT_EQ(part.acceleration.size(), 101u);
  EXPECT_EQ(part.acceleration[7], whole.acceleration[107]);
}

TEST_F(WriteSignal, TakesTheSamplesThatTheTimesName)
{
  // 0.07 s * 100 Hz is a little more than 7, 0.29 s * 100 Hz a little less than 29.
  const std::string coarse = directory_.file(
      "coarse.yaml", "{sample_rate: 100, signal: {type: sine, acceleration: 2, frequency: 10, cycles: 5}}");
  ASSERT_EQ(run(coarse + " --from 0.07 --to 0.29 --out " + results()).status, 0);
  const auto part = vibro_impact::config::readExcitation(results() + "/signal.csv");
  EXPECT_NEAR(part.start, 0.07, 1.0e-15);
  EXPECT_EQ(part.acceleration.size(), 23u);
}

TEST_F(WriteSignal, RefusesWhatItCannotWrite)
{
  expectRefusal("--out " + results(), 2, "0 signal files are given: must be one");
  expectRefusal(sine_ + " --from 1 --to 0.5 --out " + results(), 2, "--from must not be later than --to");
  expectRefusal(sine_ + " --from 1", 2, "--from and --to are for --out");
  expectRefusal(sine_ + " --from x --out " + results(), 2, "--from = \"x\": must be a number from 0 to");
  expectRefusal(sine_ + " --from 1 --out " + results(), 1, "the signal has no sample from 1 s on: it lasts 0.5 s");
  expectRefusal(directory_.path() + "/absent.yaml --out " + results(), 1, "/absent.yaml: No such file or directory");
  const std::string bad = directory_.file("bad.yaml", "{signal: {type: sine, acceleration: 2, frequency: 10}}");
  expectRefusal(bad + " --out " + results(), 1, "bad.yaml: signal.cycles is missing");
  const std::string endless = directory_.file(
      "endless.yaml", "{sample_rate: 1000, signal: {type: sine, acceleration: 2, frequency: 10, cycles: 1e7}}");
  expectRefusal(endless + " --out " + results(), 1,
                "the signal has 1000000000 samples: at most 50000000 can be held at once; take a part of it");
}

TEST_F(WriteSignal, Helps)
{
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.status, 0);
  for (const std::string option : {"SIGNAL", "--from", "--to", "--out"})
  {
    EXPECT_THAT(outcome.out, HasSubstr(option));
  }
}

}  // namespace
