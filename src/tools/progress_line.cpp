#include "progress_line.h"

#include <unistd.h>

#include <iostream>

namespace vibro_impact::tools
{
namespace
{
using std::chrono::milliseconds;
using std::chrono::steady_clock;
}  // namespace

ProgressLine::ProgressLine()
    : terminal_(isatty(STDERR_FILENO) != 0), next_(steady_clock::now() + milliseconds(terminal_ ? 500 : 5000))
{
}

ProgressLine::~ProgressLine()
{
  if (terminal_ && shown_)
  {
    std::cerr << std::endl;
  }
}

bool ProgressLine::due(bool last) const
{
  return (last && terminal_) || steady_clock::now() >= next_;
}

void ProgressLine::show(const std::string& text)
{
  next_ = steady_clock::now() + milliseconds(terminal_ ? 100 : 5000);
  shown_ = true;
  std::cerr << (terminal_ ? "\r" : "") << text << (terminal_ ? "" : "\n") << std::flush;
}

}  // namespace vibro_impact::tools
