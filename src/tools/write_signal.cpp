// The samples of a shaker's signal as a table.

#include <iostream>
#include <limits>
#include <string>

#include <console_bridge/console.h>

#include "command_line.h"
#include "vibro_impact/config/output_directory.h"
#include "vibro_impact/ros/parameter_file.h"
#include "vibro_impact/ros/signal_table.h"

namespace
{
using namespace vibro_impact;

tools::Options options()
{
  using tools::text;
  tools::Options result("Options", 100);
  auto add = result.add_options();
  add("from", text("s"), "time of the first sample; default: the start");
  add("to", text("s"), "time of the last one; default: the end");
  add("out", text("DIR"), "directory for signal.csv; created if missing; without it nothing is written");
  return result;
}

double timeOr(const tools::Given& given, const std::string& option, double otherwise)
{
  return given.count(option) != 0 ? tools::number(given, option, 0.0, 1.0e12) : otherwise;
}

void run(const tools::Given& given)
{
  const std::string file = tools::onlyFile(given, "signal", "signal file");
  const double from = timeOr(given, "from", 0.0);
  const double to = timeOr(given, "to", std::numeric_limits<double>::infinity());
  if (from > to)
  {
    throw tools::UsageError("--from must not be later than --to");
  }
  if (given.count("out") == 0 && (given.count("from") != 0 || given.count("to") != 0))
  {
    throw tools::UsageError("--from and --to are for --out");
  }
  const graph::ShakerParameters parameters = graph::loadShakerParameters(file);
  if (given.count("out") != 0)
  {
    const config::OutputDirectory out(given["out"].as<std::string>());
    out.write({{"signal.csv", graph::signalTable(parameters, from, to)}});
  }
  std::cout << graph::describeSignal(parameters) << std::endl;
}

}  // namespace

int main(int argc, char** argv)
{
  // What a library has to say of a damaged bag besides is in no message that a user understands.
  console_bridge::noOutputHandler();
  return tools::runTool(
      {"write_signal",
       "Usage: write_signal SIGNAL [--out DIR] [--from s] [--to s]\n\n"
       "Says what a signal file of the shaker plays, and writes its samples to signal.csv (time in s, acceleration in\n"
       "m/s^2), as simulate --excitation reads it.",
       options(), "signal"},
      argc, argv, run);
}
