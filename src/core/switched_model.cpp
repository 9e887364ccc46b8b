#include "vibro_impact/core/switched_model.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "vibro_impact/core/characteristic_equation.h"
#include "vibro_impact/core/pinned_beam.h"

namespace vibro_impact::core
{
namespace
{
/// A structure with the sign s_i with which its contact deflection enters the gap.
struct SignedStructure
{
  std::unique_ptr<const Structure> structure;
  double sign;
};

/// One coordinate of the free state: frequency, gap per unit coordinate b = s phi(x_c), participation.
using Coordinates = std::vector<Mode>;

/// Frequencies are equal if they differ by no more than this share of themselves: what rounding makes of those of two
/// beams that differ in scale or mirror each other.
constexpr double equal_frequencies = 1.0e-12;

/// Where they are equal, a base motion that moves the gap by no more than this share of what it moves the structures
/// does not move it at all. It is the gap of contact points that are off each other by such a share of the length.
constexpr double common_motion = 1.0e-9;

std::vector<SignedStructure> makeStructures(const SystemParameters& parameters)
{
  std::vector<SignedStructure> structures;
  structures.push_back({std::make_unique<PinnedBeam>(parameters.beam1), +1.0});
  if (const auto* beam2 = std::get_if<BeamParameters>(&parameters.beam2))
  {
    structures.push_back({std::make_unique<PinnedBeam>(*beam2), -1.0});
  }
  return structures;
}

Mode gapMode(const SignedStructure& side, int m)
{
  Mode mode = side.structure->mode(m);
  mode.contact_deflection *= side.sign;
  return mode;
}

/// What the modes above the lowest `kept` ones do far below their frequencies: coefficients of the power series in
/// omega^2 of
///   sum_{m > kept} phi_m^2/(omega_m^2 - omega^2)   and   sum_{m > kept} phi_m Gamma_m/(omega_m^2 - omega^2).
struct Residual
{
  std::vector<double> receptance;
  std::vector<double> base_response;
};

Residual residual(const Structure& structure, int kept, int orders)
{
  const auto size = static_cast<std::size_t>(orders);
  Residual result{std::vector<double>(size, 0.0), std::vector<double>(size, 0.0)};
  result.receptance[0] = structure.staticReceptance(kept);
  result.base_response[0] = structure.staticBaseResponse(kept);

  // The higher orders fall at least as m^-8 (m^-9 the second); forty times the kept modes leave less than 1e-11 of
  // them.
  const int last = structure.modeCount() == Structure::unlimited ? 40 * (kept + 1) : structure.modeCount();
  for (int m = last; m > kept; --m)  // small terms first
  {
    const Mode mode = structure.mode(m);
    const double compliance = 1.0 / (mode.frequency * mode.frequency);
    double factor = compliance;
    for (std::size_t order = 1; order < size; ++order)
    {
      factor *= compliance;
      result.receptance[order] += factor * mode.contact_deflection * mode.contact_deflection;
      result.base_response[order] += factor * mode.contact_deflection * mode.participation;
    }
  }
  return result;
}

/// Coordinates of equal frequency are rotated so that one of them carries the whole motion of the gap and the others
/// leave it unchanged; any such rotation is as orthogonal as the modes were. What does not move the gap then says so
/// exactly: two structures that move alike have no rounding noise between them.
void separateEqualFrequencies(Coordinates& coordinates)
{
  std::stable_sort(coordinates.begin(), coordinates.end(),
                   [](const Mode& a, const Mode& b) { return a.frequency < b.frequency; });
  for (std::size_t first = 0, last = 0; first < coordinates.size(); first = last)
  {
    double deflection_squared = 0.0;
    double participation_squared = 0.0;
    double product = 0.0;
    const double highest = coordinates[first].frequency * (1.0 + equal_frequencies);
    for (last = first; last < coordinates.size() && coordinates[last].frequency <= highest; ++last)
    {
      const Mode& mode = coordinates[last];
      deflection_squared += mode.contact_deflection * mode.contact_deflection;
      participation_squared += mode.participation * mode.participation;
      product += mode.contact_deflection * mode.participation;
    }
    if (last - first < 2)
    {
      continue;
    }
    const double deflection = std::sqrt(deflection_squared);
    const double participation = std::sqrt(participation_squared);
    const bool moves_gap = std::abs(product) > common_motion * deflection * participation;
    const double relative = moves_gap ? product / deflection : 0.0;
    const double common = std::sqrt(std::max(0.0, participation_squared - relative * relative));
    for (std::size_t i = first; i < last; ++i)
    {
      coordinates[i] = Mode{coordinates[first].frequency, 0.0, 0.0};
    }
    coordinates[first].contact_deflection = deflection;
    coordinates[first].participation = relative;
    coordinates[first + 1].participation = common;
  }
}

/// The static deflection of a structure under a unit force at the contact, less its part in the kept modes,
/// mass-normalised. Its mass is sum phi^2/omega^4 and its strain energy (twice) sum phi^2/omega^2 over the modes above
/// the kept ones.
Mode attachmentShape(const SignedStructure& side, int kept)
{
  const Residual rest = residual(*side.structure, kept, 2);
  const double norm = std::sqrt(rest.receptance[1]);
  Mode shape;
  shape.frequency = std::sqrt(rest.receptance[0]) / norm;
  shape.contact_deflection = side.sign * rest.receptance[0] / norm;
  shape.participation = rest.base_response[0] / norm;
  return shape;
}

LinearState makeState(const Coordinates& coordinates, double damping_ratio)
{
  const auto size = static_cast<Eigen::Index>(coordinates.size());
  LinearState state;
  state.frequency.resize(size);
  state.contact_deflection.resize(size);
  state.participation.resize(size);
  for (Eigen::Index n = 0; n < size; ++n)
  {
    const Mode& mode = coordinates[static_cast<std::size_t>(n)];
    state.frequency(n) = mode.frequency;
    state.contact_deflection(n) = mode.contact_deflection;
    state.participation(n) = mode.participation;
  }
  state.damping_ratio = Eigen::ArrayXd::Constant(size, damping_ratio);
  state.preload = Eigen::ArrayXd::Zero(size);
  return state;
}

/// A mode of the state in contact before it is put in order: its shape in the coordinates of the free state.
struct ContactMode
{
  Mode mode;
  Eigen::VectorXd shape;
};

/// Sorts, cuts to the lowest `count`, and splits into the linear state and the mapping.
void assembleContactState(std::vector<ContactMode> modes, std::size_t count, const ContactParameters& spring,
                          double damping_ratio, LinearState& state, Eigen::MatrixXd& mapping)
{
  std::stable_sort(modes.begin(), modes.end(),
                   [](const ContactMode& a, const ContactMode& b) { return a.mode.frequency < b.mode.frequency; });
  modes.resize(std::min(count, modes.size()));
  Coordinates coordinates;
  mapping.resize(modes.front().shape.size(), static_cast<Eigen::Index>(modes.size()));
  for (std::size_t n = 0; n < modes.size(); ++n)
  {
    coordinates.push_back(modes[n].mode);
    mapping.col(static_cast<Eigen::Index>(n)) = modes[n].shape;
  }
  state = makeState(coordinates, damping_ratio);
  state.preload = -spring.stiffness * spring.clearance * state.contact_deflection;
}

/// Where in `coordinates` those are that move the gap; the others keep frequency and shape in both states.
std::vector<std::size_t> gapCoordinates(const Coordinates& coordinates)
{
  std::vector<std::size_t> indices;
  for (std::size_t n = 0; n < coordinates.size(); ++n)
  {
    if (coordinates[n].contact_deflection != 0.0)
    {
      indices.push_back(n);
    }
  }
  return indices;
}

struct PoleData
{
  Eigen::ArrayXd poles;
  Eigen::ArrayXd deflections;
  Eigen::ArrayXd participations;
};

PoleData gather(const Coordinates& coordinates, const std::vector<std::size_t>& indices)
{
  const auto size = static_cast<Eigen::Index>(indices.size());
  PoleData data{Eigen::ArrayXd(size), Eigen::ArrayXd(size), Eigen::ArrayXd(size)};
  for (Eigen::Index i = 0; i < size; ++i)
  {
    const Mode& mode = coordinates[indices[static_cast<std::size_t>(i)]];
    data.poles(i) = mode.frequency * mode.frequency;
    data.deflections(i) = mode.contact_deflection;
    data.participations(i) = mode.participation;
  }
  return data;
}

std::vector<ContactMode> unchangedModes(const Coordinates& coordinates, std::size_t rows)
{
  std::vector<ContactMode> modes;
  for (std::size_t n = 0; n < coordinates.size(); ++n)
  {
    if (coordinates[n].contact_deflection == 0.0)
    {
      ContactMode unchanged{coordinates[n], Eigen::VectorXd::Zero(static_cast<Eigen::Index>(rows))};
      if (n < rows)
      {
        unchanged.shape(static_cast<Eigen::Index>(n)) = 1.0;
      }
      modes.push_back(std::move(unchanged));
    }
  }
  return modes;
}

/// Ritz modes of the space that `coordinates` span: the eigenvectors of diag(omega^2) + k b b^T.
std::vector<ContactMode> ritzModes(const Coordinates& coordinates, double stiffness)
{
  const std::vector<std::size_t> indices = gapCoordinates(coordinates);
  const PoleData data = gather(coordinates, indices);
  const auto size = static_cast<Eigen::Index>(indices.size());
  const CharacteristicEquation equation(stiffness, data.poles, data.deflections);

  Eigen::ArrayXXd distances(size, size);  // p_m - x_n
  Eigen::ArrayXd frequencies(size);
  for (Eigen::Index n = 0; n < size; ++n)
  {
    const CharacteristicEquation::Root root = equation.root(n);
    distances.col(n) = equation.distances(root);
    frequencies(n) = std::sqrt(equation.value(root));
  }

  // Roots are rounded, and vectors made of them with the given b would be orthogonal only as far as the roots are
  // apart. The b that belongs to the rounded roots exactly (Loewner's formula) differs from it by rounding and gives
  // vectors that are orthogonal to the last bits: M. Gu and S. C. Eisenstat, SIAM J. Matrix Anal. Appl. 15 (1994),
  // 1266-1276, section 3.
  //   b_m^2 = 1/k prod_n (x_n - p_m) / prod_{i != m} (p_i - p_m),   taken in pairs so that nothing over- or underflows
  Eigen::ArrayXd deflections(size);
  for (Eigen::Index m = 0; m < size; ++m)
  {
    double square = -distances(m, size - 1) / stiffness;
    for (Eigen::Index n = 0; n < size - 1; ++n)
    {
      const Eigen::Index i = n < m ? n : n + 1;
      square *= -distances(m, n) / (data.poles(i) - data.poles(m));
    }
    deflections(m) = std::copysign(std::sqrt(square), data.deflections(m));
  }

  std::vector<ContactMode> modes = unchangedModes(coordinates, coordinates.size());
  for (Eigen::Index n = 0; n < size; ++n)
  {
    const Eigen::ArrayXd quotient = deflections / distances.col(n);
    const double norm = std::sqrt(quotient.square().sum());
    ContactMode contact{Mode{}, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(coordinates.size()))};
    contact.mode.frequency = frequencies(n);
    contact.mode.contact_deflection = 1.0 / (stiffness * norm);  // d_n = T_n . b, by the characteristic equation
    for (Eigen::Index i = 0; i < size; ++i)
    {
      const std::size_t row = indices[static_cast<std::size_t>(i)];
      const double entry = -quotient(i) / norm;
      contact.shape(static_cast<Eigen::Index>(row)) = entry;
      contact.mode.participation += entry * coordinates[row].participation;
    }
    modes.push_back(std::move(contact));
  }
  return modes;
}

/// All free modes of both structures up to `factor` times the frequency of the `count`-th of them, and for each
/// structure how many.
Coordinates lowestModes(const std::vector<SignedStructure>& structures, std::size_t count, double factor,
                        std::vector<int>& kept)
{
  Coordinates lowest;
  for (const SignedStructure& side : structures)
  {
    const int available = std::min(side.structure->modeCount(), static_cast<int>(count));
    for (int m = 1; m <= available; ++m)
    {
      lowest.push_back(gapMode(side, m));
    }
  }
  std::vector<double> frequencies;
  for (const Mode& mode : lowest)
  {
    if (mode.frequency > 0.0)
    {
      frequencies.push_back(mode.frequency);
    }
  }
  std::sort(frequencies.begin(), frequencies.end());
  const double limit = frequencies.empty() ? 0.0 : factor * frequencies[std::min(count, frequencies.size()) - 1];

  Coordinates coordinates;
  kept.clear();
  for (const SignedStructure& side : structures)
  {
    int m = 1;
    while (m <= side.structure->modeCount() && side.structure->mode(m).frequency <= limit)
    {
      coordinates.push_back(gapMode(side, m));
      ++m;
    }
    kept.push_back(m - 1);
  }
  return coordinates;
}

/// The conjoined modes: dynamic Green's functions of both structures at the roots of the characteristic equation, all
/// modes included.
std::vector<ContactMode> conjoinedModes(const std::vector<SignedStructure>& structures, std::size_t count,
                                        std::size_t rows, double stiffness, Coordinates& coordinates)
{
  // Each root lies below the pole above it, so that `count` modes in contact lie below the free mode `count` + 2 that
  // moves the gap; at a contact with nodes every other mode may not. Modes above four times that frequency enter as a
  // power series in omega^2 whose terms fall by 16 each.
  std::vector<int> kept;
  coordinates = lowestModes(structures, 2 * std::max(count, rows) + 2, 4.0, kept);
  separateEqualFrequencies(coordinates);
  constexpr int orders = 16;
  std::vector<double> receptance(orders, 0.0);
  std::vector<double> base_response(orders, 0.0);
  for (std::size_t i = 0; i < structures.size(); ++i)
  {
    const Residual rest = residual(*structures[i].structure, kept[i], orders);
    for (std::size_t order = 0; order < orders; ++order)
    {
      receptance[order] += rest.receptance[order];
      base_response[order] += structures[i].sign * rest.base_response[order];
    }
  }

  const std::vector<std::size_t> indices = gapCoordinates(coordinates);
  const PoleData data = gather(coordinates, indices);
  const CharacteristicEquation equation(stiffness, data.poles, data.deflections, receptance);
  const Eigen::Index roots = std::min(equation.rootCount(), static_cast<Eigen::Index>(count));

  std::vector<ContactMode> modes = unchangedModes(coordinates, rows);
  for (Eigen::Index n = 0; n < roots; ++n)
  {
    const CharacteristicEquation::Root root = equation.root(n);
    const double norm = std::sqrt(equation.slope(root));
    const Eigen::ArrayXd distances = equation.distances(root);
    ContactMode contact{Mode{}, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(rows))};
    contact.mode.frequency = std::sqrt(equation.value(root));
    contact.mode.contact_deflection = 1.0 / (stiffness * norm);
    // Gamma_n = sum_m T_mn Gamma_m over all free modes
    contact.mode.participation = -((data.deflections * data.participations / distances).sum() +
                                   evaluatePolynomial(base_response, equation.value(root))) /
                                 norm;
    for (std::size_t i = 0; i < indices.size() && indices[i] < rows; ++i)
    {
      const auto m = static_cast<Eigen::Index>(i);
      contact.shape(static_cast<Eigen::Index>(indices[i])) = -data.deflections(m) / (norm * distances(m));
    }
    modes.push_back(std::move(contact));
  }
  return modes;
}
}  // namespace

