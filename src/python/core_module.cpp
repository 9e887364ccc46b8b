// vibro_impact._core: the model and its responses.

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "errors.h"
#include "pulse.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/model_summary.h"
#include "vibro_impact/config/simulated_run.h"
#include "vibro_impact/config/sweep.h"
#include "vibro_impact/core/simulation.h"
#include "vibro_impact/core/structure.h"
#include "vibro_impact/core/switched_model.h"

namespace py = pybind11;

namespace vibro_impact::python
{
namespace
{
constexpr double two_pi = 6.283185307179586476925286766559;

using Samples = py::array_t<double, py::array::c_style | py::array::forcecast>;

struct Model
{
  explicit Model(const core::SystemParameters& given)
      : parameters(given), model(std::make_shared<const core::SwitchedModel>(given)), summary(config::summarize(*model))
  {
  }

  core::SystemParameters parameters;
  std::shared_ptr<const core::SwitchedModel> model;
  config::ModelSummary summary;
};

/// One value an element of `frequencies` (Hz, a number or an array), of the same shape.
template <typename Value, typename Function>
py::array_t<Value> atEach(const Samples& frequencies, const Function& function)
{
  py::array_t<Value> values(std::vector<py::ssize_t>(frequencies.shape(), frequencies.shape() + frequencies.ndim()));
  const double* const from = frequencies.data();
  Value* const to = values.mutable_data();
  for (py::ssize_t i = 0; i < frequencies.size(); ++i)
  {
    to[i] = function(two_pi * number("frequency", from[i], 0.0, 1.0e9));
  }
  return values;
}

py::array_t<double> receptance(const Model& model, const Samples& frequency, int structure)
{
  wholeNumber("structure", structure, 1, 2);
  const auto found = core::makeStructure(structure == 1 ? model.parameters.beam1 : model.parameters.beam2);
  return atEach<double>(frequency, [&](double omega) { return found ? found->receptance(omega) : 0.0; });
}

py::array_t<std::complex<double>> gapResponse(const Model& model, const Samples& frequency, const std::string& state)
{
  if (state != "free" && state != "contact")
  {
    throw config::Error("state is '" + state + "', must be free or contact");
  }
  const core::LinearState& linear = state == "free" ? model.model->free() : model.model->contact();
  const auto response = [&](double omega)
  {
    std::complex<double> sum = 0.0;
    for (Eigen::Index n = 0; n < linear.size(); ++n)
    {
      const double natural = linear.frequency[n];
      const std::complex<double> stiffness(natural * natural - omega * omega,
                                           2.0 * linear.damping_ratio[n] * natural * omega);
      sum -= linear.contact_deflection[n] * linear.participation[n] / stiffness;
    }
    return sum;
  };
  return atEach<std::complex<double>>(frequency, response);
}

core::InitialMotion initialMotion(std::vector<double> displacement1, std::vector<double> velocity1,
                                  std::vector<double> displacement2, std::vector<double> velocity2)
{
  return {{std::move(displacement1), std::move(velocity1)}, {std::move(displacement2), std::move(velocity2)}};
}

/// What one run under a harmonic drive brought.
struct HarmonicRun
{
  py::array_t<config::HistoryRow> history;
  py::array_t<config::SimulatedImpactRow> impacts;
  double omega_star;
  double frequency_hz;
  int period;
  core::EnergyAccount energy;
};

HarmonicRun simulateHarmonic(const Model& model, std::optional<double> frequency, std::optional<double> omega_star,
                             double acceleration, std::int64_t cycles, std::int64_t samples_per_cycle, bool history,
                             const std::vector<double>& displacement1, const std::vector<double>& velocity1,
                             const std::vector<double>& displacement2, const std::vector<double>& velocity2,
                             const py::object& progress)
{
  if (frequency.has_value() == omega_star.has_value())
  {
    throw config::Error("one of frequency and omega_star must be given");
  }
  config::HarmonicRunOptions options;
  options.omega_star = frequency ? config::omegaStar(number("frequency", *frequency, 1.0e-6, 1.0e9), *model.model)
                                 : number("omega_star", *omega_star, 1.0e-3, 1.0e5);
  options.acceleration = number("acceleration", acceleration, 0.0, 1.0e9);
  options.cycles = static_cast<std::uint64_t>(wholeNumber("cycles", cycles, 1, 1'000'000'000));
  options.samples_per_cycle =
      static_cast<std::uint64_t>(wholeNumber("samples_per_cycle", samples_per_cycle, 1, 1'000'000));
  config::HistorySelection selection;
  const double rows = static_cast<double>(cycles) * static_cast<double>(samples_per_cycle) + 1.0;
  if (history && rows > static_cast<double>(selection.longest))
  {
    throw config::Error("cycles times samples_per_cycle is " + config::formatNumber(rows - 1.0) +
                        ", must be less than " + std::to_string(selection.longest) +
                        "; history=False keeps the impacts alone");
  }
  if (!history)
  {
    selection.from = std::numeric_limits<double>::infinity();
  }
  const core::InitialMotion initial = initialMotion(displacement1, velocity1, displacement2, velocity2);
  Pulse pulse(progress);
  config::SimulatedRun run = withErrors(
      [&]
      {
        const py::gil_scoped_release unlocked;
        return config::simulateHarmonic(model.model, options, initial, selection, [&](double share) { pulse(share); });
      });
  return {adopt(std::move(run.history)),
          adopt(std::move(run.impacts)),
          *run.omega_star,
          *run.frequency_hz,
          run.period.value_or(0),
          run.energy};
}

/// The frequency response of a sweep.
struct Sweep
{
  py::array_t<core::ResponseRow> responses;
  py::array_t<config::ImpactRow> impacts;
};

Sweep sweep(const Model& model, double lowest, double highest, std::int64_t points, std::int64_t cycles,
            double acceleration, const std::optional<std::string>& follow, std::optional<std::int64_t> threads,
            const py::object& progress)
{
  config::SweepOptions options;
  options.from = number("lowest", lowest, 1.0e-3, 1.0e5);
  options.to = number("highest", highest, 1.0e-3, 1.0e5);
  options.points = static_cast<int>(wholeNumber("points", points, 1, 1'000'000));
  options.cycles = static_cast<std::uint64_t>(wholeNumber("cycles", cycles, 1, 1'000'000'000));
  options.acceleration = number("acceleration", acceleration, 1.0e-9, 1.0e9);
  if (follow && *follow != "up" && *follow != "down")
  {
    throw config::Error("follow is '" + *follow + "', must be up, down or None");
  }
  if (follow)
  {
    options.start = *follow == "up" ? config::SweepStart::follow_up : config::SweepStart::follow_down;
  }
  options.threads = threads ? static_cast<unsigned>(wholeNumber("threads", *threads, 1, 1024))
                            : std::max(1U, std::thread::hardware_concurrency());
  if (points == 1 ? lowest != highest : lowest >= highest)
  {
    throw config::Error("lowest is " + config::formatNumber(lowest) + ", must be " +
                        (points == 1 ? "equal to" : "less than") + " highest, " + config::formatNumber(highest) +
                        (points == 1 ? ", for one point" : ""));
  }
  Pulse pulse(progress);
  const std::vector<core::Response> responses = withErrors(
      [&]
      {
        const py::gil_scoped_release unlocked;
        return config::sweep(model.model, options,
                             [&](std::size_t done) { pulse(static_cast<double>(done) / static_cast<double>(points)); });
      });
  return {responseArray(responses), impactArray(responses)};
}

/// Impacts on the axis of time on which sample 0 is at 0 s.
class ImpactList : public core::ImpactSink
{
public:
  explicit ImpactList(double sample_period) : sample_period_(sample_period)
  {
  }

  void onImpact(const core::Impact& impact) override
  {
    elements.push_back({impact.number, static_cast<double>(impact.interval) * sample_period_ + impact.offset,
                        impact.duration, impact.impulse, impact.peak_force, impact.peak_time, impact.approach_speed,
                        impact.separation_speed, impact.energy_lost, impact.cut_short, impact.dissipated,
                        impact.mapping_loss, impact.base_work});
  }

  std::vector<ImpactElement> elements;

private:
  double sample_period_;
};

/// A motion under samples, which goes on from call to call.
class Simulation
{
public:
  Simulation(const Model& model, double sample_period, const core::InitialMotion& initial)
      : simulation_(model.model, number("sample_period", sample_period, 1.0e-9, 1.0e3)), initial_(initial)
  {
    withErrors([&] { begin(); });
  }

  py::tuple advance(const Samples& acceleration)
  {
    if (acceleration.ndim() != 1)
    {
      throw config::Error("acceleration has " + std::to_string(acceleration.ndim()) + " dimensions, must have 1");
    }
    const auto count = static_cast<std::size_t>(acceleration.size());
    const double* const samples = acceleration.data();
    const double* const bad =
        std::find_if(samples, samples + count, [](double value) { return !std::isfinite(value); });
    if (bad != samples + count)
    {
      throw config::Error("acceleration[" + std::to_string(bad - samples) + "] is " + config::formatNumber(*bad) +
                          ", must be finite");
    }
    py::array_t<double> gap(acceleration.size());
    py::array_t<double> force(acceleration.size());
    ImpactList impacts(simulation_.samplePeriod());
    double* const gaps = gap.mutable_data();
    double* const forces = force.mutable_data();
    const py::object silent = py::none();
    Pulse pulse(silent);
    {
      const py::gil_scoped_release unlocked;
      const std::lock_guard<std::mutex> turn(turn_);
      // In pieces, so that Ctrl-C works; the result is the same bit for bit.
      constexpr std::size_t piece = 10000;
      for (std::size_t i = 0; i < count; i += piece)
      {
        simulation_.advance(samples + i, std::min(piece, count - i), gaps + i, forces + i, impacts);
        pulse(0.0);
      }
    }
    return py::make_tuple(std::move(gap), std::move(force), adopt(std::move(impacts.elements)));
  }

  py::array_t<ImpactElement> finish()
  {
    ImpactList impacts(simulation_.samplePeriod());
    {
      const py::gil_scoped_release unlocked;
      const std::lock_guard<std::mutex> turn(turn_);
      simulation_.finish(impacts);
    }
    return adopt(std::move(impacts.elements));
  }

  void reset()
  {
    const py::gil_scoped_release unlocked;
    const std::lock_guard<std::mutex> turn(turn_);
    begin();
  }

  const core::SampledSimulation& simulation() const
  {
    return simulation_;
  }

private:
  void begin()
  {
    ImpactList none(simulation_.samplePeriod());
    simulation_.start(initial_, none);
  }

  core::SampledSimulation simulation_;
  core::InitialMotion initial_;
  std::mutex turn_;
};

py::dict energyOf(const core::EnergyAccount& energy)
{
  py::dict entries;
  entries["initial"] = energy.initial;
  entries["structure1"] = energy.structure1;
  entries["structure2"] = energy.structure2;
  entries["spring"] = energy.spring;
  entries["left_out"] = energy.left_out;
  entries["base_work"] = energy.work;
  entries["contact_work"] = energy.contact_work;
  entries["dissipated_free"] = energy.dissipated_free;
  entries["dissipated_contact"] = energy.dissipated_contact;
  entries["mapping_loss"] = energy.mapping_loss;
  entries["closure"] = energy.closure();
  return entries;
}

void defineElements()
{
  using config::HistoryRow;
  using config::ImpactRow;
  using config::SimulatedImpactRow;
  using core::ResponseRow;
  PYBIND11_NUMPY_DTYPE(ImpactElement, number, onset, duration, impulse, peak_force, peak_time, approach_speed,
                       separation_speed, energy_lost, cut_short, dissipated, mapping_loss, base_work);
  PYBIND11_NUMPY_DTYPE(ResponseRow, omega_star, frequency_hz, acceleration, period, steady, impacts, impacts_per_cycle,
                       impulse_mean, impulse_min, impulse_max, impulse_star_mean, impulse_star_min, impulse_star_max,
                       impulse_per_cycle, peak_force, duration_mean, contact_share, stiffness, clearance);
  PYBIND11_NUMPY_DTYPE(ImpactRow, omega_star, number, onset_s, duration_s, impulse, peak_force, approach_speed,
                       separation_speed, energy_lost, dissipated, mapping_loss, base_work);
  PYBIND11_NUMPY_DTYPE(HistoryRow, time, acceleration, gap, gap_velocity, force, in_contact, energy_structure1,
                       energy_structure2, energy_spring, energy_left_out, base_work, contact_work, dissipated_free,
                       dissipated_contact, mapping_loss, energy_residual);
  PYBIND11_NUMPY_DTYPE(SimulatedImpactRow, omega_star, number, onset_s, duration_s, impulse, peak_force, approach_speed,
                       separation_speed, cut_short, energy_lost, dissipated, mapping_loss, base_work);
}

void defineModel(py::module& module)
{
  const std::vector<double> none;
  py::class_<Model>(module, "Model", R"(Two structures, their contact and the basis, as a configuration describes them.

    Model(configuration, directory="")

configuration: YAML text as in a configuration file. directory: what the files of modal tables are relative to; without
it their paths are absolute. load_model() takes the path of a configuration file. Raises Error with all that is wrong.
Immutable; may be used by several threads at a time.)")
      .def(py::init(
               [](const std::string& configuration, const std::string& directory)
               {
                 const py::gil_scoped_release unlocked;
                 return withErrors(
                     [&] { return std::make_unique<Model>(config::parse(configuration, "configuration", directory)); });
               }),
           py::arg("configuration"), py::arg("directory") = "")
      .def_property_readonly(
          "configuration", [](const Model& self) { return config::toYaml(self.parameters); },
          "the whole configuration as YAML text, which needs no other file")
      .def_property_readonly(
          "free_frequencies", [](const Model& self) { return copyOf(self.summary.free_frequencies); },
          "natural frequencies while apart, Hz")
      .def_property_readonly(
          "contact_frequencies", [](const Model& self) { return copyOf(self.summary.contact_frequencies); },
          "natural frequencies in contact, Hz")
      .def_property_readonly(
          "free_damping_ratios",
          [](const Model& self)
          {
            const Eigen::ArrayXd& ratios = self.model->free().damping_ratio;
            return copyOf({ratios.data(), ratios.data() + ratios.size()});
          },
          "damping ratio of each mode while apart, in the order of free_frequencies, 1")
      .def_property_readonly(
          "mapping_loss", [](const Model& self) { return copyOf(self.summary.mapping_loss); },
          "share of a unit coordinate's energy that the mapping into contact loses, one per free frequency, 1")
      .def_property_readonly(
          "reference_frequency", [](const Model& self) { return self.model->scales().frequency / two_pi; },
          "what omega_star = 1 means, Hz: the lowest natural frequency of beam 1 above zero")
      .def_property_readonly(
          "stiffness", [](const Model& self) { return self.model->stiffness(); }, "of the contact spring, N/m")
      .def_property_readonly(
          "clearance", [](const Model& self) { return self.model->clearance(); },
          "at rest, m; negative: an interference fit")
      .def("receptance", &receptance, py::arg("frequency"), py::arg("structure") = 1,
           R"(Undamped point receptance of one structure alone at the contact point, all its modes, m/N.

frequency: Hz, a number or an array. structure: 1 or 2. Zero of a rigid surface.)")
      .def("gap_response", &gapResponse, py::arg("frequency"), py::arg("state") = "free",
           R"(Amplitude of the gap per amplitude of the base acceleration in a linear state, complex, m per m/s^2.

frequency: Hz, a number or an array. state: "free" or "contact". Of the modes of the model, damping included; the
convention is exp(i omega t).)")
      .def(
          "simulate_harmonic", &simulateHarmonic, py::arg("frequency") = py::none(), py::arg("omega_star") = py::none(),
          py::arg("acceleration") = 1.0, py::arg("cycles") = 100, py::arg("samples_per_cycle") = 200,
          py::arg("history") = true, py::arg("displacement1") = none, py::arg("velocity1") = none,
          py::arg("displacement2") = none, py::arg("velocity2") = none, py::arg("progress") = py::none(),
          R"(A run under an exact harmonic drive a(t) = -A cos(Omega t), as the tool simulate does it. Returns a HarmonicRun.

frequency (Hz) or omega_star (in reference_frequency): one of them. acceleration: the amplitude A, m/s^2. cycles: of the
drive. samples_per_cycle: of the history; history=False keeps none. displacement1, ...: the motion at the start in the
modes of each structure alone (m kg^1/2, m/s kg^1/2); at rest without. progress: a function called with the share done.)")
      .def(
          "simulation",
          [](const Model& self, double sample_period, const std::vector<double>& displacement1,
             const std::vector<double>& velocity1, const std::vector<double>& displacement2,
             const std::vector<double>& velocity2)
          {
            return std::make_unique<Simulation>(self, sample_period,
                                                initialMotion(displacement1, velocity1, displacement2, velocity2));
          },
          py::arg("sample_period"), py::arg("displacement1") = none, py::arg("velocity1") = none,
          py::arg("displacement2") = none, py::arg("velocity2") = none,
          R"(A motion under samples of the base acceleration, sample_period (s) apart: see Simulation.

displacement1, ...: the motion that sample 0 finds, as in simulate_harmonic().)")
      .def("sweep", &sweep, py::arg("lowest"), py::arg("highest"), py::arg("points"), py::arg("cycles") = 400,
           py::arg("acceleration") = 1.0, py::arg("follow") = py::none(), py::arg("threads") = py::none(),
           py::arg("progress") = py::none(),
           R"(The frequency response, as the tool frf_sweep computes it. Returns a Sweep.

lowest, highest: omega_star, both included. points: equally spaced frequencies. cycles: of the drive at each.
acceleration: its amplitude, m/s^2. follow: None, every frequency from rest; "up" or "down", each from where the one
before it ended. threads: of a sweep from rest; without it as many as there are cores. progress: a function called with
the share done.)");

  module.def(
      "load_model",
      [](const py::object& path)
      {
        const auto name = py::module::import("os").attr("fsdecode")(path).cast<std::string>();
        const py::gil_scoped_release unlocked;
        return withErrors([&] { return std::make_unique<Model>(config::loadFile(name)); });
      },
      py::arg("path"), "The Model that a configuration file describes.");
}

void defineRuns(py::module& module)
{
  py::class_<HarmonicRun>(module, "HarmonicRun", "What one run under a harmonic drive brought.")
      .def_readonly("history", &HarmonicRun::history,
                    "structured array, the columns of the tool's history.csv: time (s), acceleration (m/s^2), gap (m), "
                    "gap_velocity (m/s), force (N), in_contact, energies (J)")
      .def_readonly("impacts", &HarmonicRun::impacts, "structured array, the columns of the tool's impacts.csv")
      .def_readonly("omega_star", &HarmonicRun::omega_star, "drive frequency in the model's reference_frequency")
      .def_readonly("frequency_hz", &HarmonicRun::frequency_hz, "drive frequency, Hz")
      .def_readonly("period", &HarmonicRun::period, "drive cycles after which the response repeats; 0: none up to 16")
      .def_property_readonly(
          "energy", [](const HarmonicRun& self) { return energyOf(self.energy); },
          "the account at the end, J, and `closure`: how far it does not close, as a share");

  py::class_<Sweep>(module, "Sweep", "The frequency response of a sweep.")
      .def_readonly("responses", &Sweep::responses, "structured array, the columns of frf.csv, one element a frequency")
      .def_readonly("impacts", &Sweep::impacts, "structured array, the columns of impacts.csv");

  py::class_<Simulation>(module, "Simulation",
                         R"(A motion under samples of the base acceleration, straight lines between them.

Model.simulation() makes it. Sample for sample what the simulator node computes, bit for bit, however the samples are
cut into calls.)")
      .def(
          "advance", &Simulation::advance, py::arg("acceleration"),
          R"(Takes the next samples of the base acceleration (m/s^2, one-dimensional). Returns gap, contact_force, impacts.

gap (m) and contact_force (N, positive in compression): arrays of the same length. impacts: structured array, as in a
Recording, of those that ended; onset in s from sample 0 of this motion.)")
      .def("finish", &Simulation::finish, "Ends the motion: the impact that has not ended, if any, cut short.")
      .def("reset", &Simulation::reset, "Back to where sample 0 was found: the next sample is sample 0.")
      .def_property_readonly(
          "samples", [](const Simulation& self) { return self.simulation().samples(); }, "taken so far")
      .def_property_readonly(
          "sample_period", [](const Simulation& self) { return self.simulation().samplePeriod(); }, "s")
      .def_property_readonly(
          "in_contact", [](const Simulation& self) { return self.simulation().inContact(); }, "at the last sample")
      .def_property_readonly(
          "energy", [](const Simulation& self) { return energyOf(self.simulation().energyAccount()); },
          "the account up to the last sample, J, as HarmonicRun.energy");
}
}  // namespace
}  // namespace vibro_impact::python

PYBIND11_MODULE(_core, module)
{
  using namespace vibro_impact::python;
  registerErrors();
  defineElements();
  defineRuns(module);
  defineModel(module);
}
