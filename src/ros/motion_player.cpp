#include "vibro_impact/ros/motion_player.h"

#include <algorithm>
#include <cmath>

namespace vibro_impact::graph
{
namespace
{
/// Shown time of a drive cycle, s.
constexpr double shown_cycle = 2.0;

/// Rows that are looked at for the drive, and that are kept at least.
constexpr std::size_t looked_at = 4096;

/// Rows that are kept at most: tens of megabytes.
constexpr std::size_t most_rows = 200000;
}  // namespace

MotionPlayer::MotionPlayer(double slow_motion, double stretch) : shown_stretch_(stretch), slow_(slow_motion)
{
}

bool MotionPlayer::add(const StructureMotion& motion)
{
  const std::size_t rows = motion.gap.size();
  const std::size_t columns = motion.mode.size();
  const double row_period = static_cast<double>(motion.step) * motion.sample_period;
  if (!(row_period > 0.0) || !std::isfinite(row_period) || motion.coordinates.size() != rows * columns ||
      motion.structure.size() != columns || motion.contact_deflection.size() != columns ||
      motion.force.size() != rows || motion.acceleration.size() != rows)
  {
    return false;
  }
  if (motion.seq != next_ || row_period != row_period_ ||
      (!newest_.empty() && newest_.back().coordinates.size() != columns))
  {
    newest_.clear();
  }
  row_period_ = row_period;
  sample_period_ = motion.sample_period;
  step_ = motion.step;
  next_ = motion.seq + motion.step * rows;
  for (std::size_t row = 0; row < rows; ++row)
  {
    const auto from = motion.coordinates.begin() + static_cast<std::ptrdiff_t>(row * columns);
    newest_.push_back({std::vector<double>(from, from + static_cast<std::ptrdiff_t>(columns)), motion.gap[row],
                       motion.force[row], motion.acceleration[row]});
  }
  const double wanted = slow_.value() > 0.0 ? 2.0 * shown_stretch_ / slow_.value() / row_period_ : 0.0;
  const auto kept =
      static_cast<std::size_t>(std::clamp(wanted, static_cast<double>(looked_at), static_cast<double>(most_rows)));
  while (newest_.size() > kept)
  {
    newest_.pop_front();
  }
  return true;
}

/// Where the acceleration of the newest rows rises through the middle of its range, in rows, with their fraction; noise
/// of a tenth of the range makes none.
std::vector<double> MotionPlayer::rises() const
{
  const std::size_t first = newest_.size() - std::min(newest_.size(), looked_at);
  const auto by_acceleration = [](const Row& a, const Row& b) { return a.acceleration < b.acceleration; };
  const auto [low, high] =
      std::minmax_element(newest_.begin() + static_cast<std::ptrdiff_t>(first), newest_.end(), by_acceleration);
  const double range = high->acceleration - low->acceleration;
  const double middle = 0.5 * (high->acceleration + low->acceleration);
  std::vector<double> rises;
  bool armed = false;
  for (std::size_t i = first + 1; i < newest_.size() && range > 0.0; ++i)
  {
    const double before = newest_[i - 1].acceleration;
    const double now = newest_[i].acceleration;
    armed = armed || before < middle - 0.1 * range;
    if (armed && before < middle && now >= middle)
    {
      rises.push_back(static_cast<double>(i - 1) + (middle - before) / (now - before));
      armed = false;
    }
  }
  return rises;
}

void MotionPlayer::begin()
{
  const std::vector<double> starts = rises();
  drive_frequency_ = starts.size() < 2
                         ? natural_frequency_
                         : static_cast<double>(starts.size() - 1) / ((starts.back() - starts.front()) * row_period_);
  slow_.update(drive_frequency_ > 0.0 ? std::max(1.0, shown_cycle * drive_frequency_) : 1.0);
  // whole cycles
  double rows = shown_stretch_ / slow_.value() / row_period_;
  if (drive_frequency_ > 0.0)
  {
    const double cycle = 1.0 / (drive_frequency_ * row_period_);
    rows = cycle * std::max(1.0, std::round(rows / cycle));
  }
  const auto most = static_cast<double>(newest_.size() - 1);
  const auto length = static_cast<std::size_t>(std::clamp(std::ceil(rows), 1.0, most));
  std::size_t first = newest_.size() - 1 - length;
  for (const double start : starts)
  {
    if (start + static_cast<double>(length) <= most)
    {
      first = static_cast<std::size_t>(start);
    }
  }
  const auto from = newest_.begin() + static_cast<std::ptrdiff_t>(first);
  stretch_.assign(from, from + static_cast<std::ptrdiff_t>(length) + 1);
  stretch_next_ = next_;
  stretch_first_ = next_ - step_ * (newest_.size() - first);
  stretch_row_period_ = row_period_;
  stretch_sample_period_ = sample_period_;
  position_ = last_position_ = 0.0;
}

bool MotionPlayer::advance(double shown)
{
  last_position_ = position_;
  if (slow_.value() > 0.0)
  {
    position_ += shown / slow_.value();
  }
  if (!stretch_.empty() && position_ < duration())
  {
    return false;
  }
  if (newest_.size() > 1 && (stretch_.empty() || next_ != stretch_next_))
  {
    begin();
    return true;
  }
  position_ = duration();
  return false;
}

double MotionPlayer::duration() const
{
  return stretch_.empty() ? 0.0 : static_cast<double>(stretch_.size() - 1) * stretch_row_period_;
}

MotionPlayer::Row MotionPlayer::row() const
{
  const double at = position_ / stretch_row_period_;
  const std::size_t i = std::min(static_cast<std::size_t>(at), stretch_.size() - 2);
  const double share = at - static_cast<double>(i);
  Row row = stretch_[i];
  const Row& next = stretch_[i + 1];
  for (std::size_t n = 0; n < row.coordinates.size(); ++n)
  {
    row.coordinates[n] += share * (next.coordinates[n] - row.coordinates[n]);
  }
  row.gap += share * (next.gap - row.gap);
  row.acceleration += share * (next.acceleration - row.acceleration);
  // A row's force is the greatest since the row before it.
  row.force = next.force;
  for (auto n = static_cast<std::size_t>(last_position_ / stretch_row_period_) + 1; n <= i; ++n)
  {
    row.force = std::max(row.force, stretch_[n].force);
  }
  return row;
}

double MotionPlayer::time(std::uint64_t seq, double offset) const
{
  // Numbers of samples are large, their differences are not.
  const double samples =
      seq >= stretch_first_ ? static_cast<double>(seq - stretch_first_) : -static_cast<double>(stretch_first_ - seq);
  return samples * stretch_sample_period_ + offset;
}

}  // namespace vibro_impact::graph
