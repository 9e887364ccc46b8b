#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <vibro_impact/ModelInfo.h>

#include "vibro_impact/core/parameters.h"
#include "vibro_impact/ros/recording_check.h"

namespace vibro_impact::graph
{
/// A contact and the number of the first sample that it holds for.
struct DatedContact
{
  std::uint64_t seq = 0;
  core::ContactParameters contact;
};

/// What the model_info messages of a recording say: one model, whose contact may change from sample to sample.
class ContactHistory
{
public:
  explicit ContactHistory(std::string topic);

  /// In the order of recording; a repetition is left. Throws config::Error if the configuration is none, or is another
  /// one in more than its contact.
  void add(const ModelInfo& info);

  /// Throws config::Error if there was no message. The contact is that of the beginning.
  const core::SystemParameters& parameters() const;

  /// By ascending sample; the first one holds from the beginning of the recording on. After parameters().
  const std::vector<DatedContact>& contacts() const
  {
    return contacts_;
  }
  /// The contact at a sample.
  const DatedContact& at(std::uint64_t seq) const;

  /// Ranges of samples of which the contact is not known, as the running numbers of the messages tell. `first`: number
  /// of the first sample of the recording.
  std::vector<Loss> losses(std::uint64_t first) const;

private:
  std::string topic_;
  std::optional<core::SystemParameters> parameters_;
  std::string rest_;  // the configuration without its contact
  std::uint64_t first_number_ = 0;
  std::uint64_t first_seq_ = 0;
  std::uint64_t number_ = 0;
  std::vector<DatedContact> contacts_;
  std::vector<Loss> losses_;
};

}  // namespace vibro_impact::graph
