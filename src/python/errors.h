#pragma once

#include <pybind11/pybind11.h>

#include "vibro_impact/config/error.h"

namespace vibro_impact::python
{
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
          PyErr_SetString(pybind11::module::import("vibro_impact.error").attr("Error").ptr(), error.what());
        }
      });
}

}  // namespace vibro_impact::python
