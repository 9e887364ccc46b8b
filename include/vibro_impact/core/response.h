#pragma once

#include <cstdint>
#include <vector>

#include "vibro_impact/core/impact.h"
#include "vibro_impact/core/parameters.h"

namespace vibro_impact::core
{
/// One row of a response table: the steady response at one drive frequency. Column names are the members' names.
struct ResponseRow
{
  double omega_star = 0.0;    ///< drive frequency over the lowest natural frequency of beam 1, 1
  double frequency_hz = 0.0;  ///< drive frequency, Hz
  double acceleration = 0.0;  ///< amplitude of the base acceleration, m/s^2
  int period = 0;             ///< least number of drive cycles after which the response repeats; 0: none up to 16
  bool steady =
      false;        ///< the transient has died away: the response repeats, or its averages do (statistical_tolerance)
  int impacts = 0;  ///< captured impacts, at most ResponseOptions::captured_impacts
  double impacts_per_cycle = 0.0;  ///< 1
  double impulse_mean = 0.0;       ///< of the captured impacts, N s
  double impulse_min = 0.0;        ///< N s
  double impulse_max = 0.0;        ///< N s
  double impulse_star_mean = 0.0;  ///< the same, dimensionless (ReferenceScales::impulseStar)
  double impulse_star_min = 0.0;
  double impulse_star_max = 0.0;
  double impulse_per_cycle = 0.0;  ///< impulse of a mean drive cycle, N s
  double peak_force = 0.0;         ///< greatest force of the captured impacts, N
  double duration_mean = 0.0;      ///< of the captured impacts, s
  double contact_share = 0.0;      ///< share of the last half of the step that is spent in contact, 1: with no impacts,
                                   ///< 0 means never reached and 1 never separated
  double stiffness = 0.0;          ///< of the contact spring, N/m
  double clearance = 0.0;          ///< m
};

/// A captured impact: a whole contact episode on the time axis of one constant-frequency step.
struct TimedImpact
{
  double onset = 0.0;  ///< s, on a time axis on which the step's `start` and `end` are given
  Impact impact;
};

struct ResponseOptions
{
  int captured_impacts = 15;  ///< impacts at the end of the step that make the row
  int longest_period = 16;    ///< in drive cycles
  double tolerance = 1.0e-4;  ///< two impacts are the same if impulse and onset phase agree to this, relative to the
                              ///< greatest impulse and to a cycle
  double statistical_tolerance = 0.1;  ///< a response that does not repeat is steady if the impulses of the third and
                                       ///< the last quarter of the step differ by no more than this share
};

/// One step of constant frequency and amplitude.
struct DriveStep
{
  double frequency = 0.0;          ///< Omega, rad/s, > 0
  double acceleration = 0.0;       ///< amplitude, m/s^2, >= 0
  double start = 0.0;              ///< s
  double end = 0.0;                ///< s, > start
  ContactParameters contact = {};  ///< that holds throughout the step
  double contact_share = 0.0;      ///< share of its last half that is spent in contact, 1
};

/// The response of one step: its row of the table and the impacts that made it.
struct Response
{
  ResponseRow row;
  std::vector<TimedImpact> captured;  ///< in order of onset, at most ResponseOptions::captured_impacts
  DriveStep step;                     ///< that was evaluated
};

/// Evaluates the end of a step: steady state, period, impulses. `impacts` are those of the step by ascending onset;
/// episodes that are cut short do not count. Serves the direct sweep and the recorded bag alike. No impacts in the last
/// half of the step, whatever the transient did before, give a row of zeros with period 1.
Response evaluateResponse(const DriveStep& step, const std::vector<TimedImpact>& impacts, const ReferenceScales& scales,
                          const ResponseOptions& options = {});

/// Least number of drive cycles of duration `cycle` (s), up to ResponseOptions::longest_period, after which whole
/// impacts repeat, as the last of them show; 0: none, or too few of them. `impacts` by ascending onset, none of them
/// cut short.
int repetitionPeriod(const std::vector<TimedImpact>& impacts, double cycle, const ResponseOptions& options = {});

}  // namespace vibro_impact::core
