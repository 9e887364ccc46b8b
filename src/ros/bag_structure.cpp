#include "bag_structure.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <ros/exception.h>
#include <rosbag/stream.h>

#include "text.h"
#include "vibro_impact/config/error.h"

namespace vibro_impact::graph
{
namespace
{
// No more than a message may have on its way through a graph.
constexpr std::uint32_t largest_chunk = 1'000'000'000;

enum Operation : std::uint8_t
{
  message_data = 0x02,
  file_header = 0x03,
  index_data = 0x04,
  chunk = 0x05,
  chunk_info = 0x06,
  connection = 0x07
};

using Bytes = std::vector<std::uint8_t>;
using Fields = std::map<std::string, std::string>;

/// What is wrong with a bag.
class Fault : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// A piece of memory that is read from its beginning.
class Reader
{
public:
  Reader(const std::uint8_t* data, std::size_t size) : data_(data), size_(size)
  {
  }
  explicit Reader(const Bytes& bytes) : Reader(bytes.data(), bytes.size())
  {
  }

  std::size_t left() const
  {
    return size_ - position_;
  }
  std::size_t position() const
  {
    return position_;
  }

  std::uint32_t number()
  {
    std::uint32_t value = 0;
    std::memcpy(&value, take(sizeof(value)), sizeof(value));
    return value;
  }

  /// A length and as many bytes.
  Reader piece()
  {
    const std::uint32_t length = number();
    return {take(length), length};
  }

