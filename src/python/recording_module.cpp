// vibro_impact._recording: what a bag holds, for vibro_impact/recording.py and its neighbours.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <console_bridge/console.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "errors.h"
#include "pulse.h"
#include "vibro_impact/ros/joined_recording.h"
#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/replay_check.h"
#include "vibro_impact/ros/response_extraction.h"

namespace py = pybind11;

namespace vibro_impact::python
{
namespace
{
struct Joined
{
  graph::RecordedTopics topics;
  graph::JoinedRecording recording;
};

std::unique_ptr<Joined> read(const std::vector<std::string>& bags, const std::string& name_space,
                             const std::string& excitation, std::optional<std::size_t> stream,
                             const py::object& progress)
{
  Pulse pulse(progress);
  const py::gil_scoped_release unlocked;
  const graph::RecordedRun run(bags, name_space, graph::RecordedContents::whole_run, excitation);
  return std::make_unique<Joined>(
      Joined{run.topics(), graph::joinRecording(run, stream, [&](double share) { pulse(share); })});
}

/// The samples themselves, not a copy; they live as long as `owner` or the array.
py::array_t<double> arrayOf(const py::object& owner, const graph::SampleColumn& column)
{
  return py::array_t<double>(static_cast<py::ssize_t>(column.size()), column.data(), owner);
}

py::array_t<ImpactElement> impactsOf(const Joined& joined)
{
  const graph::RecordingSummary& summary = joined.recording.summary;
  const std::vector<Impact>& impacts = joined.recording.impacts;
  py::array_t<ImpactElement> array(static_cast<py::ssize_t>(impacts.size()));
  ImpactElement* element = array.mutable_data();
  for (const Impact& impact : impacts)
  {
    // Before the first sample, if an impact had begun when the recording did.
    const auto sample = static_cast<double>(static_cast<std::int64_t>(impact.seq - summary.first));
    *element++ = {impact.number,         sample * summary.sample_period + impact.offset,
                  impact.duration,       impact.impulse,
                  impact.peak_force,     impact.peak_time,
                  impact.approach_speed, impact.separation_speed,
                  impact.energy_lost,    impact.cut_short != 0,
                  impact.dissipated,     impact.mapping_loss,
                  impact.base_work};
  }
  return array;
}

py::list lossesOf(const std::vector<graph::Loss>& losses)
{
  py::list list;
  for (const graph::Loss& loss : losses)
  {
    list.append(py::make_tuple(loss.first, loss.last, textOf(loss.reason)));
  }
  return list;
}

graph::Extraction extract(const std::vector<std::string>& bags, const std::string& name_space,
                          const std::string& excitation, bool allow_gaps, double acceleration_tolerance,
                          std::int64_t shortest_step, double lowest_frequency, const py::object& progress)
{
  graph::ExtractionOptions options;
  options.allow_gaps = allow_gaps;
  options.steps.amplitude_tolerance = number("acceleration_tolerance", acceleration_tolerance, 1.0e-3, 0.9);
  options.steps.shortest_step = static_cast<int>(wholeNumber("shortest_step", shortest_step, 4, 1'000'000));
  options.steps.lowest_frequency = number("lowest_frequency", lowest_frequency, 1.0e-3, 1.0e6);
  Pulse pulse(progress);
  const py::gil_scoped_release unlocked;
  const graph::RecordedRun run(bags, name_space, graph::RecordedContents::whole_run, excitation);
  return withErrors([&] { return graph::extractResponses(run, options, [&](double share) { pulse(share); }); });
}

graph::ReplayReport check(const std::vector<std::string>& bags, const std::string& name_space,
                          const std::string& excitation, double max_acceleration, double max_bridged_gap,
                          double max_step_back, double max_stamp_jitter, const py::object& progress)
{
  constexpr double longest_time = 60.0;
  graph::StreamLimits limits;
  limits.max_acceleration = number("max_acceleration", max_acceleration, 1.0e-300, 1.0e9);
  limits.max_bridged_gap = number("max_bridged_gap", max_bridged_gap, 0.0, longest_time);
  limits.max_step_back = number("max_step_back", max_step_back, 0.0, longest_time);
  limits.max_stamp_jitter = number("max_stamp_jitter", max_stamp_jitter, 1.0e-300, longest_time);
  Pulse pulse(progress);
  const py::gil_scoped_release unlocked;
  const graph::RecordedRun run(bags, name_space, graph::RecordedContents::whole_run, excitation);
  return withErrors([&] { return graph::checkReplay(run, limits, [&](double share) { pulse(share); }); });
}

py::list leftOut(const graph::Extraction& extraction)
{
  py::list list;
  for (const graph::LeftOutStep& step : extraction.left_out)
  {
    list.append(py::make_tuple(step.omega_star, step.first, step.last, textOf(step.reason)));
  }
  return list;
}

py::list stepsOf(const graph::Extraction& extraction)
{
  py::list list;
  for (const core::Response& response : extraction.responses)
  {
    list.append(py::make_tuple(response.step.start, response.step.end));
  }
  return list;
}

py::list contactsOf(const graph::Extraction& extraction)
{
  py::list list;
  for (const graph::ContactSpan& span : extraction.contacts)
  {
    list.append(
        py::make_tuple(span.from.seq, span.from.contact.stiffness, span.from.contact.clearance, span.responses));
  }
  return list;
}

py::list startsOf(const std::vector<StreamStart>& starts)
{
  const auto cause = [](const StreamStart& start) -> std::string
  {
    switch (start.cause)
    {
      case StreamStart::FIRST:
        return "first";
      case StreamStart::RULE:
        return "rule";
      case StreamStart::RESET:
        return "reset";
      case StreamStart::PAUSE:
        return "pause";
      default:
        return std::to_string(start.cause);
    }
  };
  py::list list;
  for (const StreamStart& start : starts)
  {
    list.append(py::make_tuple(start.seq, cause(start), textOf(start.reason)));
  }
  return list;
}

py::dict topicsOf(const graph::RecordedTopics& topics)
{
  py::dict names;
  names["base_excitation"] = textOf(topics.base_excitation);
  names["gap"] = textOf(topics.gap);
  names["contact_force"] = textOf(topics.contact_force);
  names["impact"] = textOf(topics.impact);
  names["model_info"] = textOf(topics.model_info);
  names["stream_start"] = textOf(topics.stream_start);
  return names;
}

void defineRecording(py::module& module)
{
  py::class_<graph::RecordingSummary>(module, "Summary", "What a recording has been found to hold.")
      .def_readonly("blocks", &graph::RecordingSummary::blocks, "of excitation, repetitions apart")
      .def_readonly("samples", &graph::RecordingSummary::samples, "of excitation")
      .def_readonly("repeated", &graph::RecordingSummary::repeated, "blocks of excitation recorded twice")
      .def_readonly("impacts", &graph::RecordingSummary::impacts, "repetitions apart")
      .def_readonly("restarts", &graph::RecordingSummary::restarts, "of the simulation from rest");

  py::class_<ModelInfo>(module, "Model", "What the simulator computed with from a sample on.")
      .def_property_readonly(
          "version", [](const ModelInfo& info) { return textOf(info.version); }, "of the package that computed")
      .def_property_readonly(
          "configuration", [](const ModelInfo& info) { return textOf(info.configuration); },
          "the whole configuration as YAML text")
      .def_property_readonly(
          "free_frequencies", [](const ModelInfo& info) { return copyOf(info.free_frequencies); },
          "natural frequencies out of contact, Hz")
      .def_property_readonly(
          "contact_frequencies", [](const ModelInfo& info) { return copyOf(info.contact_frequencies); },
          "natural frequencies in contact, Hz")
      .def_property_readonly(
          "mapping_loss", [](const ModelInfo& info) { return copyOf(info.mapping_loss); },
          "share of a unit coordinate's energy that the mapping into contact loses, one per free frequency, 1")
      .def_readonly("seq", &ModelInfo::seq, "number of the first sample it holds for; 0: from the start")
      .def_readonly("number", &ModelInfo::number, "how often the contact had been changed");

  py::class_<Joined>(module, "Joined", "What vibro_impact.Recording is made of.")
      .def_property_readonly("acceleration", [](const py::object& self)
                             { return arrayOf(self, self.cast<const Joined&>().recording.acceleration); })
      .def_property_readonly(
          "gap", [](const py::object& self) { return arrayOf(self, self.cast<const Joined&>().recording.gap); })
      .def_property_readonly("contact_force", [](const py::object& self)
                             { return arrayOf(self, self.cast<const Joined&>().recording.contact_force); })
      .def_property_readonly("sample_period", [](const Joined& self) { return self.recording.summary.sample_period; })
      .def_property_readonly("first", [](const Joined& self) { return self.recording.summary.first; })
      .def_property_readonly("start_stamp", [](const Joined& self)
                             { return py::make_tuple(self.recording.start.sec, self.recording.start.nsec); })
      .def_property_readonly("impacts", &impactsOf)
      .def_property_readonly("losses", [](const Joined& self) { return lossesOf(self.recording.summary.losses); })
      .def_property_readonly("models", [](const Joined& self) { return self.recording.models; })
      .def_property_readonly("starts", [](const Joined& self) { return startsOf(self.recording.starts); })
      .def_property_readonly("topics", [](const Joined& self) { return topicsOf(self.topics); })
      .def_property_readonly("summary", [](const Joined& self) { return self.recording.summary; });

  py::class_<graph::Extraction>(module, "Extraction", "The frequency response that a recording holds.")
      .def_property_readonly(
          "responses", [](const graph::Extraction& self) { return responseArray(self.responses); },
          "structured array, the columns of frf.csv, one element a step of the drive, in order of time")
      .def_property_readonly(
          "impacts", [](const graph::Extraction& self) { return impactArray(self.responses); },
          "structured array of the captured impacts, the columns of impacts.csv; onset_s from sample 0 of the stream")
      .def_property_readonly("steps", &stepsOf,
                             "where they begin and end: list of (start, end) in s from sample 0 of the stream, one an "
                             "element of responses")
      .def_property_readonly("left_out", &leftOut,
                             "steps not evaluated: list of (omega_star, first sample, sample after the last, reason)")
      .def_property_readonly("contacts", &contactsOf,
                             "list of (number of the first sample, stiffness in N/m, clearance in m, elements of "
                             "responses), in order of time")
      .def_readonly("covered", &graph::Extraction::covered,
                    "share of the samples that belongs to steps, those left out included, 1")
      .def_property_readonly(
          "losses", [](const graph::Extraction& self) { return lossesOf(self.recording.losses); }, "as of a Recording")
      .def_property_readonly(
          "summary", [](const graph::Extraction& self) { return self.recording; }, "as of a Recording");

  py::class_<graph::ReplayDifference>(module, "Difference", "The first place where recorded and recomputed differ.")
      .def_readonly("topic", &graph::ReplayDifference::topic)
      .def_readonly("place", &graph::ReplayDifference::place, "numbers of the block and the sample, or of the impact")
      .def_readonly("field", &graph::ReplayDifference::field, "of the message")
      .def_property_readonly(
          "recorded", [](const graph::ReplayDifference& self) { return textOf(self.recorded); }, "with 17 digits")
      .def_property_readonly(
          "recomputed", [](const graph::ReplayDifference& self) { return textOf(self.recomputed); }, "likewise");

  py::class_<graph::ReplayReport>(module, "ReplayReport", "What came of recomputing a recording.")
      .def_readonly("difference", &graph::ReplayReport::difference,
                    "None, or the first Difference; nothing behind it has been compared")
      .def_property_readonly("complete", &graph::ReplayReport::complete, "whether everything could be compared")
      .def_readonly("blocks", &graph::ReplayReport::blocks, "of gap and contact force, identical bit for bit")
      .def_readonly("samples", &graph::ReplayReport::samples, "of each, identical")
      .def_readonly("impacts", &graph::ReplayReport::impacts, "identical")
      .def_readonly("starts", &graph::ReplayReport::starts, "from rest")
      .def_readonly("unannounced", &graph::ReplayReport::unannounced, "those of them aside from the rules of time")
      .def_readonly("bridged", &graph::ReplayReport::bridged, "gaps of the excitation")
      .def_readonly("refused", &graph::ReplayReport::refused, "blocks that the rules of the stream refuse")
      .def_readonly("not_taken", &graph::ReplayReport::not_taken, "blocks that the simulator never had")
      .def_readonly("contact_changes", &graph::ReplayReport::contact_changes)
      .def_property_readonly(
          "losses", [](const graph::ReplayReport& self) { return lossesOf(self.losses); }, "not compared")
      .def_readonly("impacts_not_compared", &graph::ReplayReport::impacts_not_compared);

  module.def("extract", &extract, py::arg("bags"), py::arg("namespace"), py::arg("excitation"), py::arg("allow_gaps"),
             py::arg("acceleration_tolerance"), py::arg("shortest_step"), py::arg("lowest_frequency"),
             py::arg("progress"));
  module.def("check", &check, py::arg("bags"), py::arg("namespace"), py::arg("excitation"), py::arg("max_acceleration"),
             py::arg("max_bridged_gap"), py::arg("max_step_back"), py::arg("max_stamp_jitter"), py::arg("progress"));
  module.def("read", &read, py::arg("bags"), py::arg("namespace"), py::arg("excitation"), py::arg("stream"),
             py::arg("progress"));
}
}  // namespace
}  // namespace vibro_impact::python

PYBIND11_MODULE(_recording, module)
{
  // What a library has to say of a damaged bag besides is in no message that a user understands.
  console_bridge::noOutputHandler();
  // Registers the errors, and the elements of arrays that the two modules share.
  pybind11::module::import("vibro_impact._core");
  vibro_impact::python::defineRecording(module);
}
