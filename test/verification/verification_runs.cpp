// The cases of doc/verification.md, each played once by the library. Prints what came out, one number a line: its name
// and its value; a name that comes several times is a list. What the numbers should be, scripts/verification knows.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "common.h"
#include "independent_integrator.h"
#include "reference_system.h"
#include "vibro_impact/core/beam.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/initial_motion.h"
#include "vibro_impact/core/response.h"
#include "vibro_impact/core/simulation.h"
#include "vibro_impact/core/switched_model.h"

namespace
{
using namespace vibro_impact::core;

void print(const std::string& name, double value)
{
  std::printf("%s %.17g\n", name.c_str(), value);
}

using ModelPointer = std::shared_ptr<const SwitchedModel>;

ModelPointer modelOfModes(const std::vector<Mode>& modes, const ContactParameters& contact,
                          const DampingParameters& damping = {})
{
  return std::make_shared<const SwitchedModel>(modes, contact, damping);
}

ModelPointer modelOf(const SystemParameters& parameters)
{
  return std::make_shared<const SwitchedModel>(parameters);
}

/// A motion under a drive given by samples, joined by straight lines, from a given motion on.
struct Play
{
  ModelPointer model;
  double period;                               // between samples, s
  std::function<double(double)> acceleration;  // of time
  InitialMotion motion;
};

struct Played
{
  std::vector<double> gap;      // at every sample, the first one included
  std::vector<Impact> impacts;  // whole ones
  HistorySample last;
  double period = 0.0;

  double onset(std::size_t i) const
  {
    return static_cast<double>(impacts.at(i).interval) * period + impacts.at(i).offset;
  }
  double gapAt(double time) const
  {
    return gap.at(static_cast<std::size_t>(std::llround(time / period)));
  }
};

Played play(const Play& input, double end)
{
  const auto samples = static_cast<std::size_t>(std::llround(end / input.period)) + 1;
  std::vector<double> acceleration(samples);
  for (std::size_t i = 0; i < samples; ++i)
  {
    acceleration[i] = input.acceleration(static_cast<double>(i) * input.period);
  }
  SampledSimulation simulation(input.model, input.period);
  Recorder recorder;
  simulation.start(input.motion, recorder);
  Played result;
  result.period = input.period;
  result.gap.resize(samples);
  std::vector<double> force(samples);
  simulation.advance(acceleration.data(), samples, result.gap.data(), force.data(), recorder);
  result.last = simulation.sample();
  result.impacts = std::move(recorder.impacts);
  return result;
}

double noDrive(double /*time*/)
{
  return 0.0;
}

/// One mass (kg) on a spring (N/m), whose displacement away from a stop is the gap less the clearance.
struct Oscillator
{
  double mass;
  double stiffness;

  double frequency() const
  {
    return std::sqrt(stiffness / mass);
  }
  std::vector<Mode> modes() const
  {
    return {Mode{frequency(), 1.0 / std::sqrt(mass), std::sqrt(mass)}};
  }
  /// At its equilibrium, with a velocity away from the stop (m/s).
  InitialMotion thrown(double velocity) const
  {
    InitialMotion motion;
    motion.structure1.velocity = {velocity * std::sqrt(mass)};
    return motion;
  }
};

// Closed forms -------------------------------------------------------------------------------------------------------

void bilinearOscillator()
{
  const Oscillator oscillator{1.0, 1.0};
  const ModelPointer model = modelOfModes(oscillator.modes(), {15.0, 0.0});
  print("bilinear.free_frequency", model->free().frequency(0));
  print("bilinear.stiffness", model->stiffness());
  const Played played = play({model, 0.05, noDrive, oscillator.thrown(1.0)}, 100.0);
  print("bilinear.period", (played.onset(10) - played.onset(0)) / 10.0);
}

/// Frequencies in contact over the lowest free one.
void contactFrequencies()
{
  for (const double stiffness : {10.0, 100.0, 1.0e3, 1.0e4, 1.0e9})
  {
    const std::string key = "rigid_surface." + std::to_string(static_cast<long long>(stiffness));
    const ModelPointer conjoined = modelOf(rigidCase(stiffness, ConjoinedBasis{6, 4}));
    for (int i = 0; i < 4; ++i)
    {
      print(key + ".conjoined", conjoined->contact().frequency(i) / conjoined->scales().frequency);
    }
    const ModelPointer attachment = modelOf(rigidCase(stiffness, AttachmentBasis{5}));
    for (int i = 0; i < 4; ++i)
    {
      print(key + ".attachment", attachment->contact().frequency(i) / attachment->scales().frequency);
    }
  }
  SystemParameters identical = limitingCase(1000.0, ConjoinedBasis{12, 6});
  identical.beam2 = identical.beam1;
  const ModelPointer model = modelOf(identical);
  for (int i = 0; i < 6; ++i)
  {
    print("identical_beams.conjoined", model->contact().frequency(i) / model->scales().frequency);
  }
}

/// Of the limiting case, one drive frequency at two amplitudes.
void proportionality()
{
  HarmonicSimulation simulation(modelOf(limitingCase(1000.0, AttachmentBasis{3})));
  const double frequency = 1.2 * simulation.model().scales().frequency;
  for (const double acceleration : {1.0, 2.0})
  {
    simulation.reset();
    const ResponseRow row = harmonicResponse(simulation, frequency, acceleration, 400).row;
    print("proportionality.impulse", row.impulse_mean);
    print("proportionality.peak_force", row.peak_force);
    print("proportionality.duration", row.duration_mean);
  }
}

/// The limiting case without damping and drive, let go a little apart.
void energyOverSwitches()
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{5});
  parameters.damping = {0.0, 0.0};
  const ModelPointer model = modelOf(parameters);
  SampledSimulation simulation(model, 1.0e-4);
  Recorder recorder;
  InitialMotion motion;
  motion.structure1.displacement = {1.0e-6 / Beam(paperBeam()).mode(1).contact_deflection};
  simulation.start(motion, recorder);
  const std::vector<double> acceleration(1000, 0.0);
  std::vector<double> gap(acceleration.size());
  std::vector<double> force(acceleration.size());
  double greatest = 0.0;
  while (recorder.impacts.size() < 1000)
  {
    simulation.advance(acceleration.data(), acceleration.size(), gap.data(), force.data(), recorder);
    const EnergyAccount account = simulation.energyAccount();
    greatest = std::max(greatest, std::abs(account.stored() / account.initial - 1.0));
  }
  print("energy.greatest_change", greatest);
}

