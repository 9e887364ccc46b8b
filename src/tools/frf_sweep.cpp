// The repetitive impact frequency response of a configuration, straight from the core.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "command_line.h"
#include "progress_line.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/model_summary.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/config/output_directory.h"
#include "vibro_impact/config/response_table.h"
#include "vibro_impact/config/sweep.h"

namespace
{
using namespace vibro_impact;

struct Arguments
{
  std::string configuration;
  std::string out;
  config::SweepOptions sweep;
};

config::SweepStart start(const tools::Given& given)
{
  if (given.count("follow") == 0)
  {
    return config::SweepStart::rest;
  }
  const std::string text = given["follow"].as<std::string>();
  if (text != "up" && text != "down")
  {
    throw tools::UsageError("--follow = \"" + text + "\": must be up or down");
  }
  return text == "up" ? config::SweepStart::follow_up : config::SweepStart::follow_down;
}

tools::Options options()
{
  using tools::text;
  tools::Options result("Options", 100);
  auto add = result.add_options();
  add("from", text("A"), "lowest drive frequency omega*, in lowest natural frequencies of beam 1");
  add("to", text("B"), "highest drive frequency omega*");
  add("points", text("N"), "number of equally spaced frequencies, both ends included");
  add("cycles", text("C")->default_value("400"), "drive cycles at each frequency; the last 15 impacts are evaluated");
  add("acceleration", text("a")->default_value("1"), "amplitude of the base acceleration, m/s^2");
  add("follow", text("up|down"), "start each frequency as the one before it ended, not from rest");
  add("threads", text("n"), "threads of a sweep from rest; all cores by default");
  add("out", text("DIR"), "directory for frf.csv, impacts.csv and model.csv; created if missing");
  return result;
}

Arguments interpret(const tools::Given& given)
{
  for (const char* option : {"from", "to", "points", "out"})
  {
    if (given.count(option) == 0)
    {
      throw tools::UsageError("--" + std::string(option) + " is missing");
    }
  }
  Arguments arguments;
  arguments.configuration = tools::onlyFile(given, "configuration", "configuration file");
  arguments.out = given["out"].as<std::string>();
  config::SweepOptions& sweep = arguments.sweep;
  sweep.from = tools::number(given, "from", 1.0e-3, 1.0e5);
  sweep.to = tools::number(given, "to", 1.0e-3, 1.0e5);
  sweep.points = static_cast<int>(tools::wholeNumber(given, "points", 1, 1'000'000));
  sweep.cycles = static_cast<std::uint64_t>(tools::wholeNumber(given, "cycles", 1, 1'000'000'000));
  sweep.acceleration = tools::number(given, "acceleration", 1.0e-9, 1.0e9);
  sweep.start = start(given);
  sweep.threads = given.count("threads") != 0 ? static_cast<unsigned>(tools::wholeNumber(given, "threads", 1, 1024))
                                              : std::max(1u, std::thread::hardware_concurrency());
  if (sweep.points == 1 ? sweep.from != sweep.to : sweep.from >= sweep.to)
  {
    throw tools::UsageError("--from = " + given["from"].as<std::string>() + ": must be " +
                            (sweep.points == 1 ? "equal to" : "less than") +
                            " --to = " + given["to"].as<std::string>() + (sweep.points == 1 ? " for one point" : ""));
  }
  return arguments;
}

std::vector<core::Response> compute(const std::shared_ptr<const core::SwitchedModel>& model,
                                    const config::SweepOptions& sweep)
{
  tools::ProgressLine line;
  const auto points = static_cast<std::size_t>(sweep.points);
  return config::sweep(model, sweep,
                       [&](std::size_t done)
                       {
                         if (line.due(done == points))
                         {
                           line.show(std::to_string(done) + " of " + std::to_string(points) + " frequencies");
                         }
                       });
}

void report(const config::ModelSummary& model, const std::vector<core::Response>& responses, const std::string& out)
{
  const auto frequency = [](const std::optional<double>& value)
  { return value ? config::formatNumber(std::round(*value * 1000.0) / 1000.0) + " Hz" : std::string("none"); };
  std::cout << "lowest frequency that moves the contact: free " << frequency(model.free_frequency_hz) << ", in contact "
            << frequency(model.contact_frequency_hz);
  if (model.frequency_ratio)
  {
    std::cout << ", ratio " << std::fixed << std::setprecision(4) << *model.frequency_ratio;
  }
  std::cout << "\nmapping loss at a switch: " << std::defaultfloat << std::setprecision(3)
            << 100.0 * model.mapping_loss.front() << " % of the lowest mode's energy, at most "
            << 100.0 * *std::max_element(model.mapping_loss.begin(), model.mapping_loss.end()) << " % of a mode's\n";
  const auto peak = std::max_element(responses.begin(), responses.end(),
                                     [](const core::Response& a, const core::Response& b)
                                     { return a.row.impulse_mean < b.row.impulse_mean; });
  const auto steady = std::count_if(responses.begin(), responses.end(),
                                    [](const core::Response& response) { return response.row.steady; });
  const auto count = [&responses](auto condition)
  {
    return std::count_if(responses.begin(), responses.end(),
                         [&](const core::Response& response) { return condition(response.row); });
  };
  const auto quiet = count([](const core::ResponseRow& row) { return row.impacts == 0; });
  const auto pressed = count([](const core::ResponseRow& row) { return row.impacts == 0 && row.contact_share == 1.0; });
  const auto apart = count([](const core::ResponseRow& row) { return row.impacts == 0 && row.contact_share == 0.0; });
  if (quiet > 0)
  {
    std::cout << "no impacts: " << quiet << " of " << responses.size() << " frequencies (always in contact " << pressed
              << ", never " << apart << ")\n";
  }
  std::cout << "greatest mean impulse: " << std::setprecision(6) << peak->row.impulse_mean << " N s (I* "
            << peak->row.impulse_star_mean << ") at omega* " << peak->row.omega_star << ", period " << peak->row.period
            << "\nsteady: " << steady << " of " << responses.size() << " frequencies\nwritten to " << out
            << ": frf.csv, impacts.csv, model.csv" << std::endl;
}

void run(const Arguments& arguments)
{
  const auto model = std::make_shared<const core::SwitchedModel>(config::loadFile(arguments.configuration));
  const config::OutputDirectory out(arguments.out);
  const auto responses = compute(model, arguments.sweep);
  const config::ModelSummary summary = config::summarize(*model);
  out.write({config::responseTable(responses), config::impactTable(responses), config::modelTable(summary)});
  report(summary, responses, arguments.out);
}

}  // namespace

int main(int argc, char** argv)
{
  return tools::runTool({"frf_sweep",
                         "frf_sweep CONFIG --from A --to B --points N --out DIR [options]\n\n"
                         "Computes the repetitive impact frequency response of the configuration in the file CONFIG.",
                         options(), "configuration"},
                        argc, argv, [](const tools::Given& given) { run(interpret(given)); });
}
