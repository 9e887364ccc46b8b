#pragma once

#include <cstdint>
#include <optional>

#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/stream_time.h"

namespace vibro_impact::core
{
struct WearFeedbackLimits
{
  StreamTime interval = 1'000'000'000;  ///< shortest time between two requests, ns
  double greatest_step = 1.0e-6;        ///< of the clearance in one request, m
};

/// When worn depth is to open the gap of a simulation, and by how much.
///
/// The clearance asked for is always that of the unworn contact plus the depth handed over so far, so that no rounding
/// adds up: clearance = unworn() + handedOver(). One request at a time: the next one waits until the simulation says
/// that it holds the contact asked for, or that it refuses.
class WearFeedback
{
public:
  explicit WearFeedback(const WearFeedbackLimits& limits) : limits_(limits)
  {
  }

  /// The contact that the simulation holds from now on. One that was not asked for here is somebody else's: the depth
  /// handed over counts as being in it. `unworn`: the simulation began anew, as its configuration says, so that all
  /// depth is to be handed over again.
  void hold(const ContactParameters& contact, bool unworn);

  /// The contact to ask for now, if it is time to; `depth` has been worn in all, m.
  std::optional<ContactParameters> ask(StreamTime time, double depth);

  /// The simulation did not take what was asked for, which is asked for again after the interval.
  void refuse();

  /// Requests so far.
  std::uint64_t asked() const
  {
    return asked_;
  }
  /// Of them, those that the simulation came to hold.
  std::uint64_t taken() const
  {
    return taken_;
  }
  std::uint64_t refused() const
  {
    return refused_;
  }
  /// m
  double handedOver() const
  {
    return handed_over_;
  }
  /// m
  double unworn() const
  {
    return unworn_;
  }

private:
  struct Request
  {
    ContactParameters contact;
    double unworn;
    double depth;
  };

  WearFeedbackLimits limits_;
  std::optional<ContactParameters> contact_;  ///< held by the simulation
  double unworn_ = 0.0;
  double handed_over_ = 0.0;
  std::optional<Request> request_;  ///< the last one, until it is held
  bool waiting_ = false;
  std::optional<StreamTime> last_time_;
  std::uint64_t asked_ = 0;
  std::uint64_t taken_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace vibro_impact::core
