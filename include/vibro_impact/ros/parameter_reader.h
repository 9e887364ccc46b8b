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
class ParameterReader
{
public:
  /// `path`: how messages call the map; empty for the topmost one. Anything but a map counts as an empty one.
  ParameterReader(const XmlRpc::XmlRpcValue& map, std::string path);

  bool has(const std::string& key) const;

  /// Whether `key` is this text.
  bool isWord(const std::string& key, const std::string& word) const;

  // Numbers whose range the caller checks. One of another type becomes one that is out of every range, so that this
  // check rejects it.

  /// The number `key`; NaN if it is none, `missing` if it is not there.
  double number(const std::string& key, double missing);

  /// The whole number `key`; -1 if it is none, `missing` if it is not there.
  std::int64_t integer(const std::string& key, std::int64_t missing);

  // Numbers in a range, rejected if they are not; `unit` (such as " (s)", or empty) is for the message.

  /// The number `key`, above 0 and at most `most`, or `missing` if it is not there.
  double positive(const std::string& key, double missing, double most, const std::string& unit);

  /// The number `key`, from 0 to `most`; the same.
  double nonNegative(const std::string& key, double missing, double most, const std::string& unit);

  /// The whole number `key`, from 0 to `most`; the same.
  std::uint32_t count(const std::string& key, std::uint32_t missing, std::uint32_t most);

  /// The text `key`; rejects another type, and gives `missing` then and if it is not there.
  std::string text(const std::string& key, const std::string& missing);

  /// The list of texts `key`; the same.
  std::vector<std::string> texts(const std::string& key, const std::vector<std::string>& missing);

  /// The map `key`; rejects another type and its absence.
  std::optional<XmlRpc::XmlRpcValue> map(const std::string& key);

  /// The list of maps `key`, each to be read on its own; rejects another type, an empty list and its absence.
  std::vector<ParameterReader> maps(const std::string& key);

  /// A map of those of the keys that are there, for a loader of their own.
  XmlRpc::XmlRpcValue take(const std::vector<std::string>& keys);

  /// Says how `key` stands on the server and what it must be.
  void reject(const std::string& key, const std::string& allowed);

  /// The same for something that follows from several keys, with its value.
  void reject(const std::string& quantity, const std::string& value, const std::string& allowed);

  /// Rejects every key that none of the above was asked for.
  void rejectUnknown();

  /// Takes over what was rejected by the reader of a part of this map.
  void addFaults(const ParameterReader& part);

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
