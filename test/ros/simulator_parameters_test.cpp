#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/simulator_parameters.h"

namespace core = vibro_impact::core;
using vibro_impact::config::Error;
using vibro_impact::graph::InputKind;
using vibro_impact::graph::parseSimulatorParameters;
using vibro_impact::graph::SimulatorParameters;
using vibro_impact::graph::toYaml;
using XmlRpc::XmlRpcValue;

namespace
{
/// As the parameter server gives it: whole numbers become integers, `1.66e9` a text.
XmlRpcValue goodTree()
{
  XmlRpcValue tree;
  tree["beam1"]["youngs_modulus"] = "1.66e9";
  tree["beam1"]["density"] = 954;
  tree["beam1"]["length"] = 0.0529;
  tree["beam1"]["height"] = 0.00127;
  tree["beam1"]["width"] = 0.0127;
  tree["beam1"]["contact_location"] = 0.02645;
  tree["beam2"] = "rigid";
  tree["contact"]["stiffness"] = 24309.426302924;
  tree["contact"]["clearance"] = 0;
  tree["damping"]["free"] = 0.01;
  tree["damping"]["contact"] = 0.05;
  tree["basis"]["type"] = "attachment";
  tree["basis"]["modes_per_beam"] = 3;
  return tree;
}

void expectFaults(const XmlRpcValue& tree, const std::vector<std::string>& parts)
{
  try
  {
    parseSimulatorParameters(tree, "/simulator");
    ADD_FAILURE() << "nothing was thrown";
  }
  catch (const Error& error)
  {
    const std::string message = error.what();
    for (const std::string& part : parts)
    {
      EXPECT_NE(message.find(part), std::string::npos) << '"' << message << "\" lacks \"" << part << '"';
    }
  }
}

TEST(SimulatorParameters, everyKindOfStructureIsRead)
{
  XmlRpcValue tree = goodTree();
  tree["beam1"] = XmlRpcValue();
  tree["beam1"]["length"] = 2;
  tree["beam1"]["contact_location"] = 1;
  tree["beam1"]["section"]["bending_stiffness"] = 12.5;
  tree["beam1"]["section"]["mass_per_length"] = 1;
  tree["beam1"]["ends"][0] = "clamped";
  tree["beam1"]["ends"][1] = "free";
  tree["beam1"]["rigid_body"]["length"] = 0.1;
  tree["beam1"]["rigid_body"]["mass"] = 3;
  tree["beam1"]["rigid_body"]["rotary_inertia"] = 0;
  XmlRpcValue& table = tree["beam2"];
  table = XmlRpcValue();
  const char* const columns[] = {"frequency_hz", "contact_deflection", "participation"};
  for (int i = 0; i < 3; ++i)
  {
    table["modal_table"][columns[i]][0] = i;
    table["modal_table"][columns[i]][1] = 1.5 + i;
  }
  const SimulatorParameters parameters = parseSimulatorParameters(tree, "/simulator");
  const auto& beam = std::get<core::BeamParameters>(parameters.system.beam1);
  EXPECT_EQ(beam.ends[0], core::End::clamped);
  EXPECT_EQ(beam.ends[1], core::End::free);
  EXPECT_EQ(beam.rigid_body->mass, 3.0);
  const auto& modes = std::get<core::ModalTableParameters>(parameters.system.beam2);
  EXPECT_EQ(modes.frequency_hz, (std::vector<double>{0.0, 1.5}));
  EXPECT_EQ(modes.participation, (std::vector<double>{2.0, 3.5}));

  // A file needs the folder that it is in, which the parameter server does not know.
  tree["beam2"] = XmlRpcValue();
  tree["beam2"]["modal_table"]["file"] = "nowhere.csv";
  expectFaults(tree, {"beam2.modal_table.file", "nowhere.csv", "an absolute path"});
  tree["configuration_directory"] = "/tmp/no/such/folder";
  expectFaults(tree, {"/tmp/no/such/folder/nowhere.csv", "No such file"});
}

TEST(SimulatorParameters, modelIsRead)
{
  const SimulatorParameters parameters = parseSimulatorParameters(goodTree(), "/simulator");
  EXPECT_EQ(std::get<core::BeamParameters>(parameters.system.beam1).youngs_modulus, 1.66e9);
  EXPECT_EQ(std::get<core::BeamParameters>(parameters.system.beam1).density, 954.0);
  EXPECT_EQ(std::get<core::BeamParameters>(parameters.system.beam1).length, 0.0529);
  EXPECT_EQ(parameters.system.contact.stiffness, 24309.426302924);
  EXPECT_TRUE(std::holds_alternative<core::RigidSurface>(parameters.system.beam2));
  EXPECT_EQ(std::get<core::AttachmentBasis>(parameters.system.basis).modes_per_beam, 3);
}

TEST(SimulatorParameters, ownParametersHaveDefaults)
{
  const SimulatorParameters parameters = parseSimulatorParameters(goodTree(), "/simulator");
  EXPECT_EQ(parameters.limits.max_acceleration, 1.0e5);
  EXPECT_EQ(parameters.limits.max_bridged_gap, 0.02);
  EXPECT_EQ(parameters.limits.max_step_back, 0.1);
  EXPECT_EQ(parameters.limits.max_stamp_jitter, 0.05);
  EXPECT_EQ(parameters.mirror_rate, 50.0);
  EXPECT_EQ(parameters.motion_rate, 0.0);
  EXPECT_EQ(parameters.queue_size, 1000u);
  EXPECT_EQ(parameters.thresholds.max_input_age, 1.0);
  EXPECT_EQ(parameters.diagnostic_period, 1.0);
}

TEST(SimulatorParameters, ownParametersAreRead)
{
  XmlRpcValue tree = goodTree();
  tree["max_acceleration"] = 500;
  tree["max_bridged_gap"] = 0;
  tree["max_step_back"] = 0.25;
  tree["max_stamp_jitter"] = "1e-2";
  tree["mirror_rate"] = 25;
  tree["motion_rate"] = 1000;
  tree["queue_size"] = "0";
  tree["max_input_age"] = 2.5;
  tree["diagnostic_period"] = 0.1;
  tree["warn_lost_samples"] = 250;
  tree["warn_real_time_factor"] = 4;
  tree["error_real_time_factor"] = 2;
  tree["warn_block_load"] = 0.25;
  tree["warn_queue_share"] = 0.75;
  tree["warn_energy_closure"] = "1e-9";
  const SimulatorParameters parameters = parseSimulatorParameters(tree, "/simulator");
  EXPECT_EQ(parameters.limits.max_acceleration, 500.0);
  EXPECT_EQ(parameters.limits.max_bridged_gap, 0.0);
  EXPECT_EQ(parameters.limits.max_step_back, 0.25);
  EXPECT_EQ(parameters.limits.max_stamp_jitter, 0.01);
  EXPECT_EQ(parameters.mirror_rate, 25.0);
  EXPECT_EQ(parameters.motion_rate, 1000.0);
  EXPECT_EQ(parameters.queue_size, 0u);
  EXPECT_EQ(parameters.thresholds.max_input_age, 2.5);
  EXPECT_EQ(parameters.diagnostic_period, 0.1);
  EXPECT_EQ(parameters.thresholds.warn_lost_samples, 250.0);
  EXPECT_EQ(parameters.thresholds.warn_real_time_factor, 4.0);
  EXPECT_EQ(parameters.thresholds.error_real_time_factor, 2.0);
  EXPECT_EQ(parameters.thresholds.warn_block_load, 0.25);
  EXPECT_EQ(parameters.thresholds.warn_queue_share, 0.75);
  EXPECT_EQ(parameters.thresholds.warn_energy_closure, 1.0e-9);
}

TEST(SimulatorParameters, emptyTreeNamesWhatIsMissing)
{
  for (const XmlRpcValue& tree : {XmlRpcValue(), XmlRpcValue(3)})
  {
    expectFaults(tree, {"/simulator", "beam1", "beam2", "contact", "damping", "missing"});
  }
}

TEST(SimulatorParameters, allFaultsComeInOneMessage)
{
  XmlRpcValue tree = goodTree();
  tree["beam1"]["length"] = -1.0;
  tree["beam1"]["widht"] = 0.1;
  tree["mirror_rate"] = 0;
  tree["queue_size"] = -1;
  tree["max_acceleration"] = "much";
  tree["frequency"] = 50;
  tree["mirorr_rate"] = 50;
  expectFaults(tree, {"/simulator: 5 faults", "mirror_rate = 0: must be a number > 0 and <= 10000 (Hz)",
                      "queue_size = -1: must be a whole number from 0 to 1000000",
                      "max_acceleration = \"much\": must be a number > 0",
                      "\"frequency\" is unknown: must be one of beam1", "mirror_rate, motion_rate, queue_size",
                      "\"mirorr_rate\" is unknown: did you mean mirror_rate?", "beam1.length = -1.0", "widht"});
}

TEST(SimulatorParameters, everyOwnParameterIsChecked)
{
  for (const char* key :
       {"max_acceleration", "max_bridged_gap", "max_step_back", "max_stamp_jitter", "mirror_rate", "motion_rate",
        "queue_size", "max_input_age", "diagnostic_period", "warn_lost_samples", "warn_real_time_factor",
        "error_real_time_factor", "warn_block_load", "warn_queue_share", "warn_energy_closure"})
  {
    const std::vector<std::pair<XmlRpcValue, std::string>> bad = {
        {-1, "-1"}, {1.0e12, "1000000000000"}, {"nan", "\"nan\""}, {true, "true"}, {std::string(), "\"\""}};
    for (const auto& [value, shown] : bad)
    {
      XmlRpcValue tree = goodTree();
      tree[key] = value;
      expectFaults(tree, {std::string("/simulator: ") + key + " = " + shown + ": must be "});
    }
  }
  for (const XmlRpcValue& value : {XmlRpcValue(2.5), XmlRpcValue("2.5")})
  {
    XmlRpcValue tree = goodTree();
    tree["queue_size"] = value;
    expectFaults(tree, {"queue_size = 2.5: must be a whole number from 0 to 1000000"});
  }
}

XmlRpcValue treeOf(const std::string& input)
{
  XmlRpcValue tree = goodTree();
  tree["input"] = input;
  return tree;
}

TEST(SimulatorParameters, inputHasDefaults)
{
  EXPECT_EQ(parseSimulatorParameters(goodTree(), "/simulator").input.kind, InputKind::block);
  for (const InputKind kind : {InputKind::accel, InputKind::imu})
  {
    const auto input = parseSimulatorParameters(treeOf(nameOf(kind)), "/simulator").input;
    EXPECT_EQ(input.kind, kind);
    EXPECT_EQ(input.axis.component, 2u);
    EXPECT_EQ(input.axis.sign, 1.0);
    EXPECT_EQ(input.frame_id, "");
    EXPECT_FALSE(input.grid.sample_period) << "measured";
    EXPECT_EQ(input.grid.offset.has_value(), kind == InputKind::accel) << "the mean of specific forces is gravity";
    EXPECT_EQ(input.grid.offset.value_or(0.0), 0.0);
    EXPECT_EQ(input.grid.offset_duration, 2.0);
  }
}

TEST(SimulatorParameters, inputIsRead)
{
  XmlRpcValue tree = treeOf("imu");
  tree["frame_id"] = "imu_link";
  tree["sample_period"] = "4e-3";
  tree["offset"] = -9.81;
  const auto input = parseSimulatorParameters(tree, "/simulator").input;
  EXPECT_EQ(input.frame_id, "imu_link");
  EXPECT_EQ(input.grid.sample_period, 4.0e-3);
  EXPECT_EQ(input.grid.offset, -9.81);

  tree["offset"] = "mean";
  tree["offset_duration"] = 5;
  const auto measured = parseSimulatorParameters(tree, "/simulator").input;
  EXPECT_FALSE(measured.grid.offset);
  EXPECT_EQ(measured.grid.offset_duration, 5.0);

  const std::pair<const char*, std::pair<std::size_t, double>> axes[] = {
      {"x", {0, 1.0}}, {"-x", {0, -1.0}}, {"y", {1, 1.0}}, {"-y", {1, -1.0}}, {"z", {2, 1.0}}, {"-z", {2, -1.0}}};
  for (const auto& [name, meant] : axes)
  {
    tree["axis"] = name;
    const auto axis = parseSimulatorParameters(tree, "/simulator").input.axis;
    EXPECT_EQ(axis.component, meant.first) << name;
    EXPECT_EQ(axis.sign, meant.second) << name;
  }
}

TEST(SimulatorParameters, faultsOfTheInputComeInOneMessage)
{
  XmlRpcValue tree = treeOf("accel");
  tree["axis"] = "up";
  tree["frame_id"] = 3;
  tree["sample_period"] = 0;
  tree["offset"] = "medium";
  tree["offset_duration"] = -1;
  expectFaults(tree,
               {"/simulator: 5 faults", "axis = \"up\": must be x, -x, y, -y, z or -z", "frame_id = 3: must be a text",
                "sample_period = 0: must be a number from 1e-09 to 1000 (s)",
                "offset = \"medium\": must be the word mean, or a number of at most 1000000000 in magnitude (m/s^2)",
                "offset_duration = -1: must be a number > 0 and <= 60 (s)"});
  for (const char* offset : {"nan", "1e10"})
  {
    tree["offset"] = offset;
    expectFaults(tree, {"offset = "});
  }
  expectFaults(treeOf("IMU"), {"/simulator: input = \"IMU\": must be block, accel or imu"});
}

TEST(SimulatorParameters, whatHasNoMeaningForTheInputIsAFault)
{
  XmlRpcValue tree = treeOf("block");
  tree["axis"] = "z";
  tree["frame_id"] = "imu_link";
  tree["sample_period"] = 0.001;
  tree["offset"] = 0;
  tree["offset_duration"] = 1;
  expectFaults(tree, {"/simulator: 5 faults", "axis = \"z\": must be left out where input is block",
                      "frame_id = \"imu_link\": must be left out where input is block",
                      "sample_period = 0.001: must be left out where input is block",
                      "offset = 0: must be left out where input is block",
                      "offset_duration = 1: must be left out where input is block"});

  tree = treeOf("imu");
  tree["max_stamp_jitter"] = 0.1;
  tree["offset"] = 9.81;
  tree["offset_duration"] = 1;
  expectFaults(tree, {"/simulator: 2 faults", "max_stamp_jitter = 0.1: must be left out where input is imu",
                      "offset_duration = 1: must be left out where offset is a number"});
}

TEST(SimulatorParameters, numbersOfTheModelKeepTheirType)
{
  XmlRpcValue tree = goodTree();
  tree["basis"]["modes_per_beam"] = 3.0;
  expectFaults(tree, {"modes_per_beam"});
}

TEST(ParameterTreeAsYaml, everyTypeIsWritten)
{
  XmlRpcValue tree;
  tree["b"] = true;
  tree["d"] = 0.1;
  tree["e"] = 1.0e300;
  tree["i"] = -3;
  tree["l"][0] = 1;
  tree["l"][1] = 2.0;
  tree["s"] = std::string("a \"word\"\n\\");
  EXPECT_EQ(toYaml(tree), R"({"b": true, "d": 0.1, "e": 1e+300, "i": -3, "l": [1, 2.0], "s": "a \"word\"\x0a\\"})");
  EXPECT_EQ(toYaml(XmlRpcValue()), "null");
}

}  // namespace
