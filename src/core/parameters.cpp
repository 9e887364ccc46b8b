#include "vibro_impact/core/parameters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "parameter_faults.h"
#include "vibro_impact/core/beam.h"
#include "vibro_impact/core/modal_table.h"

namespace vibro_impact::core
{
namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr int most_modes = 100;

// Derived quantities stay where their fourth powers and quotients are still ordinary numbers.
constexpr double derived_min = 1.0e-60;
constexpr double derived_max = 1.0e+60;

// k L^3/(E I) outside of this is, in double precision, no spring at all or a rigid one whose force is rounding noise.
constexpr double contact_ratio_min = 1.0e-6;
constexpr double contact_ratio_max = 1.0e+10;

// Nearer to a support, in lengths of the beam, the contact point moves by no more than rounding; near a clamped end
// shapes grow with the square of the distance.
constexpr double pinned_margin = 1.0e-6;
constexpr double clamped_margin = 1.0e-3;

// Body over beam in mass, and in rotary inertia over m' L^3: beyond, the beam is a spring to double precision.
constexpr double heaviest_body = 1.0e+6;
constexpr double longest_body = 0.999;

constexpr std::size_t longest_table = 10000;

double sectionArea(const Tube& tube)
{
  return pi * tube.wall_thickness * (tube.outer_diameter - tube.wall_thickness);
}

struct BendingStiffness
{
  double youngs_modulus;

  double operator()(const Rectangle& section) const
  {
    return youngs_modulus * section.width * section.height * section.height * section.height / 12.0;
  }
  double operator()(const Tube& tube) const
  {
    // I = pi (D^4 - d^4)/64 = A (D^2 + d^2)/16
    const double inner = tube.outer_diameter - 2.0 * tube.wall_thickness;
    return youngs_modulus * sectionArea(tube) * (tube.outer_diameter * tube.outer_diameter + inner * inner) / 16.0;
  }
  double operator()(const Section& section) const
  {
    return section.bending_stiffness;
  }
};

struct MassPerLength
{
  double density;

  double operator()(const Rectangle& section) const
  {
    return density * section.width * section.height;
  }
  double operator()(const Tube& tube) const
  {
    return density * sectionArea(tube) + tube.added_mass_per_length;
  }
  double operator()(const Section& section) const
  {
    return section.mass_per_length;
  }
};

/// The same beam with the contact at midspan, which a body at its middle carries.
BeamParameters withContactAtMidspan(BeamParameters beam)
{
  beam.contact_location = 0.5 * beam.length;
  return beam;
}

double lowestElasticFrequency(const Structure& structure)
{
  const int elastic = structure.rigidBodyModeCount() + 1;
  return elastic <= structure.modeCount() ? structure.mode(elastic).frequency : 0.0;
}

/// The scales of one structure; nothing where it has no elastic mode that moves its contact point.
std::optional<ReferenceScales> scalesOf(const StructureParameters& parameters)
{
  ReferenceScales scales;
  if (const auto* beam = std::get_if<BeamParameters>(&parameters))
  {
    const Beam midspan(withContactAtMidspan(*beam));
    scales.frequency = lowestElasticFrequency(midspan);
    scales.stiffness = 1.0 / midspan.staticReceptance(midspan.rigidBodyModeCount());
    scales.length = beam->length;
    return scales;
  }
  if (const auto* table = std::get_if<ModalTableParameters>(&parameters))
  {
    const ModalTable structure(*table);
    scales.frequency = lowestElasticFrequency(structure);
    scales.stiffness = 1.0 / structure.staticReceptance(structure.rigidBodyModeCount());
    if (scales.frequency > 0.0 && std::isfinite(scales.stiffness))
    {
      return scales;
    }
  }
  return std::nullopt;
}

class FaultFinder
{
public:
  explicit FaultFinder(const SystemParameters& parameters)
  {
    const bool beam1 = checkStructure("beam1", parameters.beam1);
    const bool beam2 = checkStructure("beam2", parameters.beam2);
    if (std::holds_alternative<RigidSurface>(parameters.beam1) &&
        std::holds_alternative<RigidSurface>(parameters.beam2))
    {
      faults_.push_back({"beam2", "rigid", "a beam or a modal table where beam1 is rigid, too: nothing could move"});
    }
    const bool contact = checkContact(parameters.contact);
    checkDamping("damping.free", parameters.damping.free);
    checkDamping("damping.contact", parameters.damping.contact);
    std::visit([this](const auto& basis) { checkBasis(basis); }, parameters.basis);
    if (beam1 && beam2 && contact)
    {
      checkContactRatio(parameters);
    }
  }