/// The account of the limiting case under its drive.
void energyAccount()
{
  for (const BasisParameters& basis : {BasisParameters{AttachmentBasis{5}}, BasisParameters{ConjoinedBasis{2, 2}}})
  {
    HarmonicSimulation simulation(modelOf(limitingCase(1000.0, basis)));
    simulation.setDrive(1.6 * simulation.model().scales().frequency, 1.0);
    Recorder recorder;
    simulation.advance(400, recorder);
    print("energy.closure", simulation.energyAccount().closure());
  }
}

/// The limiting case pressed together.
void interferenceFit()
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{5});
  parameters.contact.clearance = -1.0e-5;
  print("interference_fit.force", SampledSimulation(modelOf(parameters), 1.0e-4).sample().force);
}

// Beams --------------------------------------------------------------------------------------------------------------

/// Length, bending stiffness and mass are 1; contact at the middle.
BeamParameters unitBeam(End first, End last)
{
  BeamParameters beam;
  beam.length = 1.0;
  beam.cross_section = Section{1.0, 1.0};
  beam.contact_location = 0.5;
  beam.ends = {first, last};
  return beam;
}

void beamsOfAnyEnds()
{
  constexpr std::array<std::pair<const char*, End>, 3> ends = {
      {{"pinned", End::pinned}, {"clamped", End::clamped}, {"free", End::free}}};
  for (const auto& [first_name, first] : ends)
  {
    for (const auto& [last_name, last] : ends)
    {
      const std::string key = std::string("beam.") + first_name + "_" + last_name;
      const Beam beam(unitBeam(first, last));
      for (int m = 1; m <= beam.rigidBodyModeCount() + 4; ++m)
      {
        print(key + ".eigenvalue", std::sqrt(beam.mode(m).frequency));
      }
      print(key + ".static_receptance", beam.staticReceptance(beam.rigidBodyModeCount()));
    }
  }
}

/// A pinned beam with a rigid body at its middle; frequencies over those of the beam alone.
void beamsWithBody()
{
  const auto frequency = [](const RigidBody& body, int m)
  {
    BeamParameters beam = unitBeam(End::pinned, End::pinned);
    beam.rigid_body = body;
    return Beam(beam).mode(m).frequency / (pi * pi);
  };
  for (const double mass : {0.1, 1.0, 10.0, 1000.0})
  {
    print("body.mass", frequency({0.0, mass, 0.0}, 1));
  }
  for (const double rotary_inertia : {0.001, 0.01, 0.1})
  {
    print("body.rotary_inertia", frequency({0.0, 0.0, rotary_inertia}, 2));
  }
  print("body.length", frequency({0.3, 0.5, 0.01}, 1));
  for (const double size : {1.0e-2, 1.0e-4, 1.0e-6})
  {
    double greatest = 0.0;
    for (int m = 1; m <= 5; ++m)
    {
      greatest = std::max(greatest, std::abs(frequency({size, size, std::pow(size, 3.0)}, m) / (m * m) - 1.0));
    }
    print("body.limit", greatest);
  }
}

