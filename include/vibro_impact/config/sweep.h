#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "vibro_impact/core/response.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::config
{
/// The state in which a drive frequency finds the structures.
enum class SweepStart
{
  rest,         ///< at rest, every frequency by itself
  follow_up,    ///< as the next lower frequency left them
  follow_down,  ///< as the next higher frequency left them
};

struct SweepOptions
{
  double from = 0.0;           ///< lowest omega*, > 0
  double to = 0.0;             ///< highest omega*, > from; equal to it if there is one point
  int points = 0;              ///< equally spaced frequencies, both ends included, >= 1
  std::uint64_t cycles = 400;  ///< drive cycles at each frequency, >= 1
  double acceleration = 1.0;   ///< amplitude of the base acceleration, m/s^2, > 0
  SweepStart start = SweepStart::rest;
  unsigned threads = 1;  ///< that work side by side on a sweep from rest, >= 1; the results do not depend on it
};

/// The response at each drive frequency, by ascending frequency. `progress` is called in the calling thread, now and
/// then and at the end, with the number of frequencies that are done. Throws std::invalid_argument where a drive
/// frequency meets an undamped natural one.
std::vector<core::Response> sweep(const std::shared_ptr<const core::SwitchedModel>& model, const SweepOptions& options,
                                  const std::function<void(std::size_t)>& progress);

}  // namespace vibro_impact::config