  std::vector<ParameterFault> take()
  {
    return std::move(faults_);
  }

private:
  bool check(bool good, const std::string& key, double value, const std::string& allowed)
  {
    if (!good)
    {
      faults_.push_back({key, text(value), allowed});
    }
    return good;
  }

  bool checkPositive(const std::string& key, double value, const std::string& unit)
  {
    return check(std::isfinite(value) && value > 0.0, key, value, "a finite number > 0 (" + unit + ")");
  }

  bool checkDerived(const std::string& key, double value, const std::string& unit)
  {
    return check(value >= derived_min && value <= derived_max, key, value,
                 "from " + text(derived_min, 1) + " to " + text(derived_max, 1) + " (" + unit + ")");
  }

  bool checkNotNegative(const std::string& key, double value, const std::string& unit)
  {
    return check(std::isfinite(value) && value >= 0.0, key, value, "a finite number >= 0 (" + unit + ")");
  }

  bool checkStructure(const std::string& name, const StructureParameters& parameters)
  {
    return std::visit([this, &name](const auto& kind) { return this->checkKind(name, kind); }, parameters);
  }

  static bool checkKind(const std::string& /*name*/, const RigidSurface& /*surface*/)
  {
    return true;
  }

  bool checkKind(const std::string& name, const BeamParameters& beam)
  {
    bool good = true;
    if (!std::holds_alternative<Section>(beam.cross_section))
    {
      good &= checkPositive(name + ".youngs_modulus", beam.youngs_modulus, "Pa");
      good &= checkPositive(name + ".density", beam.density, "kg/m^3");
    }
    const bool has_length = checkPositive(name + ".length", beam.length, "m");
    good &= has_length;
    good &= std::visit([this, &name](const auto& section) { return checkSection(name, section); }, beam.cross_section);
    if (!has_length)
    {
      checkNotNegative(name + ".contact_location", beam.contact_location, "m");
      return false;
    }
    good &= beam.rigid_body ? checkBody(name, beam) : checkLocation(name, beam);
    if (!good)
    {
      return false;
    }
    good &= checkDerived(name + ": bending stiffness E I", bendingStiffness(beam), "N m^2");
    good &= checkDerived(name + ": mass per length rho A", massPerLength(beam), "kg/m");
    good &= checkDerived(name + ": mass", massPerLength(beam) * beam.length, "kg");
    if (beam.rigid_body && good)
    {
      const double mass = massPerLength(beam) * beam.length;
      good &= check(beam.rigid_body->mass <= heaviest_body * mass, name + ".rigid_body.mass", beam.rigid_body->mass,
                    "at most " + text(heaviest_body) + " times that of the beam, " + text(mass) + " (kg)");
      const double inertia = mass * beam.length * beam.length;
      good &= check(
          beam.rigid_body->rotary_inertia <= heaviest_body * inertia, name + ".rigid_body.rotary_inertia",
          beam.rigid_body->rotary_inertia,
          "at most " + text(heaviest_body) + " times mass times length^2 of the beam, " + text(inertia) + " (kg m^2)");
    }
    if (good)
    {
      const Beam structure(beam);
      good &= checkDerived(name + ": lowest natural frequency", lowestElasticFrequency(structure), "rad/s");
      good &= checkDerived(name + ": static receptance of the contact point",
                           structure.staticReceptance(structure.rigidBodyModeCount()), "m/N");
    }
    return good;
  }

  bool checkSection(const std::string& name, const Rectangle& section)
  {
    const bool height = checkPositive(name + ".height", section.height, "m");
    return checkPositive(name + ".width", section.width, "m") && height;
  }

  bool checkSection(const std::string& name, const Tube& tube)
  {
    bool good = checkPositive(name + ".tube.outer_diameter", tube.outer_diameter, "m");
    good &= checkPositive(name + ".tube.wall_thickness", tube.wall_thickness, "m") &&
            (!good ||
             check(2.0 * tube.wall_thickness <= tube.outer_diameter, name + ".tube.wall_thickness", tube.wall_thickness,
                   "at most half the outer diameter, " + text(0.5 * tube.outer_diameter) + " (m)"));
    return checkNotNegative(name + ".tube.added_mass_per_length", tube.added_mass_per_length, "kg/m") && good;
  }

  bool checkSection(const std::string& name, const Section& section)
  {
    const bool stiffness = checkPositive(name + ".section.bending_stiffness", section.bending_stiffness, "N m^2");
    return checkPositive(name + ".section.mass_per_length", section.mass_per_length, "kg/m") && stiffness;
  }

