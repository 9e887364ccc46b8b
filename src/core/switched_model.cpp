#include "vibro_impact/core/switched_model.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Householder>

#include "vibro_impact/core/characteristic_equation.h"

namespace vibro_impact::core
{
namespace
{
/// A structure with the sign s_i with which its contact deflection enters the gap.
struct SignedStructure
{
  std::unique_ptr<const Structure> structure;
  double sign;

  int number() const
  {
    return sign > 0.0 ? 1 : 2;
  }
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
  structures.push_back({makeStructure(parameters.beam1), +1.0});
  structures.push_back({makeStructure(parameters.beam2), -1.0});
  structures.erase(std::remove_if(structures.begin(), structures.end(),
                                  [](const SignedStructure& side) { return side.structure == nullptr; }),
                   structures.end());
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

/// An orthogonal matrix whose first column is the direction of `deflections` and whose second one, with it, spans
/// `participations`; the other way round where nothing moves the gap.
Eigen::MatrixXd commonDirections(const Eigen::VectorXd& deflections, const Eigen::VectorXd& participations)
{
  const Eigen::Index size = deflections.size();
  Eigen::MatrixXd wanted(size, 2);
  wanted.col(0) = deflections.squaredNorm() > 0.0 ? deflections : participations;
  wanted.col(1) = deflections.squaredNorm() > 0.0 ? participations : deflections;
  // The QR decomposition of two columns. HouseholderQR is made for blocks of any size: a third of the time that it
  // takes to compile this file.
  Eigen::MatrixXd reflections = wanted;
  const auto below = [size, &reflections](Eigen::Index n) { return reflections.col(n).tail(size - n - 1); };
  Eigen::VectorXd workspace(size);
  Eigen::Vector2d scale;
  double length = 0.0;
  reflections.col(0).makeHouseholderInPlace(scale(0), length);
  reflections.rightCols(1).applyHouseholderOnTheLeft(below(0), scale(0), workspace.data());
  reflections.col(1).tail(size - 1).makeHouseholderInPlace(scale(1), length);
  Eigen::MatrixXd directions = Eigen::MatrixXd::Identity(size, size);
  for (const Eigen::Index n : {Eigen::Index{1}, Eigen::Index{0}})
  {
    directions.bottomRightCorner(size - n, size - n).applyHouseholderOnTheLeft(below(n), scale(n), workspace.data());
  }
  for (Eigen::Index n = 0; n < 2; ++n)
  {
    if (directions.col(n).dot(wanted.col(n)) < 0.0)
    {
      directions.col(n) *= -1.0;
    }
  }
  return directions;
}

/// Coordinates are sorted by frequency, and those of equal frequency rotated so that one of them carries the whole
/// motion of the gap and the others leave it unchanged; any such rotation is as orthogonal as the modes were. What does
/// not move the gap then says so exactly: two structures that move alike have no rounding noise between them. The
/// damping of each is the projection of what the modes had; all of the coordinates need a damping ratio. Returns the
/// orthogonal R with  given coordinates = R new coordinates.
Eigen::MatrixXd separateEqualFrequencies(Coordinates& coordinates)
{
  std::vector<std::size_t> order(coordinates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&coordinates](std::size_t a, std::size_t b)
                   { return coordinates[a].frequency < coordinates[b].frequency; });
  Coordinates sorted;
  for (const std::size_t n : order)
  {
    sorted.push_back(coordinates[n]);
  }
  coordinates = std::move(sorted);