// Other codes' published transients ----------------------------------------------------------------------------------

/// Code_Aster SDND101: thrown at a stop that it touches.
void massThrownAtAStop()
{
  const Oscillator oscillator{100.0, 1.0e4};
  const ModelPointer model = modelOfModes(oscillator.modes(), {1.0e6, 0.0});
  const Played played = play({model, 0.01, noDrive, oscillator.thrown(-1.0)}, 0.5);
  for (std::size_t i = 0; i < 2; ++i)
  {
    const Impact& impact = played.impacts.at(i);
    print("sdnd101.peak_time", played.onset(i) + impact.peak_time);
    print("sdnd101.peak_force", impact.peak_force);
    print("sdnd101.duration", impact.duration);
    print("sdnd101.impulse", impact.impulse);
    print("sdnd101.approach_speed", impact.approach_speed);
  }
}

/// Code_Aster SDND102, problem 2: two masses on springs, whose anchors move against each other.
void twoMasses()
{
  const double mass = 25.0;
  const double frequency = std::sqrt(98696.0 / mass);
  const double damping = 0.07;
  const double drive = 20.0 * pi;
  const double stiffness = 2.88e7;
  const double clearance = 1.0e-3;
  // The anchor of the left mass has the acceleration sin(drive t), that of the right one the opposite. Displacements
  // are absolute: what an anchor does to its mass goes by the spring and the damper between them.
  const auto acceleration = [&](double time)
  {
    const double displacement = -std::sin(drive * time) / (drive * drive);
    const double velocity = -std::cos(drive * time) / drive;
    return -(frequency * frequency * displacement + 2.0 * damping * frequency * velocity);
  };
  // A damper that is the same in contact makes a smaller ratio there, for the mode that moves the gap.
  const double contact_frequency = std::sqrt(frequency * frequency + 2.0 * stiffness / mass);
  const std::vector<Mode> modes = {Mode{frequency, 1.0 / std::sqrt(mass), -std::sqrt(mass)},
                                   Mode{frequency, -1.0 / std::sqrt(mass), std::sqrt(mass)}};
  const ModelPointer model =
      modelOfModes(modes, {stiffness, clearance}, {damping, damping * frequency / contact_frequency});
  InitialMotion motion;  // the masses start with their anchors, away from each other
  motion.structure1.velocity = {std::sqrt(mass) / drive, -std::sqrt(mass) / drive};
  const Played played = play({model, 1.0e-5, acceleration, motion}, 1.0);
  for (const double time : {0.05, 0.156, 0.25, 0.4, 0.5, 0.8, 0.9, 1.0})
  {
    print("sdnd102.displacement", 0.5 * (clearance - played.gapAt(time)));
  }
}

/// Code_Aster SDND108: a free mass falls on an elastic ground.
void fallingMass()
{
  const Oscillator oscillator{1.0, 0.0};
  const double height = 2.0;
  const ModelPointer model = modelOfModes(oscillator.modes(), {100.0, height});
  const auto gravity = [](double /*time*/) { return 10.0; };  // a base that rises
  const Played played = play({model, 0.05, gravity, oscillator.thrown(-1.0)}, 1.1);
  print("sdnd108.onset", played.onset(0));
  print("sdnd108.release", played.onset(0) + played.impacts.front().duration);
  print("sdnd108.displacement", played.gapAt(1.0) - height);
  print("sdnd108.displacement", played.gapAt(1.1) - height);
}

/// Code_Aster SDND121: a mass under a harmonic force against a very stiff stop.
void forcedMass()
{
  const Oscillator oscillator{156.0, 2.0e6};
  const ModelPointer model = modelOfModes(oscillator.modes(), {1.0e10, 1.0e-3});
  // The force is positive towards the stop, as -m a is for an acceleration a away from it.
  const auto acceleration = [&](double time) { return 3.0e3 * std::sin(10.0 * pi * time) / oscillator.mass; };
  const Played played = play({model, 1.0e-6, acceleration, {}}, 4.0);
  for (std::size_t i = 0; i < played.impacts.size(); ++i)
  {
    print("sdnd121.switch_time", played.onset(i));
    print("sdnd121.switch_time", played.onset(i) + played.impacts[i].duration);
  }
}

/// Code_Aster SDND122: free vibration of a given energy against a stop.
void freeVibrationAgainstAStop()
{
  const Oscillator oscillator{1.0, 10.0};
  const double energy = 0.00650108331626;
  const ModelPointer model = modelOfModes(oscillator.modes(), {50.0, 0.01});
  const double speed = std::sqrt(2.0 * energy / oscillator.mass);
  const Played played = play({model, 0.01, noDrive, oscillator.thrown(-speed)}, 20.0);
  print("sdnd122.frequency", 10.0 / (played.onset(10) - played.onset(0)));
}