  bool checkLocation(const std::string& name, const BeamParameters& beam)
  {
    const auto margin = [](End end)
    { return end == End::free ? 0.0 : (end == End::clamped ? clamped_margin : pinned_margin); };
    const double first = margin(beam.ends[0]);
    const double last = margin(beam.ends[1]);
    const double x = beam.contact_location;
    const std::string length = text(beam.length) + ", the length (m)";
    const std::string low = first > 0.0 ? "> 0" : ">= 0";
    const std::string high = (last > 0.0 ? "< " : "<= ") + length;
    std::string nearest;
    if (first > 0.0 && first == last)
    {
      nearest = ", no nearer to either than " + text(first) + " of it";
    }
    else
    {
      nearest += first > 0.0 ? ", no nearer to the first end than " + text(first) + " of it" : "";
      nearest += last > 0.0 ? ", no nearer to the second end than " + text(last) + " of it" : "";
    }
    return check(x >= first * beam.length && beam.length - x >= last * beam.length, name + ".contact_location", x,
                 "a number " + low + " and " + high + nearest);
  }

  bool checkBody(const std::string& name, const BeamParameters& beam)
  {
    const RigidBody& body = *beam.rigid_body;
    const bool length =
        check(body.length >= 0.0 && body.length <= longest_body * beam.length, name + ".rigid_body.length", body.length,
              "a number >= 0 and <= " + text(longest_body * beam.length) + ", which is " + text(longest_body) +
                  " of the beam's length (m)");
    bool good = checkNotNegative(name + ".rigid_body.mass", body.mass, "kg");
    good &= checkNotNegative(name + ".rigid_body.rotary_inertia", body.rotary_inertia, "kg m^2");
    if (!length)
    {
      return false;
    }
    const double middle = 0.5 * beam.length;
    const double reach = 0.5 * body.length;
    return check(std::abs(beam.contact_location - middle) <= reach + 1.0e-9 * beam.length, name + ".contact_location",
                 beam.contact_location,
                 "on the rigid body, from " + text(middle - reach) + " to " + text(middle + reach) + " (m)") &&
           good;
  }

  bool checkKind(const std::string& name, const ModalTableParameters& table)
  {
    const std::string key = name + ".modal_table";
    const std::size_t size = table.frequency_hz.size();
    if (size < 1 || size > longest_table)
    {
      faults_.push_back(
          {key + ": number of modes", std::to_string(size), "from 1 to " + std::to_string(longest_table)});
      return false;
    }
    bool good = true;
    const auto has_size = [&](const std::string& column, std::size_t length, bool optional)
    {
      if (length != size && !(optional && length == 0))
      {
        faults_.push_back({key + "." + column + ": number of values", std::to_string(length),
                           std::to_string(size) + ", as many as frequencies"});
        good = false;
      }
    };
    has_size("contact_deflection", table.contact_deflection.size(), false);
    has_size("participation", table.participation.size(), false);
    has_size("damping_ratio", table.damping_ratio.size(), true);
    const auto entry = [&key](const std::string& column, std::size_t m)
    { return key + "." + column + "[" + std::to_string(m + 1) + "]"; };
    const auto each =
        [&](const std::string& column, const std::vector<double>& values, auto allowed, const std::string& what)
    {
      for (std::size_t m = 0; m < values.size(); ++m)
      {
        good &= check(allowed(values[m]), entry(column, m), values[m], what);
      }
    };
    const auto ordinary = [](double value) { return value >= derived_min && value <= derived_max; };
    const std::string range = text(derived_min, 1) + " to " + text(derived_max, 1);
    each(
        "frequency_hz", table.frequency_hz, [&](double value) { return value == 0.0 || ordinary(value); },
        "0, for a rigid-body mode, or from " + range + " (Hz)");
    const auto shape = [&](double value) { return value == 0.0 || ordinary(std::abs(value)); };
    each("contact_deflection", table.contact_deflection, shape, "0 or of a size from " + range + " (kg^-1/2)");
    each("participation", table.participation, shape, "0 or of a size from " + range + " (kg^1/2)");
    each(
        "damping_ratio", table.damping_ratio, [](double value) { return value >= 0.0 && value < 1.0; },
        "a number >= 0 and < 1 (ratio of critical damping)");
    if (!good)
    {
      return false;
    }
    if (std::all_of(table.contact_deflection.begin(), table.contact_deflection.end(),
                    [](double value) { return value == 0.0; }))
    {
      faults_.push_back({key + ".contact_deflection", "0 in every mode",
                         "other than 0 in at least one: no mode moves the contact point"});
      return false;
    }
    const double known = elasticReceptance(table);
    if (known > 0.0)
    {
      good &= checkDerived(key + ": static receptance of its modes", known, "m/N");
    }
    if (table.static_receptance)
    {
      const double least = known * (1.0 - table_rounding);
      const bool elastic = std::any_of(table.frequency_hz.begin(), table.frequency_hz.end(),
                                       [](double frequency) { return frequency > 0.0; });
      good &= check(ordinary(*table.static_receptance) && *table.static_receptance >= least && elastic,
                    key + ".static_receptance", *table.static_receptance,
                    elastic ? "a number >= " + text(known) + " (m/N), which its modes have by themselves"
                            : "left out where all modes are rigid-body modes");
    }
    return good;
  }

