#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/view.h"

using testing::HasSubstr;
using vibro_impact::graph::parseViewParameters;
using XmlRpc::XmlRpcValue;

TEST(ViewParameters, defaults)
{
  XmlRpcValue none;
  none.begin();  // an empty map
  const auto parameters = parseViewParameters(none, "/view");
  EXPECT_EQ(parameters.frame_rate, 25.0);
  EXPECT_EQ(parameters.slow_motion, 0.0);
  EXPECT_EQ(parameters.stretch, 6.0);
  EXPECT_EQ(parameters.displacement_scale, 0.0);
}

TEST(ViewParameters, allAreRead)
{
  XmlRpcValue tree;
  tree["frame_rate"] = 10;
  tree["slow_motion"] = 540.0;
  tree["stretch"] = 3.0;
  tree["fade"] = 1.0;
  tree["displacement_scale"] = 2000;
  tree["force_scale"] = 0.5;
  const auto parameters = parseViewParameters(tree, "/view");
  EXPECT_EQ(parameters.frame_rate, 10.0);
  EXPECT_EQ(parameters.slow_motion, 540.0);
  EXPECT_EQ(parameters.stretch, 3.0);
  EXPECT_EQ(parameters.fade, 1.0);
  EXPECT_EQ(parameters.displacement_scale, 2000.0);
  EXPECT_EQ(parameters.force_scale, 0.5);
}

TEST(ViewParameters, faultsAreSaidTogether)
{
  XmlRpcValue tree;
  tree["frame_rate"] = 0;
  tree["slow_motion"] = -1.0;
  tree["stretch"] = "long";
  tree["fade"] = 0.0;
  tree["displacement_scale"] = -1;
  tree["force_scale"] = -1;
  tree["speed"] = 1;
  try
  {
    parseViewParameters(tree, "/view");
    ADD_FAILURE();
  }
  catch (const vibro_impact::config::Error& error)
  {
    for (const char* part :
         {"/view: 7 faults", "frame_rate = 0: must be a number > 0 and <= 200 (Hz)", "slow_motion = -1",
          "stretch = \"long\"", "fade = 0", "displacement_scale = -1", "force_scale = -1", "\"speed\" is unknown"})
    {
      EXPECT_THAT(error.what(), HasSubstr(part));
    }
  }
}
