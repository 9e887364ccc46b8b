// One run of a configuration, offline.

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <console_bridge/console.h>

#include "command_line.h"
#include "progress_line.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/output_directory.h"
#include "vibro_impact/config/sampled_excitation.h"
#include "vibro_impact/config/simulated_run.h"
#include "vibro_impact/core/switched_model.h"
#include "vibro_impact/ros/parameter_file.h"
#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/recording_simulation.h"
#include "vibro_impact/ros/signal_table.h"

namespace
{
using namespace vibro_impact;

struct Arguments
{
  std::optional<std::string> configuration;
  std::string out;
  bool plot = false;
  // The drive: a harmonic one, or a file of samples, or one with a shaker's signal, or bags.
  std::optional<double> omega_star, frequency_hz;
  config::HarmonicRunOptions harmonic;
  std::string excitation;
  std::string signal;
  std::vector<std::string> bags;
  std::string name_space;
  std::optional<core::InitialMotion> initial;
  config::HistorySelection history;
};

tools::Options options()
{
  using tools::text;
  tools::Options result("Options", 100);
  auto add = result.add_options();
  add("omega-star", text("W"), "harmonic drive: its frequency in lowest natural frequencies of beam 1");
  add("frequency", text("Hz"), "harmonic drive: its frequency");
  add("acceleration", text("a"), "amplitude of the harmonic drive, m/s^2; default 1");
  add("cycles", text("C"), "cycles of the harmonic drive; default 100");
  add("samples-per-cycle", text("n"), "rows of the history per cycle of the harmonic drive; default 200");
  add("excitation", text("CSV"), "drive by samples: a table with the columns time (s) and acceleration (m/s^2)");
  add("signal", text("YAML"), "drive by a shaker's signal: a file such as shaker.launch takes");
  add("bag", boost::program_options::value<std::vector<std::string>>()->multitoken()->value_name("BAG..."),
      "drive by the recorded base_excitation: one bag, or all of a split one");
  add("namespace", text("NS"), "the run to take from a recording of several, such as /rig1");
  add("every", text("n"), "of a drive by samples only each so-manieth becomes a row of the history; default 1");
  add("displacement1", text("LIST"), "initial displacement of the modes of structure 1, m kg^1/2: 1e-4,0,2e-5");
  add("velocity1", text("LIST"), "their initial velocity, m/s kg^1/2");
  add("displacement2", text("LIST"), "the same of structure 2");
  add("velocity2", text("LIST"), "the same of structure 2");
  add("history-from", text("s"), "time at which the history begins; default: that of the run");
  add("plot", "draw simulation.png and simulation.svg, too");
  add("out", text("DIR"), "directory for history.csv, impacts.csv and run.csv; created if missing");
  return result;
}

void allowOnlyWith(const tools::Given& given, const std::vector<std::string>& options, bool allowed,
                   const std::string& drive)
{
  for (const std::string& option : options)
  {
    if (given.count(option) != 0 && !allowed)
    {
      throw tools::UsageError("--" + option + " is for a " + drive);
    }
  }
}

std::vector<double> numbers(const tools::Given& given, const std::string& option)
{
  std::vector<double> values;
  if (given.count(option) != 0)
  {
    const std::string list = given[option].as<std::string>();
    std::size_t begin = 0;
    for (std::size_t end = 0; end != std::string::npos; begin = end + 1)
    {
      end = list.find(',', begin);
      const std::string item = list.substr(begin, end == std::string::npos ? end : end - begin);
      values.push_back(tools::number("--" + option, item, -1.0e9, 1.0e9));
    }
  }
  return values;
}

std::optional<core::InitialMotion> initialMotion(const tools::Given& given)
{
  core::InitialMotion motion;
  motion.structure1.displacement = numbers(given, "displacement1");
  motion.structure1.velocity = numbers(given, "velocity1");
  motion.structure2.displacement = numbers(given, "displacement2");
  motion.structure2.velocity = numbers(given, "velocity2");
  const auto given_of = [](const core::InitialMotion::OfStructure& structure)
  { return !structure.displacement.empty() || !structure.velocity.empty(); };
  return given_of(motion.structure1) || given_of(motion.structure2) ? std::optional<core::InitialMotion>(motion)
                                                                    : std::nullopt;
}

std::uint64_t count(const tools::Given& given, const std::string& option, std::uint64_t otherwise,
                    std::int64_t greatest)
{
  return given.count(option) != 0 ? static_cast<std::uint64_t>(tools::wholeNumber(given, option, 1, greatest))
                                  : otherwise;
}

Arguments interpret(const tools::Given& given)
{
  const std::size_t drives = given.count("omega-star") + given.count("frequency") + given.count("excitation") +
                             given.count("signal") + given.count("bag");
  if (drives != 1)
  {
    throw tools::UsageError(
        std::to_string(drives) +
        " drives are given: must be one of --omega-star, --frequency, --excitation, --signal, --bag");
  }
  const bool bag = given.count("bag") != 0;
  const bool samples = bag || given.count("excitation") != 0 || given.count("signal") != 0;
  allowOnlyWith(given, {"acceleration", "cycles", "samples-per-cycle"}, !samples, "harmonic drive");
  allowOnlyWith(given, {"every"}, samples, "drive by samples");
  allowOnlyWith(given, {"namespace"}, bag, "bag");
  allowOnlyWith(given, {"displacement1", "velocity1", "displacement2", "velocity2"}, !bag,
                "harmonic drive, --excitation or --signal; a recorded stream finds the structures at rest");
  if (given.count("out") == 0)
  {
    throw tools::UsageError("--out is missing");
  }

  Arguments arguments;
  if (!bag || !given["configuration"].empty())
  {
    arguments.configuration = tools::onlyFile(given, "configuration", "configuration file");
  }
  arguments.out = given["out"].as<std::string>();
  arguments.plot = given.count("plot") != 0;
  if (given.count("omega-star") != 0)
  {
    arguments.omega_star = tools::number(given, "omega-star", 1.0e-3, 1.0e5);
  }
  if (given.count("frequency") != 0)
  {
    arguments.frequency_hz = tools::number(given, "frequency", 1.0e-6, 1.0e9);
  }
  arguments.harmonic.acceleration =
      given.count("acceleration") != 0 ? tools::number(given, "acceleration", 0.0, 1.0e9) : 1.0;
  arguments.harmonic.cycles = count(given, "cycles", 100, 1'000'000'000);
  arguments.harmonic.samples_per_cycle = count(given, "samples-per-cycle", 200, 1'000'000);
  if (given.count("excitation") != 0)
  {
    arguments.excitation = given["excitation"].as<std::string>();
  }
  if (given.count("signal") != 0)
  {
    arguments.signal = given["signal"].as<std::string>();
  }
  if (bag)
  {
    arguments.bags = given["bag"].as<std::vector<std::string>>();
  }
  arguments.name_space = given.count("namespace") != 0 ? given["namespace"].as<std::string>() : std::string();
  arguments.initial = initialMotion(given);
  arguments.history.every = count(given, "every", 1, 1'000'000'000);
  if (given.count("history-from") != 0)
  {
    arguments.history.from = tools::number(given, "history-from", -1.0e9, 1.0e9);
  }
  return arguments;
}

/// What tells on `line` how much is done.
config::RunProgress telling(tools::ProgressLine& line)
{
  return [&line](double share)
  {
    if (line.due(false))
    {
      line.show("simulated " + std::to_string(static_cast<int>(100.0 * share)) + " %");
    }
  };
}

/// The script that draws, which is installed beside this program.
std::string plotScript()
{
  std::string script = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "plot_simulation";
  if (access(script.c_str(), X_OK) != 0)
  {
    throw std::runtime_error("--plot: " + script + ": " + std::strerror(errno));
  }
  return script;
}

void draw(const std::string& script, const std::string& folder)
{
  const pid_t child = fork();
  if (child == 0)
  {
    execl(script.c_str(), script.c_str(), folder.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
  {
    throw std::runtime_error(script + " has failed; the tables are in " + folder);
  }
}

config::SimulatedRun simulateBag(const Arguments& arguments, const graph::RecordedRun& recording)
{
  graph::RecordedModel model;
  if (arguments.configuration)
  {
    model.parameters = config::loadFile(*arguments.configuration);
  }
  else
  {
    model = graph::recordedModel(recording);
  }
  tools::ProgressLine line;
  const graph::RecordingSimulation simulation =
      graph::simulateRecording(recording, model, graph::StreamLimits{}, arguments.history, telling(line));
  std::cout << simulation.samples << " samples taken, " << simulation.bridged << " bridged, " << simulation.restarts
            << " restarts from rest, " << simulation.refused << " blocks refused\n";
  if (!simulation.first_irregularity.empty())
  {
    std::cout << "first of these: " << simulation.first_irregularity << "\n";
  }
  return simulation.run;
}

config::SimulatedRun simulate(const Arguments& arguments, const std::optional<config::SampledExcitation>& excitation)
{
  const auto model = std::make_shared<const core::SwitchedModel>(config::loadFile(*arguments.configuration));
  tools::ProgressLine line;
  const config::RunProgress tell = telling(line);
  if (excitation)
  {
    return config::simulateSampled(model, *excitation, arguments.initial, arguments.history, tell);
  }
  config::HarmonicRunOptions harmonic = arguments.harmonic;
  harmonic.omega_star =
      arguments.omega_star ? *arguments.omega_star : config::omegaStar(*arguments.frequency_hz, *model);
  return config::simulateHarmonic(model, harmonic, arguments.initial, arguments.history, tell);
}

void report(const config::SimulatedRun& run, const std::string& out, bool plot)
{
  if (run.omega_star)
  {
    std::cout << "harmonic drive: omega* " << *run.omega_star << " (" << *run.frequency_hz << " Hz), " << *run.amplitude
              << " m/s^2\n";
  }
  const auto cut_short = std::count_if(run.impacts.begin(), run.impacts.end(),
                                       [](const config::SimulatedImpactRow& row) { return row.cut_short; });
  std::cout << run.impacts.size() << " impacts";
  if (!run.impacts.empty())
  {
    double impulse = 0.0;
    double peak = 0.0;
    for (const config::SimulatedImpactRow& row : run.impacts)
    {
      impulse += row.impulse;
      peak = std::max(peak, row.peak_force);
    }
    std::cout << " (" << cut_short << " cut short), mean impulse " << impulse / static_cast<double>(run.impacts.size())
              << " N s, greatest force " << peak << " N";
  }
  if (run.period)
  {
    std::cout << "; period " << (*run.period > 0 ? std::to_string(*run.period) + " cycles" : "none up to 16 cycles");
  }
  const core::EnergyAccount& energy = run.energy;
  std::cout << "\nenergy in J: " << energy.initial << " at the start, " << energy.work << " work of the base, "
            << energy.dissipated_free << " dissipated free and " << energy.dissipated_contact << " in contact, "
            << energy.mapping_loss << " lost by the mapping, " << energy.stored()
            << " stored at the end; the account closes to " << energy.closure() << "\nwritten to " << out
            << ": history.csv (" << run.history.size() << " rows), impacts.csv (" << run.impacts.size()
            << " rows), run.csv" << (plot ? ", simulation.png, simulation.svg" : "") << std::endl;
}

void run(const Arguments& arguments)
{
  const std::string script = arguments.plot ? plotScript() : std::string();
  std::optional<graph::RecordedRun> recording;
  if (!arguments.bags.empty())
  {
    recording.emplace(arguments.bags, arguments.name_space, graph::RecordedContents::excitation);
  }
  std::optional<config::SampledExcitation> excitation;
  if (!arguments.excitation.empty())
  {
    excitation = config::readExcitation(arguments.excitation);
  }
  if (!arguments.signal.empty())
  {
    excitation = graph::sampleSignal(graph::loadShakerParameters(arguments.signal));
  }
  const config::OutputDirectory out(arguments.out);
  const config::SimulatedRun result = recording ? simulateBag(arguments, *recording) : simulate(arguments, excitation);
  out.write(config::runTables(result));
  if (arguments.plot)
  {
    draw(script, arguments.out);
  }
  report(result, arguments.out, arguments.plot);
}

}  // namespace

int main(int argc, char** argv)
{
  // What a library has to say of a damaged bag besides is in no message that a user understands.
  console_bridge::noOutputHandler();
  return tools::runTool(
      {"simulate",
       "simulate CONFIG (--omega-star W | --frequency Hz | --excitation CSV) --out DIR [options]\n"
       "simulate [CONFIG] --bag BAG... --out DIR [options]\n\n"
       "Simulates one run of the configuration in the file CONFIG: under a harmonic drive, a(t) = -A cos(Omega t), "
       "which\n"
       "is exact, or under samples, which are joined by straight lines. A bag is taken by the rules of the simulator "
       "node,\n"
       "and gives the same impacts bit for bit; without CONFIG its own configuration is used. The run starts from "
       "rest,\n"
       "or in the given motion: entry m of a list belongs to mode m of that structure alone, mass-normalised, so that\n"
       "a point where the mode shape is phi (kg^-1/2) is displaced by phi times the entry.\n\n"
       "Writes history.csv (time, base acceleration, gap, force, energies), impacts.csv (an impact a row, with "
       "energies)\n"
       "and run.csv (the drive, the energies at the end).",
       options(), "configuration"},
      argc, argv, [](const tools::Given& given) { run(interpret(given)); });
}