  bool checkContact(const ContactParameters& contact)
  {
    bool good = checkPositive("contact.stiffness", contact.stiffness, "N/m");
    good &= check(std::isfinite(contact.clearance), "contact.clearance", contact.clearance,
                  "a finite number (m); negative for an interference fit");
    if (good && contact.clearance != 0.0)
    {
      good &= checkDerived("contact: stiffness times clearance, without sign",
                           std::abs(contact.stiffness * contact.clearance), "N");
    }
    return good;
  }

  void checkDamping(const std::string& key, double ratio)
  {
    check(ratio >= 0.0 && ratio < 1.0, key, ratio, "a number >= 0 and < 1 (ratio of critical damping)");
  }

  void checkModes(const std::string& key, int modes)
  {
    check(modes >= 1 && modes <= most_modes, key, modes, "a whole number from 1 to " + std::to_string(most_modes));
  }

  void checkBasis(const ConjoinedBasis& basis)
  {
    checkModes("basis.modes_free", basis.modes_free);
    checkModes("basis.modes_contact", basis.modes_contact);
  }

  void checkBasis(const AttachmentBasis& basis)
  {
    checkModes("basis.modes_per_beam", basis.modes_per_beam);
  }

  /// Of k in that of a structure; nothing where it has none that an elastic mode gives it.
  static std::optional<double> contactRatio(const StructureParameters& parameters, double stiffness)
  {
    if (const auto* beam = std::get_if<BeamParameters>(&parameters))
    {
      return stiffness * beam->length * beam->length * beam->length / bendingStiffness(*beam);
    }
    if (const auto* table = std::get_if<ModalTableParameters>(&parameters))
    {
      const double receptance = std::max(elasticReceptance(*table), table->static_receptance.value_or(0.0));
      return receptance > 0.0 ? std::optional<double>(48.0 * stiffness * receptance) : std::nullopt;
    }
    return std::nullopt;
  }

  void checkContactRatio(const SystemParameters& parameters)
  {
    std::optional<double> greatest;
    bool beams = true;
    for (const StructureParameters* structure : {&parameters.beam1, &parameters.beam2})
    {
      const std::optional<double> ratio = contactRatio(*structure, parameters.contact.stiffness);
      beams &= !std::holds_alternative<ModalTableParameters>(*structure);
      if (ratio && (!greatest || *ratio > *greatest))
      {
        greatest = ratio;
      }
    }
    if (greatest)
    {
      check(*greatest >= contact_ratio_min && *greatest <= contact_ratio_max,
            std::string("contact: stiffness over that of the more flexible ") +
                (beams ? "beam, k L^3/(E I)" : "structure, k L^3/(E I) or 48 k times the receptance of a modal table"),
            *greatest, "from " + text(contact_ratio_min, 1) + " to " + text(contact_ratio_max, 1));
    }
  }

  std::vector<ParameterFault> faults_;
};

}  // namespace

std::vector<ParameterFault> findFaults(const SystemParameters& parameters)
{
  return FaultFinder(parameters).take();
}

void validate(const SystemParameters& parameters)
{
  throwIfAny(findFaults(parameters));
}

double bendingStiffness(const BeamParameters& beam)
{
  return std::visit(BendingStiffness{beam.youngs_modulus}, beam.cross_section);
}

double massPerLength(const BeamParameters& beam)
{
  return std::visit(MassPerLength{beam.density}, beam.cross_section);
}

ReferenceScales referenceScales(const SystemParameters& parameters)
{
  for (const StructureParameters* structure : {&parameters.beam1, &parameters.beam2})
  {
    if (const std::optional<ReferenceScales> scales = scalesOf(*structure))
    {
      return *scales;
    }
  }
  return ReferenceScales{};
}

}  // namespace vibro_impact::core
