#include "vibro_impact/config/sampled_excitation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "temporary_directory.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"

namespace vibro_impact::config
{
namespace
{
using testing::ElementsAre;
using testing::HasSubstr;

class ReadExcitation : public testing::Test
{
protected:
  SampledExcitation read(const std::string& text) const
  {
    return readExcitation(directory_.file("excitation.csv", text));
  }

  /// What the refusal of a table says after its path.
  std::string refusal(const std::string& text) const
  {
    const std::string path = directory_.file("excitation.csv", text);
    try
    {
      readExcitation(path);
    }
    catch (const Error& error)
    {
      const std::string message = error.what();
      EXPECT_EQ(message.find(path + ": "), 0u) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      return message.substr(std::min(message.size(), path.size() + 2));
    }
    ADD_FAILURE() << "taken: " << text;
    return {};
  }

  TemporaryDirectory directory_;
};

TEST_F(ReadExcitation, FindsItsColumnsByName)
{
  const SampledExcitation excitation = read("name,acceleration,time\na,1.5,10\nb,-2,10.25\nc,0,10.5\n");
  EXPECT_EQ(excitation.start, 10.0);
  EXPECT_EQ(excitation.sample_period, 0.25);
  EXPECT_THAT(excitation.acceleration, ElementsAre(1.5, -2.0, 0.0));
}

TEST_F(ReadExcitation, FindsThePeriodThatWasMeant)
{
  // What a program writes that multiplies.
  for (const double period : {2e-5, 1.0 / 44100.0, 1e-3, 0.1, 1.0 / 3.0})
  {
    std::string text = "time,acceleration\n";
    for (int i = 0; i < 1001; ++i)
    {
      text += formatNumber(i * period) + ",0\n";
    }
    EXPECT_NEAR(read(text).sample_period / period, 1.0, 1e-15) << period;
  }
  EXPECT_EQ(read("time,acceleration\n0,0\n2e-05,0\n4e-05,0\n6.0000000000000008e-05,0\n").sample_period, 2e-5);
}

TEST_F(ReadExcitation, TakesTimesThatAreRounded)
{
  std::string text = "time,acceleration\n";
  for (int i = 0; i <= 44100; ++i)
  {
    text += formatNumber(std::round(i / 44100.0 * 1e6) * 1e-6) + ",0\n";
  }
  EXPECT_NEAR(read(text).sample_period * 44100.0, 1.0, 1e-9);
}

TEST_F(ReadExcitation, RefusesAMissingColumn)
{
  EXPECT_EQ(refusal("time,velocity\n0,0\n1,0\n"), "line 1: columns are missing: acceleration");
  EXPECT_EQ(refusal("0,0\n1,0\n"), "line 1: columns are missing: time, acceleration");
  EXPECT_THAT(refusal(""), HasSubstr("is empty"));
}

TEST_F(ReadExcitation, RefusesWhatIsNoFiniteNumber)
{
  for (const std::string bad : {"nan", "inf", "-inf", "1e999", "", "fast", "1.5 "})
  {
    EXPECT_EQ(refusal("time,acceleration\n0,0\n1," + bad + "\n2,0\n"),
              "line 3: column acceleration = \"" + bad + "\": must be a finite number");
    EXPECT_EQ(refusal("time,acceleration\n0,0\n" + bad + ",0\n2,0\n"),
              "line 3: column time = \"" + bad + "\": must be a finite number");
  }
  EXPECT_EQ(refusal("time,acceleration\n0,0\n1\n"), "line 3: has 1 columns: must have 2");
}

TEST_F(ReadExcitation, RefusesUnequalSteps)
{
  // A sample is missing.
  EXPECT_EQ(refusal("time,acceleration\n0,0\n0.1,0\n0.2,0\n0.4,0\n0.5,0\n0.6,0\n"),
            "line 5: column time = 0.4: 0.2 s after the line before it: must be equally spaced, by about 0.1 s");
  EXPECT_THAT(refusal("time,acceleration\n0,0\n0.1,0\n0.19,0\n0.3,0\n"), HasSubstr("must be equally spaced"));
  // Each step is nearly the one before, and the last far from the first.
  std::string text = "time,acceleration\n";
  double time = 0.0;
  for (int i = 0; i < 100; ++i)
  {
    text += formatNumber(time) + ",0\n";
    time += 0.1 + 4e-5 * i;
  }
  EXPECT_THAT(refusal(text), HasSubstr("must be equally spaced: with "));
}

TEST_F(ReadExcitation, RefusesTimesThatDoNotGoOn)
{
  EXPECT_EQ(refusal("time,acceleration\n0,0\n0.1,0\n0.1,0\n"),
            "line 4: column time = 0.1: must be later than the line before it, 0.1");
  EXPECT_THAT(refusal("time,acceleration\n0.2,0\n0.1,0\n0,0\n"), HasSubstr("line 3: column time = 0.1: must be later"));
}

TEST_F(ReadExcitation, RefusesLessThanTwoSamples)
{
  EXPECT_EQ(refusal("time,acceleration\n"), "holds 0 samples: must hold at least 2");
  EXPECT_EQ(refusal("time,acceleration\n0,1\n"), "holds 1 sample: must hold at least 2");
}

TEST_F(ReadExcitation, RefusesWhatIsNotThere)
{
  EXPECT_THROW(readExcitation(directory_.path() + "/absent.csv"), Error);
  EXPECT_THROW(readExcitation(directory_.path()), Error);
}

}  // namespace
}  // namespace vibro_impact::config
