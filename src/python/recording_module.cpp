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

#include "errors.h"
#include "pulse.h"
#include "vibro_impact/ros/joined_recording.h"
#include "vibro_impact/ros/recorded_run.h"

namespace py = pybind11;

namespace vibro_impact::python
{
namespace
{
/// An element of Recording.impacts.
struct ImpactElement
{
  std::uint64_t number;
  double onset;
  double duration;
  double impulse;
  double peak_force;
  double peak_time;
  double approach_speed;
  double separation_speed;
  double energy_lost;
  bool cut_short;
  double dissipated;
  double mapping_loss;
  double base_work;
};

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
    list.append(py::make_tuple(loss.first, loss.last, loss.reason));
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
    list.append(py::make_tuple(start.seq, cause(start), start.reason));
  }
  return list;
}

py::dict topicsOf(const graph::RecordedTopics& topics)
{
  py::dict names;
  names["base_excitation"] = topics.base_excitation;
  names["gap"] = topics.gap;
  names["contact_force"] = topics.contact_force;
  names["impact"] = topics.impact;
  names["model_info"] = topics.model_info;
  names["stream_start"] = topics.stream_start;
  return names;
}

void defineRecording(py::module& module)
{
  PYBIND11_NUMPY_DTYPE(ImpactElement, number, onset, duration, impulse, peak_force, peak_time, approach_speed,
                       separation_speed, energy_lost, cut_short, dissipated, mapping_loss, base_work);

  py::class_<graph::RecordingSummary>(module, "Summary", "What a recording has been found to hold.")
      .def_readonly("blocks", &graph::RecordingSummary::blocks, "of excitation, repetitions apart")
      .def_readonly("samples", &graph::RecordingSummary::samples, "of excitation")
      .def_readonly("repeated", &graph::RecordingSummary::repeated, "blocks of excitation recorded twice")
      .def_readonly("impacts", &graph::RecordingSummary::impacts, "repetitions apart")
      .def_readonly("restarts", &graph::RecordingSummary::restarts, "of the simulation from rest");

  py::class_<ModelInfo>(module, "Model", "What the simulator computed with from a sample on.")
      .def_readonly("version", &ModelInfo::version, "of the package that computed")
      .def_readonly("configuration", &ModelInfo::configuration, "the whole configuration as YAML text")
      .def_property_readonly(
          "free_frequencies",
          [](const ModelInfo& info) {
            return py::array_t<double>(static_cast<py::ssize_t>(info.free_frequencies.size()),
                                       info.free_frequencies.data());
          },
          "natural frequencies out of contact, Hz")
      .def_property_readonly(
          "contact_frequencies",
          [](const ModelInfo& info)
          {
            return py::array_t<double>(static_cast<py::ssize_t>(info.contact_frequencies.size()),
                                       info.contact_frequencies.data());
          },
          "natural frequencies in contact, Hz")
      .def_property_readonly(
          "mapping_loss",
          [](const ModelInfo& info)
          { return py::array_t<double>(static_cast<py::ssize_t>(info.mapping_loss.size()), info.mapping_loss.data()); },
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

  module.def("read", &read, py::arg("bags"), py::arg("namespace"), py::arg("excitation"), py::arg("stream"),
             py::arg("progress"));
}
}  // namespace
}  // namespace vibro_impact::python

PYBIND11_MODULE(_recording, module)
{
  // What a library has to say of a damaged bag besides is in no message that a user understands.
  console_bridge::noOutputHandler();
  vibro_impact::python::registerErrors();
  vibro_impact::python::defineRecording(module);
}
