#include "vibro_impact/config/sweep.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>

#include "vibro_impact/core/harmonic_simulation.h"

namespace vibro_impact::config
{
namespace
{
/// Drive frequency number `index` over the lowest natural one; both ends are met exactly.
double omegaStar(const SweepOptions& options, std::size_t index)
{
  const double share = options.points > 1 ? static_cast<double>(index) / (options.points - 1) : 0.0;
  return options.from * (1.0 - share) + options.to * share;
}

core::Response respond(core::HarmonicSimulation& simulation, const SweepOptions& options, std::size_t index)
{
  const double omega_star = omegaStar(options, index);
  core::Response response = core::harmonicResponse(simulation, omega_star * simulation.model().scales().frequency,
                                                   options.acceleration, options.cycles);
  response.row.omega_star = omega_star;  // without the rounding of the way to rad/s and back
  return response;
}

void sweepFromRest(const std::shared_ptr<const core::SwitchedModel>& model, const SweepOptions& options,
                   const std::function<void(std::size_t)>& progress, std::vector<core::Response>& responses)
{
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  const auto work = [&]
  {
    try
    {
      core::HarmonicSimulation simulation(model);
      for (std::size_t index = next++; index < responses.size(); index = next++)
      {
        simulation.reset();
        responses[index] = respond(simulation, options, index);
        ++done;
      }
    }
    catch (...)
    {
      next = responses.size();  // nobody else need go on
      throw;
    }
  };
  std::vector<std::future<void>> workers(std::min<std::size_t>(options.threads, responses.size()));
  std::generate(workers.begin(), workers.end(), [&work] { return std::async(std::launch::async, work); });
  for (std::future<void>& worker : workers)
  {
    while (worker.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
    {
      progress(done);
    }
  }
  for (std::future<void>& worker : workers)
  {
    worker.get();
  }
}

void sweepFollowing(const std::shared_ptr<const core::SwitchedModel>& model, const SweepOptions& options,
                    const std::function<void(std::size_t)>& progress, std::vector<core::Response>& responses)
{
  core::HarmonicSimulation simulation(model);
  for (std::size_t done = 0; done < responses.size(); ++done)
  {
    progress(done);
    const std::size_t index = options.start == SweepStart::follow_up ? done : responses.size() - 1 - done;
    responses[index] = respond(simulation, options, index);
  }
}

}  // namespace

std::vector<core::Response> sweep(const std::shared_ptr<const core::SwitchedModel>& model, const SweepOptions& options,
                                  const std::function<void(std::size_t)>& progress)
{
  std::vector<core::Response> responses(static_cast<std::size_t>(options.points));
  (options.start == SweepStart::rest ? sweepFromRest : sweepFollowing)(model, options, progress, responses);
  progress(responses.size());
  return responses;
}

}  // namespace vibro_impact::config
