#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include <vibro_impact/StructureMotion.h>

#include "vibro_impact/ros/round_scale.h"

namespace vibro_impact::graph
{
/// Shows a motion slowed: plays a stretch of it, then goes on with the newest one. Stretches begin where the drive
/// rises and last whole cycles of it, so that a steady motion goes on without a jump.
class MotionPlayer
{
public:
  struct Row
  {
    std::vector<double> coordinates;
    double gap = 0.0;           ///< m
    double force = 0.0;         ///< N
    double acceleration = 0.0;  ///< m/s^2
  };

  /// `slow_motion`: shown time over stream time; 0: such that a drive cycle takes about two seconds. `stretch`: about
  /// how much shown time a stretch takes, s.
  MotionPlayer(double slow_motion, double stretch);

  /// Takes the rows of a message. What does not follow on the rows before begins anew. False, and nothing changes, if
  /// its lists do not fit each other or its step or sample period are not positive.
  bool add(const StructureMotion& motion);

  /// Where no drive cycle can be seen, this frequency (Hz) is taken for it; 0: none.
  void setNaturalFrequency(double frequency)
  {
    natural_frequency_ = frequency;
  }

  /// Goes on by `shown` seconds. Whether a new stretch has begun.
  bool advance(double shown);

  /// Whether there is something to show.
  bool playing() const
  {
    return !stretch_.empty();
  }

  /// The motion now: coordinates and gap on the straight line between two rows, the greatest force since the last
  /// advance(). Only while playing().
  Row row() const;

  /// All rows of the stretch.
  const std::vector<Row>& stretch() const
  {
    return stretch_;
  }

  /// Stream time from the start of the stretch to `offset` (s) after sample `seq`; negative before it, s.
  double time(std::uint64_t seq, double offset) const;
  /// The same to what is shown now.
  double position() const
  {
    return position_;
  }

  double slowMotion() const
  {
    return slow_.value();
  }
  /// Of the stretch, s.
  double duration() const;
  /// Of the drive, Hz; 0: unknown.
  double driveFrequency() const
  {
    return drive_frequency_;
  }

private:
  void begin();
  std::vector<double> rises() const;

  double shown_stretch_;
  double natural_frequency_ = 0.0;
  double drive_frequency_ = 0.0;
  RoundScale slow_;
  std::deque<Row> newest_;
  std::uint64_t next_ = 0;      ///< number of the sample of the row after the newest
  double row_period_ = 0.0;     ///< s
  double sample_period_ = 0.0;  ///< s
  std::uint64_t step_ = 0;

  std::vector<Row> stretch_;
  std::uint64_t stretch_next_ = 0;      ///< as next_, when the stretch was taken
  std::uint64_t stretch_first_ = 0;     ///< number of the sample of its first row
  double stretch_row_period_ = 0.0;     ///< s
  double stretch_sample_period_ = 0.0;  ///< s
  double position_ = 0.0;               ///< s of the stream's time, from the start of the stretch
  double last_position_ = 0.0;
};

}  // namespace vibro_impact::graph
