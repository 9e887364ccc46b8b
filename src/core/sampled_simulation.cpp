#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "switched_motion.h"
#include "vibro_impact/core/simulation.h"

namespace vibro_impact::core
{
namespace
{
bool sameStructures(const SwitchedModel& a, const SwitchedModel& b)
{
  const auto same = [](const Eigen::ArrayXd& x, const Eigen::ArrayXd& y)
  { return x.size() == y.size() && (x == y).all(); };
  return same(a.free().frequency, b.free().frequency) &&
         same(a.free().contact_deflection, b.free().contact_deflection) &&
         same(a.free().participation, b.free().participation);
}
}  // namespace

struct SampledSimulation::Implementation
{
  Implementation(std::shared_ptr<const SwitchedModel> model, double period)
      : motion(std::move(model), false), sample_period(period)
  {
    motion.setInterval(period);
  }

  SwitchedMotion motion;
  double sample_period;
  double last_acceleration = 0.0;
  std::uint64_t samples = 0;
};

SampledSimulation::SampledSimulation(std::shared_ptr<const SwitchedModel> model, double sample_period)
{
  if (!std::isfinite(sample_period) || sample_period <= 0.0)
  {
    throw std::invalid_argument("sample_period: " + std::to_string(sample_period) + " s; allowed: finite and > 0");
  }
  implementation_ = std::make_unique<Implementation>(std::move(model), sample_period);
}

SampledSimulation::~SampledSimulation() = default;

SampledSimulation::SampledSimulation(const SampledSimulation& other)
    : implementation_(std::make_unique<Implementation>(*other.implementation_))
{
}

SampledSimulation& SampledSimulation::operator=(const SampledSimulation& other)
{
  if (this != &other)
  {
    implementation_ = std::make_unique<Implementation>(*other.implementation_);
  }
  return *this;
}

SampledSimulation::SampledSimulation(SampledSimulation&&) noexcept = default;
SampledSimulation& SampledSimulation::operator=(SampledSimulation&&) noexcept = default;

void SampledSimulation::reset(ImpactSink& sink)
{
  finish(sink);
  implementation_->motion.rest();
  implementation_->samples = 0;
  implementation_->last_acceleration = 0.0;
}

void SampledSimulation::start(const InitialMotion& motion, ImpactSink& sink)
{
  Eigen::VectorXd displacement;
  Eigen::VectorXd velocity;
  model().freeCoordinates(motion, displacement, velocity);
  reset(sink);
  implementation_->motion.start(displacement, velocity);
}

void SampledSimulation::setModel(std::shared_ptr<const SwitchedModel> model, ImpactSink& sink)
{
  Implementation& self = *implementation_;
  if (!sameStructures(self.motion.model(), *model))
  {
    throw std::invalid_argument("model: its free modes are others; allowed: one that differs in its contact alone");
  }
  SwitchedMotion next(std::move(model), false);
  next.setInterval(self.sample_period);
  if (self.samples > 0)
  {
    next.takeOver(self.motion, sink);
  }
  self.motion = std::move(next);
}

void SampledSimulation::advance(const double* acceleration, std::size_t count, double* gap, double* force,
                                ImpactSink& sink)
{
  Implementation& self = *implementation_;
  for (std::size_t i = 0; i < count;)
  {
    const std::size_t steady = self.samples > 0 ? self.motion.advanceSteadily(self.last_acceleration, acceleration + i,
                                                                              count - i, gap + i, force + i)
                                                : 0;
    if (steady > 0)
    {
      self.samples += steady;
      i += steady;
      self.last_acceleration = acceleration[i - 1];
      continue;
    }
    if (self.samples++ > 0)
    {
      self.motion.advanceLinear(self.last_acceleration, acceleration[i], sink);
    }
    self.last_acceleration = acceleration[i];
    gap[i] = self.motion.gap();
    force[i] = self.motion.force();
    ++i;
  }
}

void SampledSimulation::finish(ImpactSink& sink)
{
  implementation_->motion.interrupt(sink);
}

HistorySample SampledSimulation::sample() const
{
  HistorySample sample = implementation_->motion.sample();
  sample.acceleration = implementation_->last_acceleration;  // the motion has not heard of that of sample 0 yet
  return sample;
}

void SampledSimulation::structureCoordinates(Eigen::VectorXd& coordinates) const
{
  const SwitchedMotion& motion = implementation_->motion;
  Eigen::VectorXd displacement;
  Eigen::VectorXd velocity;
  motion.coordinates(displacement, velocity);
  coordinates.noalias() = model().structureCoordinates(motion.inContact()) * displacement;
}

EnergyAccount SampledSimulation::energyAccount() const
{
  return implementation_->motion.sample().energy;
}

std::uint64_t SampledSimulation::samples() const
{
  return implementation_->samples;
}

double SampledSimulation::samplePeriod() const
{
  return implementation_->sample_period;
}

bool SampledSimulation::inContact() const
{
  return implementation_->motion.inContact();
}

std::uint64_t SampledSimulation::switchLimitReached() const
{
  return implementation_->motion.switchLimitReached();
}

const SwitchedModel& SampledSimulation::model() const
{
  return implementation_->motion.model();
}

}  // namespace vibro_impact::core