SwitchedModel::SwitchedModel(const SystemParameters& parameters) : spring_(parameters.contact)
{
  validate(parameters);
  scales_ = referenceScales(parameters.beam1);
  const std::vector<SignedStructure> structures = makeStructures(parameters);

  if (const auto* conjoined = std::get_if<ConjoinedBasis>(&parameters.basis))
  {
    const auto rows = static_cast<std::size_t>(conjoined->modes_free);
    const auto columns = static_cast<std::size_t>(conjoined->modes_contact);
    Coordinates coordinates;
    std::vector<ContactMode> modes = conjoinedModes(structures, columns, rows, spring_.stiffness, coordinates);
    coordinates.resize(rows);
    free_ = makeState(coordinates, parameters.damping.free);
    assembleContactState(std::move(modes), columns, spring_, parameters.damping.contact, contact_, mapping_);
  }
  else
  {
    const int modes_per_beam = std::get<AttachmentBasis>(parameters.basis).modes_per_beam;
    Coordinates coordinates;
    for (const SignedStructure& side : structures)
    {
      for (int m = 1; m <= modes_per_beam; ++m)
      {
        coordinates.push_back(gapMode(side, m));
      }
      coordinates.push_back(attachmentShape(side, modes_per_beam));
    }
    buildFromSpace(std::move(coordinates), parameters.damping);
  }
}

