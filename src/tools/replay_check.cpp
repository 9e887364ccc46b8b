// Whether a recording is what its excitation and its model_info give, bit for bit.

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include <console_bridge/console.h>

#include "command_line.h"
#include "progress_line.h"
#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/replay_check.h"

namespace
{
using namespace vibro_impact;

// As those of diff and cmp.
constexpr int same = 0;
constexpr int different = 1;
constexpr int trouble = 2;

struct Arguments
{
  std::vector<std::string> bags;
  std::string name_space;
  std::string excitation;
  bool allow_gaps = false;
  graph::StreamLimits limits;
};

tools::Options options()
{
  using tools::text;
  tools::Options result("Options", 100);
  auto add = result.add_options();
  add("allow-gaps", "be content if what can be compared is identical, though the recording lacks something");
  add("namespace", text("NS"), "the run to take from a recording of several, such as /rig1");
  add("excitation", text("TOPIC"), "the topic of the excitation, where several are recorded");
  add("max-acceleration", text("m/s^2")->default_value("1e5"), "parameter of the simulator that was recorded");
  add("max-bridged-gap", text("s")->default_value("0.02"), "likewise");
  add("max-step-back", text("s")->default_value("0.1"), "likewise");
  add("max-stamp-jitter", text("s")->default_value("0.05"), "likewise");
  return result;
}

Arguments interpret(const tools::Given& given)
{
  if (given.count("bags") == 0)
  {
    throw tools::UsageError("no bag is given");
  }
  const auto name = [&](const char* option)
  { return given.count(option) != 0 ? given[option].as<std::string>() : std::string(); };
  Arguments arguments;
  arguments.bags = given["bags"].as<std::vector<std::string>>();
  arguments.name_space = name("namespace");
  arguments.excitation = name("excitation");
  arguments.allow_gaps = given.count("allow-gaps") != 0;
  constexpr double longest_time = 60.0;
  arguments.limits.max_acceleration = tools::number(given, "max-acceleration", 1.0e-300, 1.0e9);
  arguments.limits.max_bridged_gap = tools::number(given, "max-bridged-gap", 0.0, longest_time);
  arguments.limits.max_step_back = tools::number(given, "max-step-back", 0.0, longest_time);
  arguments.limits.max_stamp_jitter = tools::number(given, "max-stamp-jitter", 1.0e-300, longest_time);
  return arguments;
}

void printCounts(const graph::ReplayReport& report)
{
  std::cout << report.blocks << " blocks, " << report.samples << " samples, " << report.impacts << " impacts\n";
  std::cout << report.starts << (report.starts == 1 ? " start" : " starts") << " from rest";
  if (report.unannounced > 0)
  {
    std::cout << " (" << report.unannounced << " by a reset, a pause or another simulator)";
  }
  std::cout << ", " << report.contact_changes << " changes of the contact, " << report.bridged << " gaps bridged, "
            << report.refused << " blocks refused, " << report.not_taken << " not taken\n";
}

void printLosses(const graph::ReplayReport& report)
{
  constexpr std::size_t shown = 10;
  for (std::size_t i = 0; i < std::min(shown, report.losses.size()); ++i)
  {
    std::cout << "not compared: " << report.losses[i].reason << "\n";
  }
  if (report.losses.size() > shown)
  {
    std::cout << "not compared: " << report.losses.size() - shown << " more\n";
  }
  if (report.impacts_not_compared > 0)
  {
    std::cout << "not compared: " << report.impacts_not_compared << " impacts there\n";
  }
}

int print(const graph::ReplayReport& report, bool allow_gaps)
{
  if (report.difference)
  {
    const graph::ReplayDifference& found = *report.difference;
    std::cout << "different: topic " << found.topic << ", " << found.place << ": " << found.field << ": recorded "
              << found.recorded << ", recomputed " << found.recomputed << "\nidentical before: ";
  }
  else
  {
    std::cout << (report.complete() ? "identical: " : "identical where compared: ");
  }
  printCounts(report);
  printLosses(report);
  std::cout << std::flush;
  return report.difference || !(report.complete() || allow_gaps) ? different : same;
}

int run(const Arguments& arguments)
{
  const graph::RecordedRun recording(arguments.bags, arguments.name_space, graph::RecordedContents::whole_run,
                                     arguments.excitation);
  graph::ReplayReport report;
  {
    tools::ProgressLine line;
    report = graph::checkReplay(recording, arguments.limits,
                                [&](double share)
                                {
                                  if (line.due(share >= 1.0))
                                  {
                                    line.show("replayed " + std::to_string(static_cast<int>(100.0 * share)) + " %");
                                  }
                                });
  }
  if (!report.difference && report.blocks == 0)
  {
    throw std::runtime_error("nothing can be compared: " +
                             (report.losses.empty() ? "the recording holds no block" : report.losses.front().reason));
  }
  return print(report, arguments.allow_gaps);
}

}  // namespace

int main(int argc, char** argv)
{
  // What a library has to say of a damaged bag besides is in no message that a user understands.
  console_bridge::noOutputHandler();
  int result = same;
  const int status = tools::runTool(
      {"replay_check",
       "replay_check BAG... [options]\n\n"
       "Recomputes gap, contact force and impacts from the excitation and the model_info of a recording, one bag or\n"
       "all bags of a split one, and compares them bit for bit. Prints 'identical' and what was compared, or the "
       "first\n"
       "difference. The status is 0 if everything is identical, 1 if not, 2 if nothing can be compared.",
       options(), "bags"},
      argc, argv, [&](const tools::Given& given) { result = run(interpret(given)); });
  return status == 0 ? result : trouble;
}