  const auto size = static_cast<Eigen::Index>(coordinates.size());
  Eigen::MatrixXd rotation = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t first = 0, last = 0; first < coordinates.size(); first = last)
  {
    const double frequency = coordinates[first].frequency;
    while (last < coordinates.size() && coordinates[last].frequency <= frequency * (1.0 + equal_frequencies))
    {
      ++last;
    }
    const auto equal = static_cast<Eigen::Index>(last - first);
    Eigen::VectorXd deflections(equal);
    Eigen::VectorXd participations(equal);
    Eigen::VectorXd damping(equal);
    for (Eigen::Index i = 0; i < equal; ++i)
    {
      const Mode& mode = coordinates[first + static_cast<std::size_t>(i)];
      deflections(i) = mode.contact_deflection;
      participations(i) = mode.participation;
      damping(i) = *mode.damping_ratio;
    }
    const Eigen::MatrixXd directions =
        equal > 1 ? commonDirections(deflections, participations) : Eigen::MatrixXd::Identity(1, 1);
    for (Eigen::Index i = 0; i < equal; ++i)
    {
      rotation.row(static_cast<Eigen::Index>(order[first + static_cast<std::size_t>(i)]))
          .segment(static_cast<Eigen::Index>(first), equal) = directions.row(i);
    }
    if (equal < 2)
    {
      continue;
    }
    const double deflection = deflections.norm();
    const double participation = participations.norm();
    const double product = deflections.dot(participations);
    const bool moves_gap = std::abs(product) > common_motion * deflection * participation;
    const double relative = moves_gap ? product / deflection : 0.0;
    const double common = std::sqrt(std::max(0.0, participation * participation - relative * relative));
    const Eigen::VectorXd projected = directions.cwiseAbs2().transpose() * damping;
    for (std::size_t i = first; i < last; ++i)
    {
      coordinates[i] = Mode{frequency, 0.0, 0.0, projected(static_cast<Eigen::Index>(i - first))};
    }
    coordinates[first].contact_deflection = deflection;
    coordinates[first].participation = deflection > 0.0 ? relative : common;
    coordinates[first + 1].participation = deflection > 0.0 ? common : 0.0;
  }
  return rotation;
}

/// Coordinates without a damping ratio of their own get the given one.
void setDamping(Coordinates& coordinates, double ratio)
{
  for (Mode& mode : coordinates)
  {
    mode.damping_ratio = mode.damping_ratio.value_or(ratio);
  }
}

/// The static deflection of a structure under a unit force at the contact, less its part in the kept modes,
/// mass-normalised. Its mass is sum phi^2/omega^4 and its strain energy (twice) sum phi^2/omega^2 over the modes above
/// the kept ones. Nothing where these do not move the contact point or there are none.
std::optional<Mode> attachmentShape(const SignedStructure& side, int kept)
{
  const Residual rest = residual(*side.structure, kept, 2);
  const double norm = std::sqrt(rest.receptance[1]);
  if (!(norm > 0.0))
  {
    return std::nullopt;
  }
  Mode shape;
  shape.frequency = std::sqrt(rest.receptance[0]) / norm;
  shape.contact_deflection = side.sign * rest.receptance[0] / norm;
  shape.participation = rest.base_response[0] / norm;
  return shape;
}

LinearState makeState(const Coordinates& coordinates)
{
  const auto size = static_cast<Eigen::Index>(coordinates.size());
  LinearState state;
  state.frequency.resize(size);
  state.contact_deflection.resize(size);
  state.participation.resize(size);
  state.damping_ratio.resize(size);
  for (Eigen::Index n = 0; n < size; ++n)
  {
    const Mode& mode = coordinates[static_cast<std::size_t>(n)];
    state.frequency(n) = mode.frequency;
    state.contact_deflection(n) = mode.contact_deflection;
    state.participation(n) = mode.participation;
    state.damping_ratio(n) = *mode.damping_ratio;
  }
  state.preload = Eigen::ArrayXd::Zero(size);
  return state;
}

/// A mode of the state in contact: its shape in all free coordinates that it was made of.
struct ContactMode
{
  Mode mode;
  Eigen::VectorXd shape;
  double root = 0.0;  ///< of a mode that moves the gap: x = omega^2, and 1/sqrt(f'(x)), for those free modes that
  double coefficient = 0.0;  ///< are not among the coordinates: their part is phi_m coefficient/(x - omega_m^2)
};

void sortAndCut(std::vector<ContactMode>& modes, std::size_t count)
{
  std::stable_sort(modes.begin(), modes.end(),
                   [](const ContactMode& a, const ContactMode& b) { return a.mode.frequency < b.mode.frequency; });
  modes.resize(std::min(count, modes.size()));
}

Eigen::MatrixXd shapes(const std::vector<ContactMode>& modes)
{
  Eigen::MatrixXd matrix(modes.front().shape.size(), static_cast<Eigen::Index>(modes.size()));
  for (std::size_t n = 0; n < modes.size(); ++n)
  {
    matrix.col(static_cast<Eigen::Index>(n)) = modes[n].shape;
  }
  return matrix;
}

/// Splits into the linear state and the mapping from and to the lowest `rows` free coordinates.
void assembleContactState(const std::vector<ContactMode>& modes, std::size_t rows, const ContactParameters& spring,
                          double damping_ratio, LinearState& state, Eigen::MatrixXd& mapping)
{
  Coordinates coordinates;
  for (const ContactMode& contact : modes)
  {
    coordinates.push_back(contact.mode);
    coordinates.back().damping_ratio = damping_ratio;  // what the modes had apart says nothing about the contact
  }
  mapping = shapes(modes).topRows(static_cast<Eigen::Index>(rows));
  state = makeState(coordinates);
  state.preload = -spring.stiffness * spring.clearance * state.contact_deflection;
  state.gap = spring.clearance;
}

/// How far the conjoined modes that are left out open the gap under a unit force on it, m/N: what the structures yield
/// with the spring between them, alpha/(1 + k alpha) = sum d_n^2/omega_n^2 over all modes, less the part of those kept.
double leftOutCompliance(const std::vector<SignedStructure>& structures, const LinearState& kept, double stiffness)
{
  double receptance = 0.0;
  for (const SignedStructure& side : structures)
  {
    receptance += side.structure->staticReceptance(0);
  }
  const Eigen::ArrayXd compliance =
      (kept.contact_deflection != 0.0).select((kept.contact_deflection / kept.frequency).square(), 0.0);
  return 1.0 / (1.0 / receptance + stiffness) - compliance.sum();
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

std::vector<ContactMode> unchangedModes(const Coordinates& coordinates)
{
  std::vector<ContactMode> modes;
  for (std::size_t n = 0; n < coordinates.size(); ++n)
  {
    if (coordinates[n].contact_deflection == 0.0)
    {
      const auto size = static_cast<Eigen::Index>(coordinates.size());
      modes.push_back(ContactMode{coordinates[n], Eigen::VectorXd::Unit(size, static_cast<Eigen::Index>(n))});
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

  std::vector<ContactMode> modes = unchangedModes(coordinates);
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

/// The lowest free modes of both structures.
struct LowestModes
{
  Coordinates coordinates;
  std::vector<int> kept;   ///< how many of each structure
  std::size_t movers = 0;  ///< how many of the lowest `count` move the gap
  bool all = true;         ///< there are no more
};

/// All free modes of both structures up to `factor` times the frequency of the `count`-th of them.
LowestModes lowestModes(const std::vector<SignedStructure>& structures, std::size_t count, double factor)
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
  std::stable_sort(lowest.begin(), lowest.end(),
                   [](const Mode& a, const Mode& b) { return a.frequency < b.frequency; });
  lowest.resize(std::min(count, lowest.size()));
  const double limit = factor * lowest.back().frequency;

  LowestModes modes;
  modes.movers = static_cast<std::size_t>(
      std::count_if(lowest.begin(), lowest.end(), [](const Mode& mode) { return mode.contact_deflection != 0.0; }));
  for (const SignedStructure& side : structures)
  {
    int kept = 0;
    while (kept < side.structure->modeCount())
    {
      const Mode mode = gapMode(side, kept + 1);
      if (mode.frequency > limit)
      {
        break;
      }
      modes.coordinates.push_back(mode);
      ++kept;
    }
    modes.kept.push_back(kept);
    modes.all &= kept == side.structure->modeCount();
  }
  return modes;
}

/// What conjoined modes are made of.
struct ConjoinedSpace
{
  Coordinates coordinates;           ///< of the free state, not yet cut to the basis
  Eigen::MatrixXd rotation;          ///< of separateEqualFrequencies()
  std::vector<StructureMode> modes;  ///< its rows
  std::vector<Residual> residuals;   ///< what the modes above do, one for each structure
};

/// The conjoined modes: dynamic Green's functions of both structures at the roots of the characteristic equation, all
/// modes included. `rows` is cut to the free modes that there are.
std::vector<ContactMode> conjoinedModes(const std::vector<SignedStructure>& structures, std::size_t count,
                                        std::size_t& rows, const SystemParameters& parameters, ConjoinedSpace& space)
{
  const double stiffness = parameters.contact.stiffness;
  Coordinates& coordinates = space.coordinates;
  // Each root lies below the pole above it, so that `count` modes in contact lie below the free mode `count` + 2 that
  // moves the gap. Modes above four times that frequency enter as a power series in omega^2 whose terms fall by 16
  // each.
  std::size_t rigid = 0;
  for (const SignedStructure& side : structures)
  {
    rigid += static_cast<std::size_t>(side.structure->rigidBodyModeCount());
  }
  const std::size_t wanted = std::max(count, rows) + 2;
  std::size_t looked_at = 2 * wanted - 2 + rigid;
  LowestModes lowest = lowestModes(structures, looked_at, 4.0);
  while (lowest.movers < wanted && !lowest.all)
  {
    looked_at *= 2;
    lowest = lowestModes(structures, looked_at, 4.0);
  }
  const std::vector<int>& kept = lowest.kept;
  coordinates = std::move(lowest.coordinates);
  rows = std::min(rows, coordinates.size());
  setDamping(coordinates, parameters.damping.free);
  for (std::size_t i = 0; i < structures.size(); ++i)
  {
    for (int m = 1; m <= kept[i]; ++m)
    {
      space.modes.push_back({structures[i].number(), m, structures[i].structure->mode(m).contact_deflection});
    }
  }
  space.rotation = separateEqualFrequencies(coordinates);
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
    space.residuals.push_back(rest);
  }
  if (lowest.all)
  {
    receptance.clear();
  }

  const std::vector<std::size_t> indices = gapCoordinates(coordinates);
  const PoleData data = gather(coordinates, indices);
  const CharacteristicEquation equation(stiffness, data.poles, data.deflections, receptance);
  const Eigen::Index roots = std::min(equation.rootCount(), static_cast<Eigen::Index>(count));

  std::vector<ContactMode> modes = unchangedModes(coordinates);
  for (Eigen::Index n = 0; n < roots; ++n)
  {
    const CharacteristicEquation::Root root = equation.root(n);
    const double norm = std::sqrt(equation.slope(root));
    const Eigen::ArrayXd distances = equation.distances(root);
    ContactMode contact{Mode{}, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(coordinates.size()))};
    contact.root = equation.value(root);
    contact.coefficient = 1.0 / norm;
    contact.mode.frequency = std::sqrt(contact.root);
    contact.mode.contact_deflection = 1.0 / (stiffness * norm);
    // Gamma_n = sum_m T_mn Gamma_m over all free modes
    contact.mode.participation = -((data.deflections * data.participations / distances).sum() +
                                   evaluatePolynomial(base_response, equation.value(root))) /
                                 norm;
    for (std::size_t i = 0; i < indices.size(); ++i)
    {
      const auto m = static_cast<Eigen::Index>(i);
      contact.shape(static_cast<Eigen::Index>(indices[i])) = -data.deflections(m) / (norm * distances(m));
    }
    modes.push_back(std::move(contact));
  }
  return modes;
}
/// R_i^T R_i of the rows of R that belong to one structure.
Eigen::MatrixXd projection(const Eigen::MatrixXd& rotation, const std::vector<StructureMode>& modes, int structure)
{
  Eigen::MatrixXd rows = rotation;
  for (std::size_t row = 0; row < modes.size(); ++row)
  {
    if (modes[row].structure != structure)
    {
      rows.row(static_cast<Eigen::Index>(row)).setZero();
    }
  }
  return rows.transpose() * rows;
}

/// The energy of one structure in states whose coordinates have the given shapes in those of S0.
StructureEnergy structureEnergy(const Eigen::MatrixXd& projection, const Eigen::ArrayXd& frequency,
                                const Eigen::MatrixXd& shapes)
{
  // Only coordinates of equal frequency share a structure's mode, so that the frequencies commute with the projection.
  const Eigen::MatrixXd strain = projection * frequency.square().matrix().asDiagonal();
  return {shapes.transpose() * projection * shapes, shapes.transpose() * strain * shapes};
}

/// sum_{a + b = order} x^a y^b
double completeSymmetric(double x, double y, std::size_t order)
{
  double sum = 1.0;
  double power = 1.0;
  for (std::size_t n = 0; n < order; ++n)
  {
    power *= y;
    sum = sum * x + power;
  }
  return sum;
}

/// Adds the modes above those that the conjoined modes list one by one. With r_j = sum phi^2/omega^(2 j + 2) over them
///   sum phi^2/((omega^2 - x)(omega^2 - y))         = sum_j r_(j+1) h_j(x, y),    h_j = sum_{a + b = j} x^a y^b
///   sum phi^2 omega^2/((omega^2 - x)(omega^2 - y)) = sum_j r_j h_j(x, y)
void addResidual(StructureEnergy& energy, const std::vector<double>& receptance, const std::vector<ContactMode>& modes)
{
  for (std::size_t n = 0; n < modes.size(); ++n)
  {
    for (std::size_t m = 0; m < modes.size(); ++m)
    {
      const double factor = modes[n].coefficient * modes[m].coefficient;
      const auto row = static_cast<Eigen::Index>(n);
      const auto column = static_cast<Eigen::Index>(m);
      for (std::size_t j = receptance.size(); factor != 0.0 && j-- > 0;)  // small terms first
      {
        const double term = factor * receptance[j];
        energy.strain(row, column) += term * completeSymmetric(modes[n].root, modes[m].root, j);
        energy.kinetic(row, column) += j > 0 ? term * completeSymmetric(modes[n].root, modes[m].root, j - 1) : 0.0;
      }
    }
  }
}

Eigen::ArrayXd frequencies(const Coordinates& coordinates)
{
  Eigen::ArrayXd result(static_cast<Eigen::Index>(coordinates.size()));
  for (std::size_t n = 0; n < coordinates.size(); ++n)
  {
    result(static_cast<Eigen::Index>(n)) = coordinates[n].frequency;
  }
  return result;
}
}  // namespace

SwitchedModel::SwitchedModel(const SystemParameters& parameters) : spring_(parameters.contact)
{
  validate(parameters);
  scales_ = referenceScales(parameters);
  const std::vector<SignedStructure> structures = makeStructures(parameters);

  if (const auto* conjoined = std::get_if<ConjoinedBasis>(&parameters.basis))
  {
    auto rows = static_cast<std::size_t>(conjoined->modes_free);
    const auto columns = static_cast<std::size_t>(conjoined->modes_contact);
    ConjoinedSpace space;
    std::vector<ContactMode> modes = conjoinedModes(structures, columns, rows, parameters, space);
    sortAndCut(modes, columns);
    const Eigen::ArrayXd frequency = frequencies(space.coordinates);
    const auto free_size = static_cast<Eigen::Index>(rows);
    const Eigen::MatrixXd all_free = Eigen::MatrixXd::Identity(frequency.size(), free_size);
    for (int structure = 1; structure <= 2; ++structure)
    {
      const Eigen::MatrixXd projected = projection(space.rotation, space.modes, structure);
      const auto index = static_cast<std::size_t>(structure - 1);
      free_energy_[index] = structureEnergy(projected, frequency, all_free);
      contact_energy_[index] = structureEnergy(projected, frequency, shapes(modes));
    }
    for (std::size_t i = 0; i < structures.size(); ++i)
    {
      const auto index = static_cast<std::size_t>(structures[i].number() - 1);
      addResidual(contact_energy_[index], space.residuals[i].receptance, modes);
    }
    space.coordinates.resize(rows);
    free_ = makeState(space.coordinates);
    assembleContactState(modes, rows, spring_, parameters.damping.contact, contact_, mapping_);
    structure_modes_ = std::move(space.modes);
    structure_coordinates_ = space.rotation.leftCols(free_size);
    contact_structure_coordinates_ = space.rotation * shapes(modes);
    contact_.gap *= 1.0 - spring_.stiffness * leftOutCompliance(structures, contact_, spring_.stiffness);
    free_.gap = spring_.clearance;
  }
  else
  {
    const int modes_per_beam = std::get<AttachmentBasis>(parameters.basis).modes_per_beam;
    Coordinates coordinates;
    for (const SignedStructure& side : structures)
    {
      // A static deflection is one without the modes as a rigid body.
      const int kept =
          std::min(std::max(modes_per_beam, side.structure->rigidBodyModeCount()), side.structure->modeCount());
      for (int m = 1; m <= kept; ++m)
      {
        coordinates.push_back(gapMode(side, m));
        structure_modes_.push_back({side.number(), m, side.sign * coordinates.back().contact_deflection});
      }
      if (const std::optional<Mode> shape = attachmentShape(side, kept))
      {
        coordinates.push_back(*shape);
        structure_modes_.push_back({side.number(), 0, side.sign * shape->contact_deflection});
      }
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
    if (!(mode.damping_ratio.value_or(0.0) >= 0.0 && mode.damping_ratio.value_or(0.0) < 1.0))
    {
      refuse("damping ratio of a mode", *mode.damping_ratio, "from 0 to below 1");
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
  for (std::size_t n = 0; n < modes.size(); ++n)
  {
    structure_modes_.push_back({1, static_cast<int>(n) + 1, modes[n].contact_deflection});
  }
  buildFromSpace(modes, damping);
}

void SwitchedModel::buildFromSpace(std::vector<Mode> coordinates, const DampingParameters& damping)
{
  setDamping(coordinates, damping.free);
  structure_coordinates_ = separateEqualFrequencies(coordinates);
  free_ = makeState(coordinates);
  free_.gap = spring_.clearance;
  std::vector<ContactMode> modes = ritzModes(coordinates, spring_.stiffness);
  sortAndCut(modes, modes.size());
  assembleContactState(modes, coordinates.size(), spring_, damping.contact, contact_, mapping_);
  const Eigen::MatrixXd all_free = Eigen::MatrixXd::Identity(free_.size(), free_.size());
  for (int structure = 1; structure <= 2; ++structure)
  {
    const Eigen::MatrixXd projected = projection(structure_coordinates_, structure_modes_, structure);
    const auto index = static_cast<std::size_t>(structure - 1);
    free_energy_[index] = structureEnergy(projected, free_.frequency, all_free);
    contact_energy_[index] = structureEnergy(projected, free_.frequency, mapping_);
  }
  contact_structure_coordinates_ = structure_coordinates_ * mapping_;
  lossless_ = true;
}

void SwitchedModel::freeCoordinates(const InitialMotion& motion, Eigen::VectorXd& displacement,
                                    Eigen::VectorXd& velocity) const
{
  const auto transform = [this](const std::vector<double>& first, const std::vector<double>& second,
                                const std::string& quantity) -> Eigen::VectorXd
  {
    Eigen::VectorXd own = Eigen::VectorXd::Zero(structure_coordinates_.rows());
    int structure = 0;
    for (const std::vector<double>* values : {&first, &second})
    {
      ++structure;
      for (std::size_t i = 0; i < values->size(); ++i)
      {
        const int number = static_cast<int>(i) + 1;
        const std::string name = "initial " + quantity + " of structure " + std::to_string(structure) + ", mode " +
                                 std::to_string(number) + ": " + std::to_string((*values)[i]);
        if (!std::isfinite((*values)[i]))
        {
          throw std::invalid_argument(name + "; allowed: finite");
        }
        const auto found = std::find_if(structure_modes_.begin(), structure_modes_.end(),
                                        [&](const StructureMode& mode)
                                        { return mode.structure == structure && mode.number == number; });
        const Eigen::Index row = found - structure_modes_.begin();
        if (found == structure_modes_.end() || structure_coordinates_.row(row).isZero(0.0))
        {
          throw std::invalid_argument(
              name + "; allowed: " + (i == 0 ? "none, it has no modes" : "modes 1 to " + std::to_string(i)) +
              " in this basis");
        }
        own(row) = (*values)[i];
      }
    }
    return structure_coordinates_.transpose() * own;
  };
  Eigen::VectorXd displaced = transform(motion.structure1.displacement, motion.structure2.displacement, "displacement");
  velocity = transform(motion.structure1.velocity, motion.structure2.velocity, "velocity");
  displacement = std::move(displaced);
}

Eigen::ArrayXd SwitchedModel::mappingLoss() const
{
  return 1.0 - mapping_.rowwise().squaredNorm().array();
}

}  // namespace vibro_impact::core
