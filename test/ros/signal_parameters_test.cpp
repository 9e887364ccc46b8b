#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <variant>

#include "../config/temporary_directory.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/parameter_file.h"
#include "vibro_impact/ros/signal_table.h"

namespace vibro_impact::graph
{
namespace
{
using testing::HasSubstr;

/// Parameters from text as a file would give them.
class SignalFile : public testing::Test
{
protected:
  ShakerParameters load(const std::string& text) const
  {
    return loadShakerParameters(directory_.file("signal.yaml", text));
  }

  /// What is wrong with the text, without the path of the file.
  std::string complaint(const std::string& text) const
  {
    try
    {
      load(text);
    }
    catch (const config::Error& error)
    {
      const std::string message = error.what();
      const std::string path = directory_.path() + "/signal.yaml: ";
      EXPECT_EQ(message.substr(0, path.size()), path);
      return message.substr(std::min(message.size(), path.size()));
    }
    return "";
  }

  TemporaryDirectory directory_;
};

const std::string dwells = "signal: {type: sine_dwells, dwell: 2, bands: [";
const std::string banded_sweep = "signal: {type: banded_sweep, rate: 0.5, bands: [";
const std::string random_noise = "signal: {type: random, duration: 60, spectrum: [";
const std::string shock = "signal: {type: shock, shape: half_sine, peak: 150, duration: 0.011";

TEST_F(SignalFile, givesDwells)
{
  const auto signal = std::get<core::SineDwellParameters>(
      load("{sample_rate: 2000, " + dwells +
           "{from: 4, to: 15, displacement: 7.62e-4}, {from: 16, to: 16, velocity: 0.05}], ramp_cycles: 3}}")
          .signal);
  ASSERT_EQ(signal.bands.size(), 2u);
  EXPECT_EQ(signal.bands[0].to, 15.0);
  EXPECT_EQ(signal.bands[0].amplitude.quantity, core::MotionQuantity::displacement);
  EXPECT_EQ(signal.bands[0].amplitude.value, 7.62e-4);
  EXPECT_EQ(signal.bands[1].amplitude.quantity, core::MotionQuantity::velocity);
  EXPECT_EQ(signal.frequency_step, 1.0);
  EXPECT_EQ(signal.dwell, 2.0);
  EXPECT_EQ(signal.ramp_cycles, 3.0);
}

TEST_F(SignalFile, givesABandedSweep)
{
  const auto signal = std::get<core::BandedSweepParameters>(
      load(banded_sweep + "{from: 2, to: 13.2, displacement: 1e-3}, {from: 13.2, to: 100, acceleration: 7}], "
                          "direction: down, sweeps: 2, soft_start_cycles: 3}")
          .signal);
  EXPECT_EQ(signal.rate, 0.5);
  EXPECT_FALSE(signal.upwards);
  EXPECT_EQ(signal.sweeps, 2);
  EXPECT_EQ(signal.soft_start_cycles, 3.0);
  EXPECT_EQ(signal.bands[1].amplitude.quantity, core::MotionQuantity::acceleration);
}

TEST_F(SignalFile, givesNoise)
{
  const auto signal = std::get<core::RandomParameters>(
      load(random_noise + "{frequency: 5, density: 0.1}, {frequency: 50, density: 0.2}], seed: 7, soft_start: 2}")
          .signal);
  ASSERT_EQ(signal.spectrum.size(), 2u);
  EXPECT_EQ(signal.spectrum[1].frequency, 50.0);
  EXPECT_EQ(signal.spectrum[1].density, 0.2);
  EXPECT_EQ(signal.seed, 7);
  EXPECT_EQ(signal.soft_start, 2.0);
}

TEST_F(SignalFile, givesAShock)
{
  const auto signal = std::get<core::ShockParameters>(
      load("signal: {type: shock, shape: terminal_peak_sawtooth, peak: -150, duration: 0.011, before: 1, after: 2, "
           "repetitions: 3, interval: 4}")
          .signal);
  EXPECT_EQ(signal.shape, core::ShockShape::terminal_peak_sawtooth);
  EXPECT_EQ(signal.peak, -150.0);
  EXPECT_EQ(signal.duration, 0.011);
  EXPECT_EQ(signal.before, 1.0);
  EXPECT_EQ(signal.after, 2.0);
  EXPECT_EQ(signal.repetitions, 3);
  EXPECT_EQ(signal.interval, 4.0);
}

TEST_F(SignalFile, playsATableBesideIt)
{
  directory_.file("measured.csv", "time,acceleration\n1,0.5\n1.004,-2\n1.008,3\n");
  const ShakerParameters parameters = load("signal: {type: table, file: measured.csv}");
  EXPECT_EQ(parameters.sample_rate, 250.0);
  EXPECT_EQ(parameters.samplesPerBlock(), 1u);
  const config::SampledExcitation samples = sampleSignal(parameters);
  EXPECT_EQ(samples.sample_period, 0.004);
  EXPECT_EQ(samples.acceleration, (std::vector<double>{0.5, -2.0, 3.0}));
}

TEST_F(SignalFile, rejectsBadBands)
{
  EXPECT_EQ(complaint("signal: {type: sine_dwells, dwell: 2}"),
            "signal.bands is missing: must be a list of maps, at least one");
  EXPECT_EQ(complaint(dwells + "]}"), "signal.bands is a list: must be a list of maps, at least one");
  EXPECT_EQ(complaint(dwells + "4, 5]}"), "signal.bands is a list: must be a list of maps, at least one");
  EXPECT_EQ(complaint(dwells + "{from: 4, to: 5}]}"),
            "signal.bands[0].amplitude = missing: must be one of displacement (m), velocity (m/s) and acceleration "
            "(m/s^2)");
  EXPECT_EQ(complaint(dwells + "{from: 4, to: 5, displacement: 1, velocity: 1}]}"),
            "signal.bands[0].amplitude = given twice: must be one of displacement (m), velocity (m/s) and acceleration "
            "(m/s^2)");
  EXPECT_EQ(complaint("{sample_rate: 2000, " + dwells +
                      "{from: 4, to: 5, displacement: 1}, {to: 1500, velocity: -1, form: 4}]}}"),
            "4 faults\n"
            "  signal.bands[1].\"form\" is unknown: did you mean from?\n"
            "  signal.bands[1].from is missing: must be a number > 0 and < 1000, half the sample rate (Hz)\n"
            "  signal.bands[1].to = 1500: must be a number > 0 and < 1000, half the sample rate (Hz)\n"
            "  signal.bands[1].velocity = -1: must be a finite number >= 0 (m/s)");
  EXPECT_EQ(complaint("signal: {type: sine_dwells, bands: [{from: 4, to: 5, displacement: 1}]}"),
            "signal.dwell is missing: must be a finite number > 0 (s)");
  EXPECT_EQ(complaint(banded_sweep + "{from: 2, to: 13, displacement: 1e-3}, {from: 14, to: 100, acceleration: 7}]}"),
            "signal.bands[1].from = 14: must be 13, where the band before it ends (Hz)");
  EXPECT_EQ(complaint(banded_sweep + "{from: 2, to: 13, displacement: 1e-3}], direction: left, sweeps: 0}"),
            "2 faults\n"
            "  signal.direction = \"left\": must be up or down\n"
            "  signal.sweeps = 0: must be a whole number from 1 to 1000000");
}

TEST_F(SignalFile, rejectsABadSpectrum)
{
  EXPECT_EQ(complaint(random_noise + "{frequency: 5, density: 0.1}]}"),
            "signal.spectrum is a list: must be a list of at least 2 break points");
  EXPECT_EQ(complaint(random_noise + "{frequency: 5, density: 0}, {frequency: 4}], seed: -1}"),
            "4 faults\n"
            "  signal.seed = -1: must be a whole number >= 0\n"
            "  signal.spectrum[0].density = 0: must be a finite number > 0 ((m/s^2)^2/Hz)\n"
            "  signal.spectrum[1].frequency = 4: must be above 5, that of the break point before it (Hz)\n"
            "  signal.spectrum[1].density is missing: must be a finite number > 0 ((m/s^2)^2/Hz)");
}

TEST_F(SignalFile, rejectsABadShock)
{
  EXPECT_EQ(complaint("signal: {type: shock}"),
            "3 faults\n"
            "  signal.shape is missing: must be half_sine or terminal_peak_sawtooth\n"
            "  signal.peak is missing: must be a finite number other than 0 (m/s^2)\n"
            "  signal.duration = nan: must be a finite number of at least 0.0002, ten samples (s)");
  EXPECT_EQ(complaint(shock + ", repetitions: 3, interval: 0.01}"),
            "signal.interval = 0.01: must be a finite number > 0.011, the duration of a pulse (s)");
}

TEST_F(SignalFile, rejectsBadRecordings)
{
  EXPECT_EQ(complaint("signal: {type: table}"),
            "signal.file is missing: must be a table with the columns time (s) and acceleration (m/s^2)");
  EXPECT_EQ(complaint("signal: {type: table, file: absent.csv}"),
            directory_.path() + "/absent.csv: cannot be read: No such file or directory");
  EXPECT_EQ(complaint("signal: {type: bag, files: [absent.bag], topic: /a}"),
            directory_.path() + "/absent.bag: no such file");
  EXPECT_EQ(complaint("signal: {type: bag, files: absent.bag, input: sound, max_bridged_gap: -1}"),
            "5 faults\n"
            "  signal.files = \"absent.bag\": must be a list of texts\n"
            "  signal.files = \"absent.bag\": must be a list of the bags of one recording\n"
            "  signal.topic is missing: must be the name of a topic in the recording\n"
            "  signal.input = \"sound\": must be block, accel or imu\n"
            "  signal.max_bridged_gap = -1: must be a number >= 0 and <= 60 (s)");
  directory_.file("measured.csv", "time,acceleration\n1,0.5\n1.004,-2\n");
  EXPECT_EQ(complaint("{sample_rate: 250, signal: {type: table, file: measured.csv, topic: /a}}"),
            "2 faults\n"
            "  sample_rate = 250: must be left out where the signal is a recorded one, which has its own\n"
            "  signal.\"topic\" is unknown: must be one of type, file");

  // Without a folder that it could be relative to.
  XmlRpc::XmlRpcValue tree;
  tree["signal"]["type"] = "table";
  tree["signal"]["file"] = "measured.csv";
  try
  {
    parseShakerParameters(tree, "/shaker");
    ADD_FAILURE();
  }
  catch (const config::Error& error)
  {
    EXPECT_STREQ(error.what(),
                 "/shaker: signal.file = \"measured.csv\": must be an absolute path, since signal_directory is not "
                 "given");
  }
}

TEST_F(SignalFile, mustBeAMapOfParameters)
{
  EXPECT_EQ(complaint("[1, 2]"), "must be a map of parameters");
  EXPECT_THAT(complaint("signal: {type: ["), HasSubstr("line 1"));
  EXPECT_EQ(complaint("signal: 5"), "signal = 5: must be a map");
  EXPECT_THROW(loadShakerParameters(directory_.path() + "/absent.yaml"), config::Error);
  EXPECT_THROW(loadShakerParameters(directory_.path()), config::Error);
}

TEST_F(SignalFile, takesValuesAsTheParameterServerDoes)
{
  const XmlRpc::XmlRpcValue tree = readParameterFile(directory_.file(
      "all.yaml", "{a: 1, b: 1.5, c: 1e3, d: \"1.5\", e: true, f: word, g: [1, x], h: {}, i: 1.0e+12}"));
  EXPECT_EQ(tree["a"].getType(), XmlRpc::XmlRpcValue::TypeInt);
  EXPECT_EQ(tree["b"].getType(), XmlRpc::XmlRpcValue::TypeDouble);
  EXPECT_EQ(tree["d"].getType(), XmlRpc::XmlRpcValue::TypeString);
  EXPECT_EQ(tree["e"].getType(), XmlRpc::XmlRpcValue::TypeBoolean);
  EXPECT_EQ(tree["f"].getType(), XmlRpc::XmlRpcValue::TypeString);
  EXPECT_EQ(tree["g"].size(), 2);
  EXPECT_EQ(tree["h"].getType(), XmlRpc::XmlRpcValue::TypeStruct);
  EXPECT_EQ(static_cast<const double&>(tree["i"]), 1.0e12);
}

TEST(Profiles, areAllFitToBePlayed)
{
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(CONFIG_DIRECTORY "/excitation"))
  {
    if (entry.path().extension() != ".yaml")
    {
      continue;
    }
    names.insert(entry.path().stem());
    const ShakerParameters parameters = loadShakerParameters(entry.path());
    const auto signal = core::makeDriveSignal(parameters.signal, parameters.sample_rate);
    double first = 1.0;
    signal->generate(0, 1, &first);
    EXPECT_EQ(first, 0.0) << entry.path();
    EXPECT_NE(describeSignal(parameters), "");
  }
  EXPECT_EQ(names, (std::set<std::string>{"half_sine_shock", "iec_60068_2_64_random", "iec_60068_2_6_sweep",
                                          "iec_60945_sweep", "mil_std_167_endurance", "mil_std_167_exploratory",
                                          "mil_std_167_variable_frequency", "terminal_peak_shock"}));
  loadShakerParameters(CONFIG_DIRECTORY "/sweep.yaml");
}

// What the standards say, beside what the files do.
TEST(Profiles, haveTheNumbersOfMilStd167)
{
  constexpr double inch = 0.0254;
  const auto dwellsOf = [](const std::string& name)
  {
    const std::string path = CONFIG_DIRECTORY "/excitation/mil_std_167_" + name + ".yaml";
    return core::sineDwells(std::get<core::SineDwellParameters>(loadShakerParameters(path).signal));
  };
  const auto displacementOf = [](const core::SineDwell& dwell)
  {
    return dwell.acceleration / core::accelerationAmplitude({core::MotionQuantity::displacement, 1.0}, dwell.frequency);
  };

  const std::vector<core::SineDwell> exploratory = dwellsOf("exploratory");
  const std::vector<core::SineDwell> variable = dwellsOf("variable_frequency");
  ASSERT_EQ(exploratory.size(), 30u);
  ASSERT_EQ(variable.size(), 30u);
  for (std::size_t i = 0; i < 30; ++i)
  {
    const double frequency = 4.0 + static_cast<double>(i);
    EXPECT_EQ(exploratory[i].frequency, frequency);
    EXPECT_NEAR(displacementOf(exploratory[i]), 0.010 * inch, 1.0e-12);
    EXPECT_EQ(exploratory[i].cycles, 15.0 * frequency);
    EXPECT_EQ(variable[i].frequency, frequency);
    EXPECT_NEAR(displacementOf(variable[i]),
                (frequency < 15.5   ? 0.030
                 : frequency < 25.5 ? 0.020
                                    : 0.010) *
                    inch,
                1.0e-12);
    EXPECT_EQ(variable[i].cycles, 300.0 * frequency);
  }
  const std::vector<core::SineDwell> endurance = dwellsOf("endurance");
  ASSERT_EQ(endurance.size(), 1u);
  EXPECT_EQ(endurance[0].frequency, 33.0);
  EXPECT_NEAR(displacementOf(endurance[0]), 0.010 * inch, 1.0e-12);
  EXPECT_EQ(endurance[0].cycles, 7200.0 * 33.0);
}

TEST(Profiles, haveTheNumbersOfIec60945)
{
  const auto sweep = std::get<core::BandedSweepParameters>(
      loadShakerParameters(CONFIG_DIRECTORY "/excitation/iec_60945_sweep.yaml").signal);
  ASSERT_EQ(sweep.bands.size(), 2u);
  EXPECT_EQ(sweep.bands[0].from, 2.0);
  EXPECT_EQ(sweep.bands[0].to, 13.2);
  EXPECT_EQ(sweep.bands[1].to, 100.0);
  EXPECT_NEAR(core::accelerationAmplitude(sweep.bands, 5.0), std::pow(2.0 * M_PI * 5.0, 2) * 1.0e-3, 1.0e-12);
  EXPECT_EQ(core::accelerationAmplitude(sweep.bands, 50.0), 7.0);
  EXPECT_EQ(sweep.rate, 0.5);
}

}  // namespace
}  // namespace vibro_impact::graph
