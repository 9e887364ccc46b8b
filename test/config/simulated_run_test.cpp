#include "vibro_impact/config/simulated_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "../core/common.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/simulation.h"

namespace vibro_impact::config
{
namespace
{
using core::two_pi;

core::SystemParameters shipped(const std::string& name)
{
  return loadFile(std::string(CONFIG_DIRECTORY) + "/" + name);
}

std::shared_ptr<const core::SwitchedModel> model(const core::SystemParameters& parameters)
{
  return std::make_shared<const core::SwitchedModel>(parameters);
}

std::shared_ptr<const core::SwitchedModel> limitingCase()
{
  core::SystemParameters parameters = shipped("limiting_case.yaml");
  parameters.basis = core::AttachmentBasis{5};
  return model(parameters);
}

void ignore(double /*share*/)
{
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

/// A table as columns of numbers.
std::map<std::string, std::vector<double>> columns(const OutputFile& file)
{
  std::map<std::string, std::vector<double>> table;
  const std::vector<std::string> lines = split(file.text, '\n');
  const std::vector<std::string> names = split(lines.at(0), ',');
  for (std::size_t line = 1; line < lines.size(); ++line)
  {
    const std::vector<std::string> cells = split(lines[line], ',');
    for (std::size_t i = 0; i < names.size(); ++i)
    {
      table[names[i]].push_back(parseNumber(cells.at(i)).value());
    }
  }
  return table;
}

/// The value of a key of run.csv; nothing if it has none.
std::optional<double> value(const SimulatedRun& run, const std::string& key)
{
  const std::string text = runTables(run).at(2).text;
  const std::size_t at = text.find("\n" + key + ",");
  return at == std::string::npos
             ? std::nullopt
             : parseNumber(text.substr(at + key.size() + 2, text.find('\n', at + 1) - at - key.size() - 2));
}

SampledExcitation sine(double frequency_hz, double amplitude, std::size_t samples)
{
  SampledExcitation excitation;
  excitation.sample_period = 2.0e-5;
  for (std::size_t i = 0; i < samples; ++i)
  {
    excitation.acceleration.push_back(amplitude * std::sin(two_pi * frequency_hz * 2.0e-5 * static_cast<double>(i)));
  }
  return excitation;
}

TEST(SimulateHarmonic, HasTheImpactsOfTheCore)
{
  const auto beams = limitingCase();
  HarmonicRunOptions options;
  options.omega_star = 1.6;
  options.acceleration = 10.0;
  options.cycles = 150;
  options.samples_per_cycle = 10;
  const SimulatedRun run = simulateHarmonic(beams, options, std::nullopt, {}, ignore);

  core::HarmonicSimulation simulation(beams);
  const double frequency = 1.6 * beams->scales().frequency;
  simulation.setDrive(frequency, 10.0);
  core::Recorder recorder;
  simulation.advance(150, recorder);
  simulation.finish(recorder);
  ASSERT_EQ(run.impacts.size(), recorder.impacts.size());
  ASSERT_GT(run.impacts.size(), 140u);
  for (std::size_t i = 0; i < recorder.impacts.size(); ++i)
  {
    const core::Impact& expected = recorder.impacts[i];
    EXPECT_EQ(run.impacts[i].number, expected.number);
    EXPECT_EQ(run.impacts[i].omega_star, 1.6);
    EXPECT_EQ(run.impacts[i].onset_s, static_cast<double>(expected.interval) * (two_pi / frequency) + expected.offset);
    EXPECT_EQ(run.impacts[i].impulse, expected.impulse);
    EXPECT_EQ(run.impacts[i].energy_lost, expected.energy_lost);
  }
  EXPECT_EQ(run.period, 1);
  EXPECT_EQ(value(run, "period"), 1.0);
}

TEST(SimulateHarmonic, ListsAnEpisodeThatIsOpenAtTheEndAsCutShort)
{
  // Pressed together: one episode from the start of the run to its end.
  core::SystemParameters parameters = shipped("interference_fit.yaml");
  const auto pressed = model(parameters);
  HarmonicRunOptions options;
  options.omega_star = 0.5;
  options.acceleration = 1.0e-3;
  options.cycles = 20;
  const SimulatedRun whole = simulateHarmonic(pressed, options, std::nullopt, {}, ignore);
  const double cycle = two_pi / (0.5 * pressed->scales().frequency);
  ASSERT_EQ(whole.impacts.size(), 1u);
  EXPECT_TRUE(whole.impacts[0].cut_short);
  EXPECT_EQ(whole.impacts[0].onset_s, 0.0);
  EXPECT_NEAR(whole.impacts[0].duration_s, 20.0 * cycle, 1e-9 * cycle);
  EXPECT_EQ(whole.period, 1);

  // The last of several, at whatever frequency and after as many cycles as there is one.
  options.acceleration = 10.0;
  const auto beams = limitingCase();
  int open = 0;
  for (const double omega_star : {0.5, 0.8, 1.2, 1.6, 2.0, 2.8})
  {
    options.omega_star = omega_star;
    for (options.cycles = 1; options.cycles <= 5; ++options.cycles)
    {
      const SimulatedRun run = simulateHarmonic(beams, options, std::nullopt, {}, ignore);
      const HistoryRow& end = run.history.back();
      ASSERT_EQ(run.impacts.back().cut_short, end.in_contact) << omega_star << ", " << options.cycles;
      if (end.in_contact)
      {
        ++open;
        EXPECT_NEAR(run.impacts.back().onset_s + run.impacts.back().duration_s, end.time, 1e-9 * end.time);
        EXPECT_EQ(run.impacts.back().separation_speed, 0.0);
      }
    }
  }
  EXPECT_GT(open, 3);
}

TEST(SimulateHarmonic, HasAHistoryOfTheWholeRun)
{
  const auto beams = limitingCase();
  HarmonicRunOptions options;
  options.omega_star = 1.6;
  options.cycles = 30;
  options.samples_per_cycle = 40;
  const SimulatedRun run = simulateHarmonic(beams, options, std::nullopt, {}, ignore);
  const double cycle = two_pi / (1.6 * beams->scales().frequency);
  ASSERT_EQ(run.history.size(), 30u * 40u + 1u);
  EXPECT_NEAR(run.step, cycle / 40.0, 1e-15);
  for (std::size_t i = 0; i < run.history.size(); ++i)
  {
    const HistoryRow& row = run.history[i];
    EXPECT_NEAR(row.time, static_cast<double>(i) * cycle / 40.0, 1e-12);
    EXPECT_NEAR(row.acceleration, -std::cos(two_pi * static_cast<double>(i) / 40.0), 1e-9);
    EXPECT_EQ(row.force > 0.0, row.in_contact && row.gap < 0.0) << i;
    EXPECT_NEAR(row.force, row.in_contact ? -beams->stiffness() * row.gap : 0.0, 1e-12) << i;
  }
  EXPECT_EQ(value(run, "omega_star"), 1.6);
  EXPECT_NEAR(*value(run, "drive_frequency_hz"), 1.0 / cycle, 1e-9);
  EXPECT_EQ(value(run, "acceleration"), 1.0);
  EXPECT_EQ(value(run, "history_step_s"), run.step);
}

TEST(SimulateHarmonic, BeginsInTheGivenMotion)
{
  // Without damping and far from the surface a mode thrown alone is a sine of its own frequency.
  core::SystemParameters parameters = shipped("rigid_surface.yaml");
  parameters.basis = core::AttachmentBasis{3};
  parameters.damping = {};
  parameters.contact.clearance = 1.0;
  const auto beam = model(parameters);
  const double frequency = beam->scales().frequency;
  const double mass = 954.0 * 0.0529 * 0.00127 * 0.0127;  // rho L h b
  const double shape = std::sqrt(2.0 / mass);             // phi_1 at midspan
  core::InitialMotion motion;
  motion.structure1.displacement = {2.0e-6};
  motion.structure1.velocity = {3.0e-3};
  HarmonicRunOptions options;
  options.omega_star = 0.5;
  options.acceleration = 0.0;
  options.cycles = 3;
  const SimulatedRun run = simulateHarmonic(beam, options, motion, {}, ignore);
  for (const HistoryRow& row : run.history)
  {
    const double phase = frequency * row.time;
    const double expected = shape * (2.0e-6 * std::cos(phase) + 3.0e-3 / frequency * std::sin(phase));
    EXPECT_NEAR(row.gap - 1.0, expected, 1e-12);
    const double velocity = shape * (3.0e-3 * std::cos(phase) - 2.0e-6 * frequency * std::sin(phase));
    EXPECT_NEAR(row.gap_velocity, velocity, 1e-8);
  }
}

TEST(SimulateHarmonic, ClosesItsEnergyAccount)
{
  core::InitialMotion motion;
  motion.structure1.velocity = {0.01};
  HarmonicRunOptions options;
  options.omega_star = 1.6;
  options.samples_per_cycle = 20;
  const SimulatedRun run = simulateHarmonic(limitingCase(), options, motion, {}, ignore);
  EXPECT_NEAR(run.energy.initial, 0.5e-4, 1e-15);
  EXPECT_GT(run.energy.dissipated_free, 0.0);
  EXPECT_GT(run.energy.dissipated_contact, 0.0);
  EXPECT_LT(run.energy.closure(), 1e-9);
  for (const HistoryRow& row : run.history)
  {
    EXPECT_LT(std::abs(row.energy_residual), 1e-9 * run.energy.turnover);
    // The columns are the whole account.
    const double stored = row.energy_structure1 + row.energy_structure2 + row.energy_spring + row.energy_left_out;
    const double lost = row.dissipated_free + row.dissipated_contact + row.mapping_loss;
    EXPECT_NEAR(run.energy.initial + row.base_work + row.contact_work - lost - stored, row.energy_residual,
                1e-15 * run.energy.turnover);
  }
  const HistoryRow& last = run.history.back();
  EXPECT_EQ(last.base_work, run.energy.work);
  EXPECT_EQ(value(run, "energy_initial"), run.energy.initial);
  EXPECT_EQ(value(run, "base_work"), run.energy.work);
  EXPECT_EQ(value(run, "energy_closure"), run.energy.closure());
}

TEST(SimulateHarmonic, RefusesAMotionThatTheStructureDoesNotHave)
{
  core::InitialMotion motion;
  motion.structure2.velocity = {1.0};
  EXPECT_THROW(simulateHarmonic(model(shipped("rigid_surface.yaml")), {}, motion, {}, ignore), std::invalid_argument);
}

TEST(SimulateSampled, IsBitForBitWhatASimulationOfBlocksGives)
{
  const auto beams = limitingCase();
  const SampledExcitation excitation = sine(434.3, 10.0, 5000);
  const SimulatedRun run = simulateSampled(beams, excitation, std::nullopt, {}, ignore);

  core::SampledSimulation simulation(beams, excitation.sample_period);
  std::vector<double> gap(5000);
  std::vector<double> force(5000);
  core::Recorder recorder;
  simulation.advance(excitation.acceleration.data(), 5000, gap.data(), force.data(), recorder);
  simulation.finish(recorder);
  ASSERT_EQ(run.history.size(), 5000u);
  for (std::size_t i = 0; i < 5000; ++i)
  {
    EXPECT_EQ(run.history[i].gap, gap[i]);
    EXPECT_EQ(run.history[i].force, force[i]);
    EXPECT_EQ(run.history[i].acceleration, excitation.acceleration[i]);
    EXPECT_EQ(run.history[i].time, static_cast<double>(i) * 2.0e-5);
  }
  ASSERT_EQ(run.impacts.size(), recorder.impacts.size());
  ASSERT_GT(run.impacts.size(), 30u);
  for (std::size_t i = 0; i < recorder.impacts.size(); ++i)
  {
    EXPECT_EQ(run.impacts[i].onset_s,
              static_cast<double>(recorder.impacts[i].interval) * 2.0e-5 + recorder.impacts[i].offset);
    EXPECT_EQ(run.impacts[i].impulse, recorder.impacts[i].impulse);
    EXPECT_EQ(run.impacts[i].cut_short, recorder.impacts[i].cut_short);
  }
  EXPECT_LT(run.energy.closure(), 1e-9);
  EXPECT_FALSE(value(run, "omega_star"));
}

TEST(SimulateSampled, KeepsTheTimeOfTheTable)
{
  SampledExcitation excitation = sine(434.3, 10.0, 1000);
  excitation.start = -0.5;
  const SimulatedRun run = simulateSampled(limitingCase(), excitation, std::nullopt, {}, ignore);
  EXPECT_EQ(run.history.front().time, -0.5);
  EXPECT_NEAR(run.history.back().time, -0.5 + 999 * 2.0e-5, 1e-12);
  ASSERT_GT(run.impacts.size(), 2u);
  EXPECT_LT(run.impacts.front().onset_s, -0.49);
}

TEST(SimulateSampled, ChoosesTheRowsOfTheHistory)
{
  HistorySelection selection;
  selection.from = 0.01;
  selection.every = 10;
  double done = 0.0;
  const SimulatedRun run = simulateSampled(limitingCase(), sine(434.3, 10.0, 1000), std::nullopt, selection,
                                           [&](double share) { done = share; });
  ASSERT_EQ(run.history.size(), 50u);
  EXPECT_NEAR(run.history.front().time, 0.01, 1e-12);
  EXPECT_NEAR(run.history[1].time - run.history[0].time, 2.0e-4, 1e-12);
  EXPECT_EQ(run.step, 2.0e-4);
  EXPECT_EQ(run.impacts.front().number, 0u);  // impacts are never left out
  EXPECT_EQ(done, 1.0);

  selection.longest = 49;
  EXPECT_THROW(simulateSampled(limitingCase(), sine(434.3, 10.0, 1000), std::nullopt, selection, ignore), Error);
}

TEST(RunTables, ReadBackToTheSameBits)
{
  HarmonicRunOptions options;
  options.omega_star = 2.4;
  options.cycles = 20;
  const SimulatedRun run = simulateHarmonic(limitingCase(), options, std::nullopt, {}, ignore);
  const std::vector<OutputFile> files = runTables(run);
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0].name, "history.csv");
  EXPECT_EQ(files[1].name, "impacts.csv");
  EXPECT_EQ(files[2].name, "run.csv");
  const auto history = columns(files[0]);
  ASSERT_EQ(history.size(), 16u);
  for (std::size_t i = 0; i < run.history.size(); ++i)
  {
    EXPECT_EQ(history.at("time")[i], run.history[i].time);
    EXPECT_EQ(history.at("gap")[i], run.history[i].gap);
    EXPECT_EQ(history.at("gap_velocity")[i], run.history[i].gap_velocity);
    EXPECT_EQ(history.at("energy_structure1")[i], run.history[i].energy_structure1);
    EXPECT_EQ(history.at("energy_residual")[i], run.history[i].energy_residual);
    EXPECT_EQ(history.at("in_contact")[i], run.history[i].in_contact ? 1.0 : 0.0);
  }
  const auto impacts = columns(files[1]);
  ASSERT_EQ(impacts.size(), 13u);
  ASSERT_FALSE(run.impacts.empty());
  for (std::size_t i = 0; i < run.impacts.size(); ++i)
  {
    EXPECT_EQ(impacts.at("onset_s")[i], run.impacts[i].onset_s);
    EXPECT_EQ(impacts.at("impulse")[i], run.impacts[i].impulse);
    EXPECT_EQ(impacts.at("energy_lost")[i], run.impacts[i].energy_lost);
    EXPECT_EQ(impacts.at("base_work")[i], run.impacts[i].base_work);
  }
}

}  // namespace
}  // namespace vibro_impact::config
