// The repetitive impact frequency response that a recording of a stepped-sine run holds.

#include <unistd.h>

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include <console_bridge/console.h>

#include "command_line.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/config/output_directory.h"
#include "vibro_impact/config/response_table.h"
#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/response_extraction.h"

namespace
{
using namespace vibro_impact;

struct Arguments
{
  std::vector<std::string> bags;
  std::string out;
  std::string name_space;
  graph::ExtractionOptions extraction;
};

tools::Options options()
{
  using tools::text;
  tools::Options result("Options", 100);
  auto add = result.add_options();
  add("out", text("DIR"), "directory for frf.csv and impacts.csv; created if missing");
  add("allow-gaps", "leave out the steps where something is missing, rather than refuse the recording");
  add("namespace", text("NS"), "the run to take from a recording of several, such as /rig1");
  add("acceleration-tolerance", text("r")->default_value("0.1"),
      "how far the amplitude of a cycle may be off that of its step, relative; less than 1");
  add("shortest-step", text("n")->default_value("4"), "cycles that make a step; at least 4");
  add("lowest-frequency", text("Hz")->default_value("1"), "lowest drive frequency to look for");
  return result;
}

Arguments interpret(const tools::Given& given)
{
  if (given.count("bags") == 0)
  {
    throw tools::UsageError("no bag is given");
  }
  if (given.count("out") == 0)
  {
    throw tools::UsageError("--out is missing");
  }
  Arguments arguments;
  arguments.bags = given["bags"].as<std::vector<std::string>>();
  arguments.out = given["out"].as<std::string>();
  arguments.name_space = given.count("namespace") != 0 ? given["namespace"].as<std::string>() : std::string();
  arguments.extraction.allow_gaps = given.count("allow-gaps") != 0;
  core::StepSearchOptions& steps = arguments.extraction.steps;
  steps.amplitude_tolerance = tools::number(given, "acceleration-tolerance", 1.0e-3, 0.9);
  steps.lowest_frequency = tools::number(given, "lowest-frequency", 1.0e-3, 1.0e6);
  steps.shortest_step = static_cast<int>(tools::wholeNumber(given, "shortest-step", 4, 1'000'000));
  return arguments;
}

/// A percentage on stderr: renewed in place on a terminal, every tenth a line elsewhere.
class Progress
{
public:
  ~Progress()
  {
    if (terminal_ && last_ > 0 && last_ < 100)
    {
      std::cerr << std::endl;
    }
  }

  void operator()(double share)
  {
    const int percent = static_cast<int>(100.0 * share);
    if (percent >= last_ + (terminal_ ? 1 : 10) || (percent == 100 && last_ < 100))
    {
      last_ = percent;
      std::cerr << (terminal_ ? "\r" : "") << "reading " << std::setw(3) << percent << " %"
                << (terminal_ && percent < 100 ? "" : "\n") << std::flush;
    }
  }

private:
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  int last_ = 0;
};

/// Which rows of the table belong to which contact.
void reportContacts(const std::vector<graph::ContactSpan>& contacts)
{
  if (contacts.size() == 1)
  {
    return;
  }
  std::cout << "the contact changed " << contacts.size() - 1 << (contacts.size() == 2 ? " time" : " times")
            << " during the recording:\n";
  std::size_t row = 1;
  for (const graph::ContactSpan& span : contacts)
  {
    std::cout << "  from seq " << span.from.seq << ": stiffness " << config::formatNumber(span.from.contact.stiffness)
              << " N/m, clearance " << config::formatNumber(span.from.contact.clearance) << " m: ";
    if (span.responses == 0)
    {
      std::cout << "no step\n";
    }
    else
    {
      std::cout << (span.responses == 1 ? "row " : "rows ") << row;
      std::cout << (span.responses == 1 ? "" : " to " + std::to_string(row + span.responses - 1)) << " of frf.csv\n";
    }
    row += span.responses;
  }
}

void report(const graph::Extraction& extraction, const std::string& out)
{
  constexpr std::size_t shown = 10;
  const graph::RecordingSummary& recording = extraction.recording;
  std::cout << recording.blocks << " blocks, " << recording.samples << " samples, "
            << (recording.losses.empty() ? "none lost" : "not complete") << "; " << recording.impacts << " impacts\n";
  if (recording.first > 0)
  {
    std::cout << "the recording begins in the middle of the stream, at seq " << recording.first << "\n";
  }
  for (std::size_t i = 0; i < std::min(shown, recording.losses.size()); ++i)
  {
    std::cout << "lost: " << recording.losses[i].reason << "\n";
  }
  if (recording.losses.size() > shown)
  {
    std::cout << "lost: " << recording.losses.size() - shown << " more\n";
  }
  if (recording.repeated > 0)
  {
    std::cout << recording.repeated << " repeated blocks ignored\n";
  }
  if (recording.restarts > 0)
  {
    std::cout << "the simulation restarted from rest " << recording.restarts << " times\n";
  }
  reportContacts(extraction.contacts);
  const auto& responses = extraction.responses;
  const auto [lowest, highest] = std::minmax_element(responses.begin(), responses.end(),
                                                     [](const core::Response& a, const core::Response& b)
                                                     { return a.row.omega_star < b.row.omega_star; });
  const auto steady = std::count_if(responses.begin(), responses.end(),
                                    [](const core::Response& response) { return response.row.steady; });
  std::cout << responses.size() + extraction.left_out.size() << " steps found, " << extraction.left_out.size()
            << " left out; omega* " << lowest->row.omega_star << " to " << highest->row.omega_star << ", " << steady
            << " of " << responses.size() << " steady\n";
  for (const graph::LeftOutStep& step : extraction.left_out)
  {
    std::cout << "left out: omega* " << step.omega_star << ", samples " << step.first << " to " << step.last - 1 << ": "
              << step.reason << "\n";
  }
  // Noise holds stretches that look like a few cycles of a sine.
  if (extraction.covered < 0.5)
  {
    std::cout << "warning: the steps cover only " << std::setprecision(2) << 100.0 * extraction.covered
              << " % of the samples: the drive may have no steps\n"
              << std::setprecision(6);
  }
  std::size_t captured = 0;
  for (const core::Response& response : responses)
  {
    captured += response.captured.size();
  }
  std::cout << "written to " << out << ": frf.csv (" << responses.size() << " rows), impacts.csv (" << captured
            << " rows)" << std::endl;
}

graph::Extraction extract(const graph::RecordedRun& recording, const graph::ExtractionOptions& options)
{
  Progress progress;
  return graph::extractResponses(recording, options, [&](double share) { progress(share); });
}

void run(const Arguments& arguments)
{
  const graph::RecordedRun recording(arguments.bags, arguments.name_space);
  const config::OutputDirectory out(arguments.out);
  const graph::Extraction extraction = extract(recording, arguments.extraction);
  out.write({config::responseTable(extraction.responses), config::impactTable(extraction.responses)});
  report(extraction, arguments.out);
}

}  // namespace

int main(int argc, char** argv)
{
  // What a library has to say of a damaged bag besides is in no message that a user understands.
  console_bridge::noOutputHandler();
  return tools::runTool(
      {"extract_frf",
       "extract_frf BAG... --out DIR [options]\n\n"
       "Extracts the repetitive impact frequency response from the recording of a stepped-sine run: one bag,\n"
       "or all bags of a split one. The steps of the drive are found in the recorded excitation.",
       options(), "bags"},
      argc, argv, [](const tools::Given& given) { run(interpret(given)); });
}
