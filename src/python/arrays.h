#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "vibro_impact/config/response_table.h"
#include "vibro_impact/core/response.h"

namespace vibro_impact::python
{
/// An impact in an array, its onset on the array's axis of time. The type of the elements of NumPy is registered by
/// _core, as are those of ResponseRow and ImpactRow.
struct ImpactElement
{
  std::uint64_t number;
  double onset;             // s
  double duration;          // s
  double impulse;           // N s
  double peak_force;        // N
  double peak_time;         // s
  double approach_speed;    // m/s
  double separation_speed;  // m/s
  double energy_lost;       // J
  bool cut_short;
  double dissipated;    // J
  double mapping_loss;  // J
  double base_work;     // J
};

/// The elements themselves, not a copy.
template <typename T>
pybind11::array_t<T> adopt(std::vector<T>&& elements)
{
  auto owned = std::make_unique<std::vector<T>>(std::move(elements));
  const auto size = static_cast<pybind11::ssize_t>(owned->size());
  T* const data = owned->data();
  const pybind11::capsule owner(owned.get(), [](void* pointer) { delete static_cast<std::vector<T>*>(pointer); });
  static_cast<void>(owned.release());
  return pybind11::array_t<T>(size, data, owner);
}

inline pybind11::array_t<double> copyOf(const std::vector<double>& values)
{
  return pybind11::array_t<double>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

/// The rows of frf.csv.
inline pybind11::array_t<core::ResponseRow> responseArray(const std::vector<core::Response>& responses)
{
  std::vector<core::ResponseRow> rows;
  rows.reserve(responses.size());
  for (const core::Response& response : responses)
  {
    rows.push_back(response.row);
  }
  return adopt(std::move(rows));
}

/// The rows of impacts.csv.
inline pybind11::array_t<config::ImpactRow> impactArray(const std::vector<core::Response>& responses)
{
  return adopt(config::impactRows(responses));
}

}  // namespace vibro_impact::python
