#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <vibro_impact/Alarm.h>

#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/monitor_parameters.h"

using vibro_impact::config::Error;
using vibro_impact::graph::MonitorParameters;
using vibro_impact::graph::parseMonitorParameters;
using XmlRpc::XmlRpcValue;

namespace
{
XmlRpcValue goodTree()
{
  XmlRpcValue tree;
  tree["window"] = 2;
  tree["report_period"] = 0.5;
  tree["silence"] = 20;
  tree["histogram"]["from"] = "1e-8";
  tree["histogram"]["to"] = 1;
  tree["histogram"]["classes"] = 8;
  tree["wear"]["coefficient"] = "2.0e-14";
  tree["wear"]["source"] = "a test rig";
  tree["wear"]["area"] = 1.0e-6;
  tree["wear"]["sliding_distance"] = 1.0e-5;
  tree["alarms"]["silent"]["quantity"] = "impact_rate";
  tree["alarms"]["silent"]["raise_at"] = 1;
  tree["alarms"]["silent"]["clear_at"] = 5;
  tree["alarms"]["silent"]["on_delay"] = 0.25;
  tree["alarms"]["worn"]["quantity"] = "wear_depth";
  tree["alarms"]["worn"]["raise_at"] = 1.0e-6;
  tree["alarms"]["worn"]["clear_at"] = 0;
  tree["alarms"]["worn"]["severity"] = "error";
  tree["wear_feedback"]["interval"] = 3;
  return tree;
}

std::string faultsOf(const XmlRpcValue& tree)
{
  try
  {
    parseMonitorParameters(tree, "/monitor");
  }
  catch (const Error& error)
  {
    return error.what();
  }
  return "";
}

void expectFault(const XmlRpcValue& tree, const std::string& part)
{
  const std::string message = faultsOf(tree);
  EXPECT_NE(message.find(part), std::string::npos) << '"' << message << "\" lacks \"" << part << '"';
}

TEST(MonitorParameters, allOfThemAreRead)
{
  const MonitorParameters parameters = parseMonitorParameters(goodTree(), "/monitor");
  EXPECT_EQ(parameters.options.window, 2'000'000'000);
  EXPECT_EQ(parameters.options.report_period, 500'000'000);
  EXPECT_EQ(parameters.silence, 20.0);
  EXPECT_EQ(parameters.options.histogram.edges().size(), 9u);
  EXPECT_EQ(parameters.options.histogram.edges().front(), 1.0e-8);
  EXPECT_EQ(parameters.options.wear.coefficient, 2.0e-14);
  EXPECT_EQ(parameters.options.wear.sliding_distance, 1.0e-5);
  EXPECT_EQ(parameters.options.wear.sliding_speed, 0.0);
  EXPECT_EQ(parameters.wear_source, "a test rig");
  ASSERT_EQ(parameters.alarms.size(), 2u);
  EXPECT_EQ(parameters.alarms[0].name, "silent");
  EXPECT_EQ(parameters.alarms[0].limits.raise_at, 1.0);
  EXPECT_EQ(parameters.alarms[0].limits.on_delay, 250'000'000);
  EXPECT_EQ(parameters.alarms[0].severity, vibro_impact::Alarm::WARN);
  EXPECT_STREQ(parameters.alarms[1].quantity->name, "wear_depth");
  EXPECT_EQ(parameters.alarms[1].severity, vibro_impact::Alarm::ERROR);
  ASSERT_TRUE(parameters.wear_feedback);
  EXPECT_EQ(parameters.wear_feedback->simulator, "simulator");
  EXPECT_EQ(parameters.wear_feedback->limits.interval, 3'000'000'000);
}

TEST(MonitorParameters, noneIsRequired)
{
  XmlRpcValue nothing;
  const MonitorParameters parameters = parseMonitorParameters(nothing, "/monitor");
  EXPECT_EQ(parameters.options.window, 1'000'000'000);
  EXPECT_EQ(parameters.silence, 1.0);
  // The same whether a histogram is given without an edge or not at all.
  XmlRpcValue some;
  some["histogram"]["from"] = 1.0e-9;
  for (const MonitorParameters& defaults : {parameters, parseMonitorParameters(some, "/monitor")})
  {
    const std::vector<double>& edges = defaults.options.histogram.edges();
    EXPECT_EQ(edges.size(), 45u);
    EXPECT_EQ(edges.front(), 1.0e-9);
    EXPECT_EQ(edges.back(), 100.0) << "a ship's pipe has impacts of 26 N s";
  }
  EXPECT_TRUE(parameters.alarms.empty());
  EXPECT_FALSE(parameters.wear_feedback);
  EXPECT_EQ(parameters.options.wear.coefficient, 0.0);
}

TEST(MonitorParameters, everyFaultIsNamedAtOnce)
{
  XmlRpcValue tree = goodTree();
  tree["window"] = -1;
  tree["queue_size"] = -5;
  tree["silence"] = 0;
  tree["histogram"]["to"] = 1.0e-9;
  tree["wear"]["source"] = "";
  tree["wear"]["area"] = 0;
  tree["alarms"]["silent"]["quantity"] = "impact_rat";
  tree["alarms"]["worn"]["clear_at"] = 1.0e-6;
  tree["wear_feedback"]["greatest_stop"] = 1;
  const std::string message = faultsOf(tree);
  for (const char* part :
       {"window = -1: must be a number >= 0.001 and <= 600 (s)", "queue_size = -5", "silence = 0: must be a number > 0",
        "histogram.to = 1e-09", "wear.source = \"\": must be where the coefficient comes from",
        "wear.area = 0: must be a number > 0", "did you mean impact_rate?",
        "alarms.worn.clear_at = 1e-06: must be unlike raise_at", "did you mean greatest_step?"})
  {
    EXPECT_NE(message.find(part), std::string::npos) << '"' << message << "\" lacks \"" << part << '"';
  }
}

TEST(MonitorParameters, aFaultMakesNoOtherKeyUnknown)
{
  XmlRpcValue tree;
  tree["window"] = 0;
  tree["report_period"] = 0.2;
  tree["settling_time"] = 0.5;
  EXPECT_EQ(faultsOf(tree), "/monitor: window = 0: must be a number >= 0.001 and <= 600 (s)");
  tree["window"] = 1;
  tree["report_period"] = 0.001;
  EXPECT_EQ(faultsOf(tree),
            "/monitor: report_period = 0.001: must be a number >= 0.01, a hundredth of window, and <= 3600 (s)");
}

TEST(MonitorParameters, slidingIsSaidInOneWay)
{
  XmlRpcValue tree = goodTree();
  tree["wear"]["sliding_speed"] = 0.1;
  expectFault(tree, "wear.sliding = two of them: must be either sliding_speed (m/s) or sliding_distance");
  XmlRpcValue& wear = tree["wear"];
  wear = XmlRpcValue();
  wear["coefficient"] = 1.0e-14;
  wear["source"] = "a test rig";
  wear["area"] = 1;
  expectFault(tree, "wear.sliding = none: must be either");
}

TEST(MonitorParameters, whatIsMissingOrOfAnotherTypeIsNamed)
{
  XmlRpcValue tree = goodTree();
  tree["report_period"] = 0.001;
  expectFault(tree, "report_period = 0.001: must be a number >= 0.02, a hundredth of window");
  tree = goodTree();
  tree["alarms"] = 3;
  expectFault(tree, "alarms = 3: must be a map");
  tree = goodTree();
  tree["alarms"]["silent"] = 3;
  expectFault(tree, "alarms.silent = 3: must be a map");
  tree = goodTree();
  tree["alarms"]["worn"]["severity"] = "fatal";
  expectFault(tree, "alarms.worn.severity = \"fatal\": must be warn or error");
  tree = goodTree();
  tree["alarms"]["worn"]["raise_at"] = "high";
  expectFault(tree, "alarms.worn.raise_at = \"high\": must be a number in the unit of the quantity");
  tree = goodTree();
  tree["histogram"]["classes"] = 0;
  expectFault(tree, "histogram.classes = 0: must be a whole number from 1 to 1000");
  XmlRpcValue bare;
  bare["wear_feedback"]["interval"] = 1;
  expectFault(bare, "wear is missing: must be a map where there is wear_feedback");
}

}  // namespace