SwitchedModel::SwitchedModel(const std::vector<Mode>& modes, const ContactParameters& contact,
                             const DampingParameters& damping)
    : spring_(contact)
{
  const auto refuse = [](const std::string& name, double value, const std::string& allowed)
  { throw std::invalid_argument(name + ": " + std::to_string(value) + "; allowed: " + allowed); };
  if (modes.empty())
  {
    throw std::invalid_argument("modes: none; allowed: at least one");
  }
  for (const Mode& mode : modes)
  {
    if (!std::isfinite(mode.frequency) || mode.frequency < 0.0)
    {
      refuse("frequency of a mode", mode.frequency, "finite and >= 0, rad/s");
    }
    if (!std::isfinite(mode.contact_deflection) || !std::isfinite(mode.participation))
    {
      refuse("contact deflection or participation of the mode at (rad/s)", mode.frequency, "finite");
    }
  }
  if (!std::isfinite(contact.stiffness) || contact.stiffness <= 0.0)
  {
    refuse("contact stiffness", contact.stiffness, "finite and > 0, N/m");
  }
  if (!std::isfinite(contact.clearance))
  {
    refuse("clearance", contact.clearance, "finite, m");
  }
  for (const double ratio : {damping.free, damping.contact})
  {
    if (!(ratio >= 0.0 && ratio < 1.0))
    {
      refuse("damping ratio", ratio, "from 0 to below 1");
    }
  }
  buildFromSpace(modes, damping);
}

void SwitchedModel::buildFromSpace(std::vector<Mode> coordinates, const DampingParameters& damping)
{
  separateEqualFrequencies(coordinates);
  free_ = makeState(coordinates, damping.free);
  assembleContactState(ritzModes(coordinates, spring_.stiffness), coordinates.size(), spring_, damping.contact,
                       contact_, mapping_);
}

Eigen::ArrayXd SwitchedModel::mappingLoss() const
{
  return 1.0 - mapping_.rowwise().squaredNorm().array();
}

}  // namespace vibro_impact::core
