#pragma once

#include <chrono>
#include <utility>

#include <pybind11/pybind11.h>

namespace vibro_impact::python
{
/// Called often from a long computation that does not hold the interpreter's lock: every 50 ms, and at the end, lets
/// signals through (Ctrl-C raises KeyboardInterrupt) and tells a function of Python how far it has come.
class Pulse
{
public:
  /// `progress`: a callable or None.
  explicit Pulse(const pybind11::object& progress) : progress_(progress)
  {
  }

  void operator()(double share)
  {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_ && share < 1.0)
    {
      return;
    }
    const pybind11::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0)
    {
      throw pybind11::error_already_set();
    }
    if (!progress_.is_none())
    {
      progress_(share);
    }
    next_ = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
  }

private:
  const pybind11::object& progress_;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace vibro_impact::python
