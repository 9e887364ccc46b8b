#include "vibro_impact/core/beam.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "unit_beam.h"

namespace vibro_impact::core
{
namespace
{
/// Below this wave number, the static deflections and the first modes give the receptance more precisely than the
/// dynamic stiffness: the terms fall by (0.3/1.8)^4 each or faster.
constexpr double small_wave_number = 0.3;

std::unique_ptr<const UnitBeam> makeUnitBeam(const BeamParameters& parameters)
{
  const Precise length = parameters.length;
  const Precise contact = parameters.contact_location / length;
  if (!parameters.rigid_body)
  {
    return std::make_unique<UnitBeam>(parameters.ends, contact);
  }
  const RigidBody& rigid = *parameters.rigid_body;
  const Precise mass = static_cast<Precise>(massPerLength(parameters)) * length;
  UnitBeam::Body body;
  body.length = rigid.length / length;
  body.mass = rigid.mass / mass;
  body.rotary_inertia = rigid.rotary_inertia / (mass * length * length);
  // half a length that has been written in decimals is half of it but for rounding
  const Precise offset = contact - 0.5L;
  return std::make_unique<UnitBeam>(parameters.ends, body, std::abs(offset) < 1.0e-12L ? Precise{0} : offset);
}

}  // namespace

Beam::Beam(const BeamParameters& parameters)
    : beam_(makeUnitBeam(parameters)),
      length_(parameters.length),
      frequency_unit_(std::sqrt(bendingStiffness(parameters) / massPerLength(parameters)) /
                      (parameters.length * parameters.length)),
      mass_unit_(massPerLength(parameters) * parameters.length),
      compliance_unit_(parameters.length * parameters.length * parameters.length / bendingStiffness(parameters))
{
}

Beam::~Beam() = default;

int Beam::rigidBodyModeCount() const
{
  return beam_->rigidBodyModeCount();
}

Mode Beam::mode(int m) const
{
  const UnitMode unit = beam_->mode(m);
  return Mode{static_cast<double>(unit.frequency) * frequency_unit_,
              static_cast<double>(unit.contact) / std::sqrt(mass_unit_),
              static_cast<double>(unit.participation) * std::sqrt(mass_unit_)};
}

double Beam::staticReceptance(int kept) const
{
  Precise sum = beam_->staticReceptance();
  for (int m = beam_->rigidBodyModeCount() + 1; m <= kept; ++m)
  {
    const UnitMode mode = beam_->mode(m);
    const Precise share = mode.contact / mode.frequency;
    sum -= share * share;
  }
  return static_cast<double>(sum) * compliance_unit_;
}

double Beam::staticBaseResponse(int kept) const
{
  Precise sum = beam_->staticBaseResponse();
  for (int m = beam_->rigidBodyModeCount() + 1; m <= kept; ++m)
  {
    const UnitMode mode = beam_->mode(m);
    sum -= mode.contact * mode.participation / (mode.frequency * mode.frequency);
  }
  return static_cast<double>(sum) * mass_unit_ * compliance_unit_;
}

double Beam::receptance(double omega) const
{
  const Precise square = std::abs(omega) / frequency_unit_;
  const Precise lambda = std::sqrt(square);
  if (lambda >= small_wave_number)
  {
    return static_cast<double>(beam_->receptance(lambda)) * compliance_unit_;
  }
  // sum_m phi_m^2/(omega_m^2 - omega^2) = sum_m phi_m^2/omega_m^2 (1 + omega^2/(omega_m^2 - omega^2)): the second part
  // falls as m^-8
  constexpr int last = 40;
  const int rigid = beam_->rigidBodyModeCount();
  Precise sum = beam_->staticReceptance();
  for (int m = 1; m <= rigid; ++m)
  {
    const Precise contact = beam_->mode(m).contact;
    sum -= contact * contact / (square * square);
  }
  for (int m = last; m > rigid; --m)
  {
    const UnitMode mode = beam_->mode(m);
    const Precise share = mode.contact / mode.frequency;
    sum += share * share * square * square / ((mode.frequency - square) * (mode.frequency + square));
  }
  return static_cast<double>(sum) * compliance_unit_;
}

std::vector<double> Beam::modeShape(int m, const std::vector<double>& x) const
{
  std::vector<double> shape;
  for (const Precise value : beam_->shape(m, dimensionless(x)))
  {
    shape.push_back(static_cast<double>(value) / std::sqrt(mass_unit_));
  }
  return shape;
}

std::vector<double> Beam::staticShape(int kept, const std::vector<double>& x) const
{
  const std::vector<Precise> points = dimensionless(x);
  std::vector<Precise> sum = beam_->staticShape(points);
  for (int m = beam_->rigidBodyModeCount() + 1; m <= kept; ++m)
  {
    const UnitMode mode = beam_->mode(m);
    const std::vector<Precise> shape = beam_->shape(m, points);
    for (std::size_t i = 0; i < sum.size(); ++i)
    {
      sum[i] -= shape[i] * mode.contact / (mode.frequency * mode.frequency);
    }
  }
  std::vector<double> deflection;
  deflection.reserve(sum.size());
  for (const Precise value : sum)
  {
    deflection.push_back(static_cast<double>(value) * compliance_unit_);
  }
  return deflection;
}

std::vector<Precise> Beam::dimensionless(const std::vector<double>& x) const
{
  std::vector<Precise> points;
  for (const double at : x)
  {
    if (!(at >= 0.0 && at <= length_))
    {
      throw std::invalid_argument("x: " + std::to_string(at) + " m; allowed: 0 to the beam's length, " +
                                  std::to_string(length_) + " m");
    }
    points.push_back(static_cast<Precise>(at) / length_);
  }
  return points;
}

}  // namespace vibro_impact::core
