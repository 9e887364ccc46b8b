#pragma once

#include <optional>
#include <vector>

#include "vibro_impact/config/output_directory.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::config
{
/// What a user wants to know of a model before its response.
struct ModelSummary
{
  std::vector<double> free_frequencies;        ///< natural frequencies of S0, Hz
  std::vector<double> contact_frequencies;     ///< natural frequencies of S1, Hz
  std::optional<double> free_frequency_hz;     ///< lowest one of S0 whose mode moves the contact point, if there is one
  std::optional<double> contact_frequency_hz;  ///< the same of S1
  std::optional<double> frequency_ratio;       ///< contact_frequency_hz/free_frequency_hz
  std::vector<double> mapping_loss;            ///< SwitchedModel::mappingLoss(), one per mode of S0, 1
};

ModelSummary summarize(const core::SwitchedModel& model);

/// model.csv: rows of key and value; free_frequency_hz, contact_frequency_hz and frequency_ratio where there are any,
/// then all natural frequencies and losses as free_1_hz, ..., contact_1_hz, ..., mapping_loss_1, ...
OutputFile modelTable(const ModelSummary& summary);

}  // namespace vibro_impact::config
