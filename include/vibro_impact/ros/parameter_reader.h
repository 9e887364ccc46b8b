#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <xmlrpcpp/XmlRpcValue.h>

namespace vibro_impact::graph
{
/// Takes the entries out of one map of the parameter server and remembers every fault. A text that is wholly a number
/// counts as one.
///
/// A number that is missing or mistyped becomes one that is out of every range, so that the caller's check of ranges
/// rejects it: one place knows what is allowed.
class ParameterReader
{
public:
  /// `path`: how messages call the map; empty for the topmost one. Anything but a map counts as an empty one.
  ParameterReader(const XmlRpc::XmlRpcValue& map, std::string path);

  bool has(const std::string& key) const;

  /// The number `key`; NaN if it is none, `missing` if it is not there.
  double number(const std::string& key, double missing);

  /// The whole number `key`; -1 if it is none, `missing` if it is not there.
  std::int64_t integer(const std::string& key, std::int64_t missing);

  /// The text `key`; rejects another type, and gives `missing` then and if it is not there.
  std::string text(const std::string& key, const std::string& missing);

  /// The list of texts `key`; the same.
  std::vector<std::string> texts(const std::string& key, const std::vector<std::string>& missing);

  /// The map `key`; rejects another type and its absence.
  std::optional<XmlRpc::XmlRpcValue> map(const std::string& key);

  /// Says how `key` stands on the server and what it must be.
  void reject(const std::string& key, const std::string& allowed);

  /// The same for something that follows from several keys, with its value.
  void reject(const std::string& quantity, const std::string& value, const std::string& allowed);

  /// Rejects every key that none of the above was asked for.
  void rejectUnknown();

  /// One line each.
  const std::vector<std::string>& faults() const
  {
    return faults_;
  }

private:
  const XmlRpc::XmlRpcValue* find(const std::string& key);
  std::string below(const std::string& key) const;

  XmlRpc::XmlRpcValue map_;
  std::string path_;
  std::vector<std::string> known_;
  std::vector<std::string> faults_;
};

}  // namespace vibro_impact::graph