/// Code_Aster SDNL104: a cantilever under a constant force at its tip, which is 0.1 mm above an elastic stop.
void cantileverOnAStop()
{
  const double radius = 0.1;
  const double force = -1000.0;
  BeamParameters parameters;
  parameters.youngs_modulus = 1.0e10;
  parameters.density = 1.0e6;
  parameters.length = 1.0;
  parameters.cross_section = Tube{2.0 * radius, radius, 0.0};
  parameters.contact_location = parameters.length;
  parameters.ends = {End::clamped, End::free};
  const Beam beam(parameters);
  std::vector<Mode> modes;
  for (int m = 1; m <= 80; ++m)
  {
    modes.push_back(beam.mode(m));
    modes.back().participation = -modes.back().contact_deflection * force;
  }
  const ModelPointer model = modelOfModes(modes, {1.0e8, 1.0e-4});
  const auto unit = [](double /*time*/) { return 1.0; };
  print("sdnl104.displacement", play({model, 1.0e-4, unit, {}}, 0.1315).last.gap - model->clearance());
  print("sdnl104.velocity", play({model, 1.0e-4, unit, {}}, 0.1566).last.gap_velocity);
}

// Two beams against independent integrators --------------------------------------------------------------------------

struct TwoBeams
{
  std::string name;
  ModelPointer model;
  double omega_star;
  int cycles;
};

/// The lowest modes of both beams and nothing else.
ModelPointer freeModes(const SystemParameters& parameters, int modes_per_beam)
{
  std::vector<Mode> modes;
  const Beam beam1(std::get<BeamParameters>(parameters.beam1));
  const Beam beam2(std::get<BeamParameters>(parameters.beam2));
  for (int m = 1; m <= modes_per_beam; ++m)
  {
    modes.push_back(beam1.mode(m));
    Mode mode = beam2.mode(m);
    mode.contact_deflection *= -1.0;
    modes.push_back(mode);
  }
  return modelOfModes(modes, parameters.contact, parameters.damping);
}

void twoBeams(const TwoBeams& input)
{
  const double frequency = input.omega_star * Beam(paperBeam()).mode(1).frequency;
  const double cycle = 2.0 * pi / frequency;

  HarmonicSimulation simulation(input.model);
  simulation.setDrive(frequency, 1.0);
  Recorder recorder;
  simulation.advance(static_cast<std::uint64_t>(input.cycles), recorder);
  for (const Impact& impact : recorder.impacts)
  {
    print(input.name + ".library.onset", (static_cast<double>(impact.interval) * cycle + impact.offset) / cycle);
    print(input.name + ".library.impulse", impact.impulse);
  }

  Integrator integrator(input.model, [frequency](double time) { return -std::cos(frequency * time); });
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(input.model->free().size());
  integrator.startFree(rest, rest);
  for (int i = 1; i <= input.cycles; ++i)
  {
    integrator.advance(i * cycle);
  }
  for (const Episode& episode : integrator.episodes())
  {
    print(input.name + ".fehlberg.onset", episode.onset / cycle);
    print(input.name + ".fehlberg.impulse", episode.impulse);
  }
}

/// The paper's two beams with k* = k L^3/(E I) and a clearance in static deflections of beam 1 under 1 m/s^2,
/// a/omega_11^2.
SystemParameters paperBeams(double stiffness, double clearance)
{
  SystemParameters parameters = limitingCase(stiffness, AttachmentBasis{2});
  parameters.contact.clearance = clearance / std::pow(Beam(paperBeam()).mode(1).frequency, 2.0);
  return parameters;
}

void integrators()
{
  twoBeams({"two_beams.soft", modelOf(paperBeams(1000.0, 0.3)), 1.6, 6});
  twoBeams({"two_beams.stiff", freeModes(paperBeams(73223.0, 0.3), 3), 0.8, 5});
  SystemParameters off_centre = paperBeams(1000.0, 0.3);
  std::get<BeamParameters>(off_centre.beam1).contact_location = 0.02;
  std::get<BeamParameters>(off_centre.beam2).contact_location = 0.03;
  twoBeams({"two_beams.off_centre", modelOf(off_centre), 1.6, 6});
}

}  // namespace

int main()
{
  bilinearOscillator();
  contactFrequencies();
  proportionality();
  energyOverSwitches();
  energyAccount();
  interferenceFit();
  beamsOfAnyEnds();
  beamsWithBody();
  massThrownAtAStop();
  twoMasses();
  fallingMass();
  forcedMass();
  freeVibrationAgainstAStop();
  cantileverOnAStop();
  integrators();
  return 0;
}
