#include <gtest/gtest.h>

#include <string>
#include <variant>

#include <xmlrpcpp/XmlRpcValue.h>

#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/shaker_parameters.h"

namespace vibro_impact::graph
{
namespace
{
using XmlRpc::XmlRpcValue;

XmlRpcValue steppedSine()
{
  XmlRpcValue signal;
  signal["type"] = "stepped_sine";
  signal["acceleration"] = 10.0;
  signal["start_frequency"] = 100;
  signal["stop_frequency"] = 500.0;
  signal["frequency_step"] = 2.5;
  signal["cycles_per_step"] = 200;
  XmlRpcValue tree;
  tree["signal"] = signal;
  return tree;
}

XmlRpcValue sine()
{
  XmlRpcValue signal;
  signal["type"] = "sine";
  signal["acceleration"] = 10.0;
  signal["frequency"] = 100.0;
  XmlRpcValue tree;
  tree["signal"] = signal;
  return tree;
}

XmlRpcValue sweep(const char* type)
{
  XmlRpcValue signal;
  signal["type"] = type;
  signal["acceleration"] = 10.0;
  signal["start_frequency"] = 0.5;
  signal["stop_frequency"] = 4.0;
  signal["reference_frequency"] = 100.0;
  XmlRpcValue tree;
  tree["signal"] = signal;
  return tree;
}

std::string complaint(const XmlRpcValue& tree)
{
  try
  {
    parseShakerParameters(tree, "/shaker");
  }
  catch (const config::Error& error)
  {
    return error.what();
  }
  return "";
}

TEST(ShakerParameters, haveDefaults)
{
  const ShakerParameters parameters = parseShakerParameters(steppedSine(), "/shaker");
  EXPECT_EQ(parameters.sample_rate, 50000.0);
  EXPECT_EQ(parameters.block_rate, 200.0);
  EXPECT_EQ(parameters.samplesPerBlock(), 250u);
  EXPECT_EQ(parameters.speed, 1.0);
  EXPECT_EQ(parameters.max_blocks_ahead, 0u);
  EXPECT_EQ(parameters.wait_for_subscribers, 0u);
  EXPECT_EQ(parameters.recorder, "");
  EXPECT_EQ(parameters.recorded_topics.size(), 5u);
  const auto& signal = std::get<core::SteppedSineParameters>(parameters.signal);
  EXPECT_EQ(signal.acceleration, 10.0);
  EXPECT_EQ(signal.reference_frequency, 1.0);
  EXPECT_EQ(signal.start_frequency, 100.0);
  EXPECT_EQ(signal.stop_frequency, 500.0);
  EXPECT_EQ(signal.frequency_step, 2.5);
  EXPECT_EQ(signal.cycles_per_step, 200);
  EXPECT_EQ(signal.soft_start_cycles, 0.0);
  EXPECT_EQ(signal.rest, 0.0);
}

TEST(ShakerParameters, takeABlockForEverySampleOfASlowSignal)
{
  XmlRpcValue tree;
  tree["sample_rate"] = 100.0;
  tree["signal"]["type"] = "sine";
  tree["signal"]["acceleration"] = 1.0;
  tree["signal"]["frequency"] = 5.0;
  tree["signal"]["cycles"] = 10.0;
  const ShakerParameters parameters = parseShakerParameters(tree, "/shaker");
  EXPECT_EQ(parameters.block_rate, 100.0);
  EXPECT_EQ(parameters.samplesPerBlock(), 1u);
  // One that is given is not to be beyond it.
  tree["block_rate"] = 200.0;
  EXPECT_EQ(complaint(tree), "/shaker: block_rate = 200: must be a number from 0.0001 to 100, the sample rate (Hz)");
  // Nor has a fast signal blocks that are too long.
  tree = steppedSine();
  tree["sample_rate"] = 1.0e9;
  EXPECT_EQ(parseShakerParameters(tree, "/shaker").block_rate, 1000.0);
}

TEST(ShakerParameters, takeATextThatIsWhollyANumber)
{
  XmlRpcValue tree = steppedSine();
  tree["sample_rate"] = "1e5";
  tree["queue_size"] = "7";
  tree["signal"]["cycles_per_step"] = "12";
  tree["signal"]["acceleration"] = "2e1";
  const ShakerParameters parameters = parseShakerParameters(tree, "/shaker");
  EXPECT_EQ(parameters.sample_rate, 1.0e5);
  EXPECT_EQ(parameters.queue_size, 7u);
  EXPECT_EQ(std::get<core::SteppedSineParameters>(parameters.signal).cycles_per_step, 12);
  EXPECT_EQ(std::get<core::SteppedSineParameters>(parameters.signal).acceleration, 20.0);
}

TEST(ShakerParameters, giveASineByCyclesOrDuration)
{
  XmlRpcValue tree = sine();
  tree["signal"]["cycles"] = 12.5;
  EXPECT_EQ(std::get<core::SineParameters>(parseShakerParameters(tree, "").signal).cycles, 12.5);

  tree = sine();
  tree["signal"]["duration"] = 2.0;
  tree["signal"]["reference_frequency"] = 3.0;
  EXPECT_EQ(std::get<core::SineParameters>(parseShakerParameters(tree, "").signal).cycles, 600.0);

  EXPECT_EQ(complaint(sine()), "/shaker: signal.cycles is missing: must be a number > 0, or duration one (s)");
  tree["signal"]["cycles"] = 12;
  EXPECT_EQ(complaint(tree), "/shaker: signal.cycles = 12: must be left out where there is duration");
  tree = sine();
  tree["signal"]["duration"] = -2.0;
  EXPECT_EQ(complaint(tree), "/shaker: signal.duration = -2: must be a finite number > 0 (s)");
}

TEST(ShakerParameters, giveASweepByRateOrDuration)
{
  XmlRpcValue tree = sweep("linear_sweep");
  tree["signal"]["rate"] = 0.07;
  const auto linear = std::get<core::SweptSineParameters>(parseShakerParameters(tree, "").signal);
  EXPECT_EQ(linear.law, core::SweepLaw::linear);
  EXPECT_DOUBLE_EQ(linear.duration, 50.0);

  tree = sweep("logarithmic_sweep");
  tree["signal"]["rate"] = 2;
  const auto logarithmic = std::get<core::SweptSineParameters>(parseShakerParameters(tree, "").signal);
  EXPECT_EQ(logarithmic.law, core::SweepLaw::logarithmic);
  EXPECT_DOUBLE_EQ(logarithmic.duration, 90.0);

  tree = sweep("logarithmic_sweep");
  tree["signal"]["duration"] = 30.0;
  EXPECT_EQ(std::get<core::SweptSineParameters>(parseShakerParameters(tree, "").signal).duration, 30.0);

  EXPECT_EQ(complaint(sweep("linear_sweep")),
            "/shaker: signal.rate is missing: must be a number > 0 "
            "(reference_frequency per second), or duration one (s)");
}

TEST(ShakerParameters, areAllRejectedInOneMessage)
{
  XmlRpcValue tree = steppedSine();
  tree["sample_rate"] = -1.0;
  tree["block_rate"] = "fast";
  tree["speed"] = 0;
  tree["wait_for_subscribers"] = 1.5;
  tree["recorder"] = 7;
  tree["recorded_topics"] = "gap";
  tree["timeout"] = true;
  tree["sped"] = 2.0;
  tree["signal"]["acceleration"] = -10.0;
  tree["signal"]["start_frequency"] = "low";
  tree["signal"]["cycles_per_step"] = 2.5;
  tree["signal"]["cycle"] = 2;
  const std::string message = complaint(tree);
  EXPECT_EQ(message.substr(0, message.find('\n')), "/shaker: 12 faults");
  for (const char* fault :
       {"sample_rate = -1: must be a number > 0", "block_rate = \"fast\": must be a number from",
        "wait_for_subscribers = 1.5: must be a whole number", "recorder = 7: must be a text",
        "recorded_topics = \"gap\": must be a list of texts", "timeout = true: must be a number >= 0",
        "\"sped\" is unknown: did you mean speed?", "max_blocks_ahead is missing: must be at least 1 where speed is 0",
        "signal.acceleration = -10: must be a finite number >= 0",
        "signal.start_frequency = \"low\": must be a number > 0",
        "signal.cycles_per_step = 2.5: must be a whole number >= 1", "signal.\"cycle\" is unknown"})
  {
    EXPECT_NE(message.find(fault), std::string::npos) << fault << "\nin\n" << message;
  }
}

TEST(ShakerParameters, needASignal)
{
  EXPECT_EQ(complaint(XmlRpcValue()), "/shaker: signal is missing: must be a map");
  XmlRpcValue tree;
  tree["signal"]["type"] = "noise";
  EXPECT_EQ(complaint(tree),
            "/shaker: signal.type = \"noise\": must be sine, stepped_sine, sine_dwells, linear_sweep, "
            "logarithmic_sweep, banded_sweep, random, shock, table or bag");
  tree["signal"] = "loud";
  EXPECT_EQ(complaint(tree), "/shaker: signal = \"loud\": must be a map");
}

TEST(ShakerParameters, mustAgreeWithTheSampleRate)
{
  XmlRpcValue tree = steppedSine();
  tree["sample_rate"] = 900.0;
  EXPECT_EQ(complaint(tree),
            "/shaker: signal.stop_frequency = 500: must be a number > 0 and < 450, half the sample rate (Hz)");
  tree = steppedSine();
  tree["block_rate"] = 60000.0;
  EXPECT_EQ(complaint(tree), "/shaker: block_rate = 60000: must be a number from 0.05 to 50000, the sample rate (Hz)");
  tree = steppedSine();
  tree["signal"]["start_frequency"] = 1.0e-300;
  EXPECT_NE(complaint(tree).find("/shaker: signal.duration = "), std::string::npos) << complaint(tree);
}

}  // namespace
}  // namespace vibro_impact::graph
