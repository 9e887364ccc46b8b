#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <vibro_impact/ContactForce.h>
#include <vibro_impact/Gap.h>
#include <vibro_impact/Impact.h>

namespace vibro_impact::graph
{
/// What the answers of one simulator come to, and what of them did not arrive.
class ResponseSummary
{
public:
  void add(const Gap& gap);
  void add(const ContactForce& force);
  void add(const Impact& impact);

  /// The totals since the start; a warning where something was missing since the last report.
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  /// Follows a count that goes on, leaves something out, or begins anew.
  class Counter
  {
  public:
    /// The next `count` are from `number` on.
    void take(std::uint64_t number, std::uint64_t count);

    std::uint64_t taken() const
    {
      return taken_;
    }
    std::uint64_t missing() const
    {
      return missing_;
    }

  private:
    bool started_ = false;
    std::uint64_t next_ = 0;
    std::uint64_t taken_ = 0;
    std::uint64_t missing_ = 0;
  };

  std::uint64_t missing() const
  {
    return gap_samples_.missing() + force_samples_.missing() + impacts_.missing();
  }

  Counter gap_samples_;
  Counter force_samples_;
  Counter impacts_;
  std::uint64_t reported_missing_ = 0;
  double smallest_gap_ = std::numeric_limits<double>::infinity();  ///< m
  std::uint64_t samples_in_contact_ = 0;
  double peak_force_ = 0.0;        ///< N
  double impulse_ = 0.0;           ///< of all impacts, N s
  double greatest_impulse_ = 0.0;  ///< N s
};

}  // namespace vibro_impact::graph
