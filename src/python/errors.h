#pragma once

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <pybind11/pybind11.h>

#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"

namespace vibro_impact::python
{
/// A text from outside, what is not UTF-8 in it replaced.
inline pybind11::str textOf(const std::string& text)
{
  return pybind11::reinterpret_steal<pybind11::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<pybind11::ssize_t>(text.size()), "replace"));
}

/// From here on config::Error is vibro_impact.Error in Python.
inline void registerErrors()
{
  pybind11::register_exception_translator(
      [](std::exception_ptr pointer)
      {
        try
        {
          if (pointer)
          {
            std::rethrow_exception(pointer);
          }
        }
        catch (const config::Error& error)
        {
          PyErr_SetObject(pybind11::module::import("vibro_impact.error").attr("Error").ptr(),
                          textOf(error.what()).ptr());
        }
      });
}

/// What the core refuses is an error of the user's.
template <typename Function>
auto withErrors(const Function& function)
{
  try
  {
    return function();
  }
  catch (const std::invalid_argument& error)
  {
    throw config::Error(error.what());
  }
}

/// The value of an argument. Throws config::Error unless it lies in [least, greatest].
inline double number(const std::string& name, double value, double least, double greatest)
{
  if (!(value >= least && value <= greatest))
  {
    throw config::Error(name + " is " + config::formatNumber(value) + ", must be a number from " +
                        config::formatNumber(least) + " to " + config::formatNumber(greatest));
  }
  return value;
}

inline std::int64_t wholeNumber(const std::string& name, std::int64_t value, std::int64_t least, std::int64_t greatest)
{
  if (value < least || value > greatest)
  {
    throw config::Error(name + " is " + std::to_string(value) + ", must be a whole number from " +
                        std::to_string(least) + " to " + std::to_string(greatest));
  }
  return value;
}

}  // namespace vibro_impact::python
