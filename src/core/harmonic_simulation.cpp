#include "vibro_impact/core/harmonic_simulation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "switched_motion.h"

namespace vibro_impact::core
{
namespace
{
constexpr double two_pi = 6.28318530717958647693;

/// A share of the time that lacks no more than this is the whole of it: the sum over the cycles is rounded.
constexpr double whole_share = 1.0e-9;

/// Puts impacts on the time axis of a step whose cycles are numbered from zero.
class ImpactCollector : public ImpactSink
{
public:
  explicit ImpactCollector(double cycle) : cycle_(cycle)
  {
  }
  void onImpact(const Impact& impact) override
  {
    impacts_.push_back({static_cast<double>(impact.interval) * cycle_ + impact.offset, impact});
  }
  const std::vector<TimedImpact>& impacts() const
  {
    return impacts_;
  }

private:
  double cycle_;
  std::vector<TimedImpact> impacts_;
};
}  // namespace

struct HarmonicSimulation::Implementation
{
  explicit Implementation(std::shared_ptr<const SwitchedModel> model) : motion(std::move(model), true)
  {
  }
  SwitchedMotion motion;
  double cycle = 0.0;
};

HarmonicSimulation::HarmonicSimulation(std::shared_ptr<const SwitchedModel> model)
    : implementation_(std::make_unique<Implementation>(std::move(model)))
{
}

HarmonicSimulation::~HarmonicSimulation() = default;
HarmonicSimulation::HarmonicSimulation(HarmonicSimulation&&) noexcept = default;
HarmonicSimulation& HarmonicSimulation::operator=(HarmonicSimulation&&) noexcept = default;

void HarmonicSimulation::reset()
{
  implementation_->motion.rest();
}

void HarmonicSimulation::start(const InitialMotion& motion)
{
  Eigen::VectorXd displacement;
  Eigen::VectorXd velocity;
  model().freeCoordinates(motion, displacement, velocity);
  implementation_->motion.start(displacement, velocity);
}

void HarmonicSimulation::setDrive(double frequency, double acceleration)
{
  if (!std::isfinite(frequency) || frequency <= 0.0)
  {
    throw std::invalid_argument("drive frequency: " + std::to_string(frequency) + " rad/s; allowed: finite and > 0");
  }
  if (!std::isfinite(acceleration) || acceleration < 0.0)
  {
    throw std::invalid_argument("acceleration: " + std::to_string(acceleration) + " m/s^2; allowed: finite and >= 0");
  }
  implementation_->motion.setHarmonicDrive(frequency, acceleration);
  implementation_->cycle = two_pi / frequency;
}

void HarmonicSimulation::advance(std::uint64_t cycles, ImpactSink& sink)
{
  for (std::uint64_t i = 0; i < cycles; ++i)
  {
    implementation_->motion.advanceHarmonic(sink);
  }
}

void HarmonicSimulation::advance(std::uint64_t cycles, ImpactSink& sink, std::size_t samples_per_cycle,
                                 HistorySample* history)
{
  implementation_->motion.recordHistory(history, samples_per_cycle);
  advance(cycles, sink);
  implementation_->motion.recordHistory(nullptr, 0);
}

void HarmonicSimulation::finish(ImpactSink& sink)
{
  implementation_->motion.interrupt(sink);
}

HistorySample HarmonicSimulation::sample() const
{
  return implementation_->motion.sample();
}

EnergyAccount HarmonicSimulation::energyAccount() const
{
  return implementation_->motion.sample().energy;
}

double HarmonicSimulation::time() const
{
  return static_cast<double>(implementation_->motion.intervals()) * implementation_->cycle;
}

double HarmonicSimulation::contactTime() const
{
  return implementation_->motion.contactTime();
}

const SwitchedModel& HarmonicSimulation::model() const
{
  return implementation_->motion.model();
}

Response harmonicResponse(HarmonicSimulation& simulation, double frequency, double acceleration, std::uint64_t cycles,
                          const ResponseOptions& options)
{
  simulation.setDrive(frequency, acceleration);
  ImpactCollector collector(two_pi / frequency);
  const std::uint64_t first_half = cycles / 2;
  simulation.advance(first_half, collector);
  const double start = simulation.time();
  const double contact_time = simulation.contactTime();
  simulation.advance(cycles - first_half, collector);
  DriveStep step{frequency, acceleration, 0.0, simulation.time(), {}, 0.0};
  step.contact = {simulation.model().stiffness(), simulation.model().clearance()};
  const double share = (simulation.contactTime() - contact_time) / (step.end - start);
  step.contact_share = share > 1.0 - whole_share ? 1.0 : share;
  return evaluateResponse(step, collector.impacts(), simulation.model().scales(), options);
}

}  // namespace vibro_impact::core
