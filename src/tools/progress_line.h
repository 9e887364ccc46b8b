#pragma once

#include <chrono>
#include <string>

namespace vibro_impact::tools
{
/// How far long work has come, a line on stderr: renewed in place on a terminal, written every few seconds elsewhere.
class ProgressLine
{
public:
  ProgressLine();
  /// Ends the line of a terminal, so that what is said next, an error for one, begins a line.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Whether a line is due: time has passed, or this is the `last` one and there is a terminal that shows it.
  bool due(bool last) const;
  void show(const std::string& text);

private:
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace vibro_impact::tools