  std::string rest()
  {
    const std::size_t length = left();
    const auto* bytes = reinterpret_cast<const char*>(take(length));
    return length == 0 ? std::string() : std::string(bytes, length);
  }

private:
  const std::uint8_t* take(std::size_t length)
  {
    if (length > left())
    {
      throw Fault(text("a length of ", length, " bytes where ", left(), " are left"));
    }
    const std::uint8_t* begin = data_ == nullptr ? nullptr : data_ + position_;
    position_ += length;
    return begin;
  }

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t position_ = 0;
};

Fields fieldsOf(Reader header)
{
  Fields fields;
  while (header.left() > 0)
  {
    const std::string field = header.piece().rest();
    const std::size_t equals = field.find('=');
    if (equals == std::string::npos)
    {
      throw Fault("a field of a header without '='");
    }
    fields[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return fields;
}

template <typename Number>
Number numberOf(const Fields& fields, const std::string& name)
{
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() != sizeof(Number))
  {
    throw Fault("a record without a field '" + name + "' of " + std::to_string(sizeof(Number)) + " bytes");
  }
  Number value = 0;
  std::memcpy(&value, found->second.data(), sizeof(value));
  return value;
}

std::uint8_t operationOf(const Fields& fields)
{
  return numberOf<std::uint8_t>(fields, "op");
}

class BagFile
{
public:
  explicit BagFile(const std::string& path) : file_(path, std::ios::binary)
  {
    file_.seekg(0, std::ios::end);
    size_ = static_cast<std::uint64_t>(file_.tellg());
  }

  void check()
  {
    std::string version;
    seek(0);
    std::getline(file_, version);
    if (version != "#ROSBAG V2.0")
    {
      throw Fault("its format is '" + version.substr(0, 20) + "', must be '#ROSBAG V2.0'");
    }
    position_ = version.size() + 1;
    const Fields header = record(file_header);
    skip(number());
    const auto index = numberOf<std::uint64_t>(header, "index_pos");
    if (index == 0)
    {
      return;
    }
    if (const auto encryptor = header.find("encryptor"); encryptor != header.end() && !encryptor->second.empty())
    {
      throw Fault("it is encrypted; 'rosbag encrypt -p rosbag/NoEncryptor' decrypts it");
    }
    seek(index);
    const auto connections = numberOf<std::uint32_t>(header, "conn_count");
    for (std::uint32_t i = 0; i < connections; ++i)
    {
      checkConnection();
    }
    const auto chunks = numberOf<std::uint32_t>(header, "chunk_count");
    for (std::uint32_t i = 0; i < chunks; ++i)
    {
      checkChunkInfo();
    }
    for (const auto& [position, indexes] : chunks_)
    {
      checkChunk(position, indexes);
    }
  }

private:
  void seek(std::uint64_t position)
  {
    if (position > size_)
    {
      throw Fault(text("an offset of ", position, " in a file of ", size_, " bytes"));
    }
    position_ = position;
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(position));
  }

  void skip(std::uint64_t length)
  {
    seek(position_ + length);
  }

  Bytes bytes(std::uint64_t length)
  {
    if (length > size_ - position_)
    {
      throw Fault(text("a record of ", length, " bytes where ", size_ - position_, " are left"));
    }
    Bytes result(static_cast<std::size_t>(length));
    file_.read(reinterpret_cast<char*>(result.data()), static_cast<std::streamsize>(length));
    if (!file_)
    {
      throw Fault("the file cannot be read to its end");
    }
    position_ += length;
    return result;
  }

  std::uint32_t number()
  {
    const Bytes value = bytes(sizeof(std::uint32_t));
    return Reader(value).number();
  }

  Bytes piece()
  {
    return bytes(number());
  }

  static void expect(const Fields& fields, Operation operation)
  {
    if (operationOf(fields) != operation)
    {
      throw Fault(
          text("a record of type ", int{operationOf(fields)}, " where one of type ", int{operation}, " must be"));
    }
  }

  Fields record(Operation operation)
  {
    const Bytes header = piece();
    Fields fields = fieldsOf(Reader(header));
    expect(fields, operation);
    return fields;
  }

  void checkConnection()
  {
    const Fields fields = record(connection);
    connections_.insert(numberOf<std::uint32_t>(fields, "conn"));
    const Bytes header = piece();
    fieldsOf(Reader(header));
  }

  void checkChunkInfo()
  {
    const Fields fields = record(chunk_info);
    const Bytes data = piece();
    const auto count = numberOf<std::uint32_t>(fields, "count");
    if (data.size() != std::uint64_t{8} * count)
    {
      throw Fault("a list of connections that is not as long as it says");
    }
    std::set<std::uint32_t> indexed;
    Reader reader(data);
    for (std::uint32_t i = 0; i < count; ++i)
    {
      indexed.insert(reader.number());
      reader.number();
    }
    const auto position = numberOf<std::uint64_t>(fields, "chunk_pos");
    if (!chunks_.emplace(position, indexed.size()).second)
    {
      throw Fault("a chunk that is listed twice");
    }
  }

  void checkChunk(std::uint64_t position, std::size_t indexes)
  {
    seek(position);
    const Fields fields = record(chunk);
    const Bytes stored = piece();
    const std::vector<bool> messages = messagesOf(unpacked(fields, stored));
    for (std::size_t i = 0; i < indexes; ++i)
    {
      const Fields index = record(index_data);
      const Bytes entries = piece();
      if (connections_.count(numberOf<std::uint32_t>(index, "conn")) == 0)
      {
        throw Fault("an index of a connection that is not there");
      }
      const auto count = numberOf<std::uint32_t>(index, "count");
      if (entries.size() != std::uint64_t{12} * count)
      {
        throw Fault("an index that is not as long as it says");
      }
      Reader reader(entries);
      for (std::uint32_t entry = 0; entry < count; ++entry)
      {
        reader.number();
        reader.number();
        const std::uint32_t offset = reader.number();
        if (offset >= messages.size() || !messages[offset])
        {
          throw Fault("an index that points at no message");
        }
      }
    }
  }

  static Bytes unpacked(const Fields& fields, const Bytes& stored)
  {
    const auto size = numberOf<std::uint32_t>(fields, "size");
    const auto found = fields.find("compression");
    const std::string compression = found == fields.end() ? std::string() : found->second;
    if (compression == "none")
    {
      return stored;
    }
    if (size > largest_chunk)
    {
      throw Fault(text("a chunk of ", size, " bytes, at most ", largest_chunk, " are allowed"));
    }
    Bytes result(size);
    Bytes source = stored;
    const auto length = static_cast<unsigned int>(source.size());
    if (compression == "bz2")
    {
      rosbag::BZ2Stream(nullptr).decompress(result.data(), size, source.data(), length);
    }
    else if (compression == "lz4")
    {
      rosbag::LZ4Stream(nullptr).decompress(result.data(), size, source.data(), length);
    }
    else
    {
      throw Fault("a chunk whose compression is '" + compression.substr(0, 20) + "', must be none, bz2 or lz4");
    }
    return result;
  }

  /// Whether a message begins at each byte of a chunk.
  static std::vector<bool> messagesOf(const Bytes& chunk_data)
  {
    std::vector<bool> begins(chunk_data.size(), false);
    Reader reader(chunk_data);
    while (reader.left() > 0)
    {
      const std::size_t position = reader.position();
      const Fields fields = fieldsOf(reader.piece());
      reader.piece();
      begins[position] = operationOf(fields) == message_data;
    }
    return begins;
  }

  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  std::set<std::uint32_t> connections_;
  std::map<std::uint64_t, std::size_t> chunks_;  // where they are, and how many indexes follow
};
}  // namespace

std::string damaged(const std::string& path, std::string reason)
{
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return path + ": is cut off or damaged (" + reason + "); 'rosbag reindex' may rescue what there is";
}

void requireSoundBag(const std::string& path)
{
  try
  {
    BagFile(path).check();
  }
  catch (const Fault& fault)
  {
    throw config::Error(damaged(path, fault.what()));
  }
  catch (const ros::Exception& error)  // of a decompressor
  {
    throw config::Error(damaged(path, error.what()));
  }
}

}  // namespace vibro_impact::graph
