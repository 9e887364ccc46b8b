#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <ros/time.h>

namespace vibro_impact::graph
{
/// A topic as one publisher of it was recorded.
struct BagConnection
{
  std::string topic;
  std::string datatype;
  std::string md5sum;
};

/// Where a message lies in a bag.
struct BagEntry
{
  ros::Time time;  ///< of recording
  std::uint32_t chunk = 0;
  std::uint32_t offset = 0;  ///< in the chunk
  std::uint32_t connection = 0;
};

class BagSource;

/// Bytes of a message, for as long as its chunk lives.
struct BagMessage
{
  std::uint8_t* data = nullptr;
  std::uint32_t size = 0;
};

/// A chunk in memory, decompressed; all lengths in it hold together.
class BagChunk
{
public:
  /// `path`: of the bag, for messages.
  BagChunk(std::string path, std::unique_ptr<std::uint8_t[]> data, std::size_t size);

  /// The message of an entry. Throws config::Error if there is none of its connection.
  BagMessage message(const BagEntry& entry) const;

private:
  struct Record
  {
    std::size_t position = 0;
    std::uint32_t connection = 0;
    BagMessage message;
  };

  std::string path_;
  std::unique_ptr<std::uint8_t[]> data_;
  std::vector<Record> records_;  // of messages, by ascending position
};

/// A bag of format 2.0 that need not be sound: every length, offset and number is checked before it is believed, and no
/// more memory is asked for than there are bytes, or than a chunk says it has when it is decompressed.
///
/// (rosbag's own reader believes them: where one is wrong, it reads beyond its memory or asks for all there is; and it
/// looks for each message by itself, where here a chunk is read in one go.)
///
/// Several threads may read one bag. Everything throws config::Error, which names the path and what is wrong.
class BagFile
{
public:
  /// Opens a bag and reads which connections and chunks it has.
  explicit BagFile(const std::string& path);
  ~BagFile();
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;

  const std::map<std::uint32_t, BagConnection>& connections() const
  {
    return connections_;
  }

  /// The messages of these connections, in the order in which they lie in the file.
  std::vector<BagEntry> entries(const std::set<std::uint32_t>& connections) const;

  /// Reads and decompresses a chunk.
  std::unique_ptr<BagChunk> load(std::uint32_t chunk) const;

private:
  struct Chunk
  {
    std::uint64_t position = 0;
    std::set<std::uint32_t> connections;
  };

  void readIndex();
  void addEntries(std::uint32_t number, const std::set<std::uint32_t>& wanted, std::vector<BagEntry>& entries) const;

  std::string path_;
  std::unique_ptr<const BagSource> source_;
  std::map<std::uint32_t, BagConnection> connections_;
  std::vector<Chunk> chunks_;  // by ascending position
};

/// One line of whatever there was to say of a damaged bag.
std::string damaged(const std::string& path, std::string reason);

}  // namespace vibro_impact::graph
