// How many modes the response of a configuration needs.

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "command_line.h"
#include "progress_line.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/convergence.h"
#include "vibro_impact/config/output_directory.h"

namespace
{
using namespace vibro_impact;

struct Arguments
{
  std::string configuration;
  std::optional<std::string> out;
  config::ConvergenceOptions convergence;
};

tools::Options options()
{
  using tools::text;
  tools::Options result("Options", 100);
  auto add = result.add_options();
  add("at", boost::program_options::value<std::vector<std::string>>()->multitoken()->value_name("OMEGA_STAR..."),
      "drive frequencies, in lowest natural frequencies of beam 1");
  add("accuracy", text("r")->default_value("0.001"),
      "wanted: of impulses relative to the greatest one, of onsets in drive cycles");
  add("acceleration", text("a")->default_value("1"), "amplitude of the base acceleration, m/s^2");
  add("cycles", text("C")->default_value("400"), "drive cycles from rest; the second half of them is evaluated");
  add("statistics-cycles", text("C")->default_value("10000"), "further ones where the response has no period");
  add("most-modes", text("n")->default_value("100"), "of the largest basis to try");
  add("threads", text("n"), "frequencies worked on side by side; all cores by default");
  add("out", text("DIR"), "directory for convergence.csv; created if missing. Without it nothing is written");
  return result;
}

Arguments interpret(const tools::Given& given)
{
  Arguments arguments;
  arguments.configuration = tools::onlyFile(given, "configuration", "configuration file");
  if (given.count("at") == 0)
  {
    throw tools::UsageError("--at is missing");
  }
  config::ConvergenceOptions& convergence = arguments.convergence;
  for (const std::string& text : given["at"].as<std::vector<std::string>>())
  {
    convergence.omega_stars.push_back(tools::number("--at", text, 1.0e-3, 1.0e5));
  }
  convergence.accuracy = tools::number(given, "accuracy", 1.0e-9, 1.0);
  convergence.acceleration = tools::number(given, "acceleration", 1.0e-9, 1.0e9);
  convergence.cycles = static_cast<std::uint64_t>(tools::wholeNumber(given, "cycles", 10, 1'000'000'000));
  convergence.statistics_cycles =
      static_cast<std::uint64_t>(tools::wholeNumber(given, "statistics-cycles", 100, 1'000'000'000));
  convergence.most_modes = static_cast<int>(tools::wholeNumber(given, "most-modes", 1, 100));
  convergence.threads = given.count("threads") != 0
                            ? static_cast<unsigned>(tools::wholeNumber(given, "threads", 1, 1024))
                            : std::max(1u, std::thread::hardware_concurrency());
  if (given.count("out") != 0)
  {
    arguments.out = given["out"].as<std::string>();
  }
  return arguments;
}

std::vector<config::Convergence> compute(const core::SystemParameters& parameters,
                                         const config::ConvergenceOptions& options)
{
  tools::ProgressLine line;
  const std::size_t frequencies = options.omega_stars.size();
  return config::converge(parameters, options,
                          [&](const config::ConvergenceProgress& progress)
                          {
                            if (line.due(progress.frequencies == frequencies))
                            {
                              line.show(std::to_string(progress.runs) + " bases computed, " +
                                        std::to_string(progress.frequencies) + " of " + std::to_string(frequencies) +
                                        " frequencies done");
                            }
                          });
}

void run(const Arguments& arguments)
{
  const core::SystemParameters parameters = config::loadFile(arguments.configuration);
  std::optional<config::OutputDirectory> out;
  if (arguments.out)
  {
    out.emplace(*arguments.out);
  }
  const config::ConvergenceOptions& convergence = arguments.convergence;
  const auto results = compute(parameters, convergence);
  if (out)
  {
    out->write({config::convergenceTable(results)});
  }
  std::cout << config::convergenceReport(parameters, convergence, results);
  if (out)
  {
    std::cout << "written to " << out->path() << ": convergence.csv\n";
  }
  std::cout << std::flush;
}

}  // namespace

int main(int argc, char** argv)
{
  return tools::runTool(
      {"converge",
       "converge CONFIG --at OMEGA_STAR... [options]\n\n"
       "Raises the number of modes of the configuration in the file CONFIG until the impulses and the times of the\n"
       "impacts settle, and recommends the smallest basis that is accurate enough. Each run starts from rest.\n\n"
       "The table has a line for each basis; '<' marks the smallest that agrees with every larger one. 'its change' "
       "is\n"
       "the greatest difference of an impact's impulse from that in any larger basis, over the greatest impulse;\n"
       "'onset change' the same of the times, in drive cycles; both only where the periods are equal. An impact that "
       "the\n"
       "other response does not have counts with its whole impulse. 'us/cycle' is measured processor time.\n"
       "Where the response has no period, statistics of the impacts are compared: 'part by' is the factor by which\n"
       "neighbouring motions part every drive cycle, if they do; 'apart' the greatest difference from any larger "
       "basis,\n"
       "in standard errors of it. Up to 4 is taken for chance.",
       options(), "configuration"},
      argc, argv, [](const tools::Given& given) { run(interpret(given)); });
}
