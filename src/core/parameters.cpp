#include "vibro_impact/core/parameters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "parameter_faults.h"

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

// Nearer to a support, in lengths of the beam, the contact point moves by no more than rounding.
constexpr double end_margin = 1.0e-6;

double bendingStiffness(const BeamParameters& beam)
{
  return beam.youngs_modulus * beam.width * beam.height * beam.height * beam.height / 12.0;
}

double massPerLength(const BeamParameters& beam)
{
  return beam.density * beam.width * beam.height;
}

double lowestFrequency(const BeamParameters& beam)
{
  return pi * pi / (beam.length * beam.length) * std::sqrt(bendingStiffness(beam) / massPerLength(beam));
}

double contactReceptance(const BeamParameters& beam)
{
  const double a = beam.contact_location / beam.length;
  const double shape = a * (1.0 - a);
  return shape * shape * beam.length * beam.length * beam.length / (3.0 * bendingStiffness(beam));
}

class FaultFinder
{
public:
  explicit FaultFinder(const SystemParameters& parameters)
  {
    const bool beam1 = checkBeam("beam1", parameters.beam1);
    const auto* second = std::get_if<BeamParameters>(&parameters.beam2);
    const bool beam2 = second == nullptr || checkBeam("beam2", *second);
    const bool contact = checkContact(parameters.contact);
    checkDamping("damping.free", parameters.damping.free);
    checkDamping("damping.contact", parameters.damping.contact);
    std::visit([this](const auto& basis) { checkBasis(basis); }, parameters.basis);
    if (beam1 && beam2 && contact)
    {
      checkContactRatio(parameters.beam1, second, parameters.contact);
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

  bool checkBeam(const std::string& name, const BeamParameters& beam)
  {
    bool good = checkPositive(name + ".youngs_modulus", beam.youngs_modulus, "Pa");
    good &= checkPositive(name + ".density", beam.density, "kg/m^3");
    const bool has_length = checkPositive(name + ".length", beam.length, "m");
    good &= has_length;
    good &= checkPositive(name + ".height", beam.height, "m");
    good &= checkPositive(name + ".width", beam.width, "m");
    const double x = beam.contact_location;
    if (has_length)
    {
      const double margin = end_margin * beam.length;
      good &= check(x >= margin && beam.length - x >= margin, name + ".contact_location", x,
                    "a number > 0 and < " + text(beam.length) + ", the length (m), no nearer to either than " +
                        text(end_margin) + " of it");
    }
    else
    {
      good &= checkPositive(name + ".contact_location", x, "m");
    }
    if (!good)
    {
      return false;
    }
    good &= checkDerived(name + ": bending stiffness E I", bendingStiffness(beam), "N m^2");
    good &= checkDerived(name + ": mass per length rho A", massPerLength(beam), "kg/m");
    good &= checkDerived(name + ": mass", massPerLength(beam) * beam.length, "kg");
    good &= checkDerived(name + ": lowest natural frequency", lowestFrequency(beam), "rad/s");
    good &= checkDerived(name + ": static receptance of the contact point", contactReceptance(beam), "m/N");
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

  void checkContactRatio(const BeamParameters& beam1, const BeamParameters* beam2, const ContactParameters& contact)
  {
    const auto ratio = [&contact](const BeamParameters& beam)
    { return contact.stiffness * beam.length * beam.length * beam.length / bendingStiffness(beam); };
    const double greatest = beam2 == nullptr ? ratio(beam1) : std::max(ratio(beam1), ratio(*beam2));
    check(greatest >= contact_ratio_min && greatest <= contact_ratio_max,
          "contact: stiffness over that of the more flexible beam, k L^3/(E I)", greatest,
          "from " + text(contact_ratio_min, 1) + " to " + text(contact_ratio_max, 1));
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

ReferenceScales referenceScales(const BeamParameters& beam1)
{
  ReferenceScales scales;
  scales.frequency = lowestFrequency(beam1);
  scales.stiffness = 48.0 * bendingStiffness(beam1) / (beam1.length * beam1.length * beam1.length);
  scales.length = beam1.length;
  return scales;
}

}  // namespace vibro_impact::core
