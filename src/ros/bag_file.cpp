#include "bag_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <ros/exception.h>
#include <rosbag/stream.h>
#include <sys/stat.h>
#include <unistd.h>

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

using Fields = std::map<std::string, std::string>;

/// Memory that is not cleared before it is written to.
struct Bytes
{
  explicit Bytes(std::size_t length) : data(new std::uint8_t[length]), size(length)
  {
  }

  std::unique_ptr<std::uint8_t[]> data;
  std::size_t size;
};

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
  Reader(std::uint8_t* data, std::size_t size) : data_(data), size_(size)
  {
  }
  explicit Reader(const Bytes& bytes) : Reader(bytes.data.get(), bytes.size)
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
    return {reinterpret_cast<const char*>(take(length)), length};
  }

  std::uint8_t* take(std::size_t length)
  {
    if (length > left())
    {
      throw Fault(text("a length of ", length, " bytes where ", left(), " are left"));
    }
    std::uint8_t* const begin = data_ + position_;
    position_ += length;
    return begin;
  }

private:
  std::uint8_t* data_;
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

void expect(const Fields& fields, Operation operation)
{
  if (operationOf(fields) != operation)
  {
    throw Fault(text("a record of type ", int{operationOf(fields)}, " where one of type ", int{operation}, " must be"));
  }
}

Fields record(Reader& reader, Operation operation)
{
  Fields fields = fieldsOf(reader.piece());
  expect(fields, operation);
  return fields;
}

/// The two fields of a record in a chunk that matter; the same as fieldsOf() gives, without its strings.
struct MessageHead
{
  std::uint8_t operation = 0;
  std::uint32_t connection = 0;
};

MessageHead messageHead(Reader header)
{
  MessageHead head;
  bool has_operation = false;
  bool has_connection = false;
  const auto value = [](const std::uint8_t* field, std::size_t length, const char* name, auto& number)
  {
    const std::size_t begin = std::strlen(name);
    if (length != begin + sizeof(number) || std::memcmp(field, name, begin) != 0)
    {
      return false;
    }
    std::memcpy(&number, field + begin, sizeof(number));
    return true;
  };
  while (header.left() > 0)
  {
    Reader piece = header.piece();
    const std::size_t length = piece.left();
    const std::uint8_t* const field = piece.take(length);
    has_operation = value(field, length, "op=", head.operation) || has_operation;
    has_connection = value(field, length, "conn=", head.connection) || has_connection;
  }
  if (!has_operation || (!has_connection && head.operation == message_data))
  {
    throw Fault("a record in a chunk without 'op' or 'conn'");
  }
  return head;
}

Bytes unpacked(const Fields& fields, Bytes stored)
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
  const auto length = static_cast<unsigned int>(stored.size);
  if (compression == "bz2")
  {
    rosbag::BZ2Stream(nullptr).decompress(result.data.get(), size, stored.data.get(), length);
  }
  else if (compression == "lz4")
  {
    rosbag::LZ4Stream(nullptr).decompress(result.data.get(), size, stored.data.get(), length);
  }
  else
  {
    throw Fault("a chunk whose compression is '" + compression.substr(0, 20) + "', must be none, bz2 or lz4");
  }
  return result;
}

/// Does something with a bag, whose faults become messages for the user.
template <typename Action>
auto guarded(const std::string& path, const Action& action)
{
  try
  {
    return action();
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
}  // namespace

/// An open file.
class BagSource
{
public:
  explicit BagSource(const std::string& path) : file_(open(path.c_str(), O_RDONLY | O_CLOEXEC))
  {
    struct stat status
    {
    };
    if (file_ < 0 || fstat(file_, &status) != 0)
    {
      throw config::Error(path + ": " + std::strerror(errno));
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~BagSource()
  {
    if (file_ >= 0)
    {
      close(file_);
    }
  }
  BagSource(const BagSource&) = delete;
  BagSource& operator=(const BagSource&) = delete;

  std::uint64_t size() const
  {
    return size_;
  }

  void read(std::uint64_t position, std::uint8_t* data, std::size_t length) const
  {
    while (length > 0)
    {
      const ssize_t got = pread(file_, data, length, static_cast<off_t>(position));
      if (got < 0 && errno == EINTR)
      {
        continue;
      }
      if (got <= 0)
      {
        throw Fault("the file cannot be read to its end");
      }
      data += got;
      position += static_cast<std::uint64_t>(got);
      length -= static_cast<std::size_t>(got);
    }
  }

private:
  int file_;
  std::uint64_t size_ = 0;
};

namespace
{
/// Reads a file on from a position.
class Cursor
{
public:
  Cursor(const BagSource& source, std::uint64_t position) : source_(source), position_(position)
  {
    if (position > source.size())
    {
      throw Fault(text("an offset of ", position, " in a file of ", source.size(), " bytes"));
    }
  }

  Bytes bytes(std::uint64_t length)
  {
    requireLeft(length);
    Bytes result(static_cast<std::size_t>(length));
    source_.read(position_, result.data.get(), result.size);
    position_ += length;
    return result;
  }

  Bytes rest()
  {
    return bytes(source_.size() - position_);
  }

  std::uint32_t number()
  {
    requireLeft(sizeof(std::uint32_t));
    std::uint8_t value[sizeof(std::uint32_t)];
    source_.read(position_, value, sizeof(value));
    position_ += sizeof(value);
    return Reader(value, sizeof(value)).number();
  }

  Bytes piece()
  {
    return bytes(number());
  }

  void skipPiece()
  {
    const std::uint32_t length = number();
    requireLeft(length);
    position_ += length;
  }

  Fields record(Operation operation)
  {
    const Bytes header = piece();
    Fields fields = fieldsOf(Reader(header));
    expect(fields, operation);
    return fields;
  }

private:
  void requireLeft(std::uint64_t length) const
  {
    if (length > source_.size() - position_)
    {
      throw Fault(text("a record of ", length, " bytes where ", source_.size() - position_, " are left"));
    }
  }

  const BagSource& source_;
  std::uint64_t position_;
};

std::string required(const Fields& fields, const std::string& name)
{
  const auto found = fields.find(name);
  if (found == fields.end())
  {
    throw Fault("a connection without '" + name + "'");
  }
  return found->second;
}
}  // namespace

BagChunk::BagChunk(std::string path, std::unique_ptr<std::uint8_t[]> data, std::size_t size)
    : path_(std::move(path)), data_(std::move(data))
{
  Reader reader(data_.get(), size);
  while (reader.left() > 0)
  {
    const std::size_t position = reader.position();
    const MessageHead head = messageHead(reader.piece());
    Reader piece = reader.piece();
    const std::size_t length = piece.left();
    std::uint8_t* const bytes = piece.take(length);
    if (head.operation == message_data)
    {
      records_.push_back({position, head.connection, {bytes, static_cast<std::uint32_t>(length)}});
    }
  }
}

BagMessage BagChunk::message(const BagEntry& entry) const
{
  const auto record =
      std::lower_bound(records_.begin(), records_.end(), entry.offset,
                       [](const Record& candidate, std::uint32_t offset) { return candidate.position < offset; });
  if (record == records_.end() || record->position != entry.offset || record->connection != entry.connection)
  {
    throw config::Error(damaged(path_, "an index that points at no message of its connection"));
  }
  return record->message;
}

BagFile::BagFile(const std::string& path) : path_(path), source_(std::make_unique<BagSource>(path))
{
  guarded(path_, [this] { readIndex(); });
}

BagFile::~BagFile() = default;

void BagFile::readIndex()
{
  const std::string expected = "#ROSBAG V2.0\n";
  const std::string version =
      Reader(Cursor(*source_, 0).bytes(std::min<std::uint64_t>(expected.size(), source_->size()))).rest();
  if (version != expected)
  {
    throw Fault("its format is '" + version.substr(0, version.find('\n')) + "', must be '#ROSBAG V2.0'");
  }
  Cursor cursor(*source_, expected.size());
  const Fields header = cursor.record(file_header);
  const auto position = numberOf<std::uint64_t>(header, "index_pos");
  if (position == 0)
  {
    throw config::Error(path_ + ": has no index, the recording did not end properly; 'rosbag reindex' repairs it");
  }
  if (const auto encryptor = header.find("encryptor"); encryptor != header.end() && !encryptor->second.empty())
  {
    throw Fault("it is encrypted; 'rosbag encrypt -p rosbag/NoEncryptor' decrypts it");
  }
  const Bytes bytes = Cursor(*source_, position).rest();
  Reader reader(bytes);
  const auto connections = numberOf<std::uint32_t>(header, "conn_count");
  for (std::uint32_t i = 0; i < connections; ++i)
  {
    const Fields fields = record(reader, connection);
    const Fields data = fieldsOf(reader.piece());
    connections_[numberOf<std::uint32_t>(fields, "conn")] = {required(fields, "topic"), required(data, "type"),
                                                             required(data, "md5sum")};
  }
  const auto chunks = numberOf<std::uint32_t>(header, "chunk_count");
  for (std::uint32_t i = 0; i < chunks; ++i)
  {
    const Fields fields = record(reader, chunk_info);
    Reader counts = reader.piece();
    if (counts.left() != std::uint64_t{8} * numberOf<std::uint32_t>(fields, "count"))
    {
      throw Fault("a list of connections that is not as long as it says");
    }
    Chunk chunk{numberOf<std::uint64_t>(fields, "chunk_pos"), {}};
    while (counts.left() > 0)
    {
      chunk.connections.insert(counts.number());
      counts.number();
    }
    chunks_.push_back(std::move(chunk));
  }
  std::sort(chunks_.begin(), chunks_.end(), [](const Chunk& a, const Chunk& b) { return a.position < b.position; });
  const auto twice = std::adjacent_find(chunks_.begin(), chunks_.end(),
                                        [](const Chunk& a, const Chunk& b) { return a.position == b.position; });
  if (twice != chunks_.end())
  {
    throw Fault("a chunk that is listed twice");
  }
}

std::vector<BagEntry> BagFile::entries(const std::set<std::uint32_t>& connections) const
{
  return guarded(path_,
                 [&]
                 {
                   std::vector<BagEntry> entries;
                   for (std::uint32_t i = 0; i < chunks_.size(); ++i)
                   {
                     addEntries(i, connections, entries);
                   }
                   return entries;
                 });
}

void BagFile::addEntries(std::uint32_t number, const std::set<std::uint32_t>& wanted,
                         std::vector<BagEntry>& entries) const
{
  const Chunk& chunk = chunks_[number];
  const bool holds_some = std::any_of(chunk.connections.begin(), chunk.connections.end(),
                                      [&](std::uint32_t id) { return wanted.count(id) != 0; });
  if (!holds_some)
  {
    return;
  }
  Cursor cursor(*source_, chunk.position);
  cursor.record(Operation::chunk);
  cursor.skipPiece();
  const std::size_t before = entries.size();
  for (std::size_t i = 0; i < chunk.connections.size(); ++i)
  {
    const Fields index = cursor.record(index_data);
    const Bytes bytes = cursor.piece();
    const auto id = numberOf<std::uint32_t>(index, "conn");
    if (connections_.count(id) == 0)
    {
      throw Fault("an index of a connection that is not there");
    }
    if (bytes.size != std::uint64_t{12} * numberOf<std::uint32_t>(index, "count"))
    {
      throw Fault("an index that is not as long as it says");
    }
    if (wanted.count(id) == 0)
    {
      continue;
    }
    Reader reader(bytes);
    while (reader.left() > 0)
    {
      BagEntry entry;
      entry.time.sec = reader.number();
      entry.time.nsec = reader.number();
      entry.chunk = number;
      entry.offset = reader.number();
      entry.connection = id;
      entries.push_back(entry);
    }
  }
  std::sort(entries.begin() + static_cast<std::ptrdiff_t>(before), entries.end(),
            [](const BagEntry& a, const BagEntry& b) { return a.offset < b.offset; });
}

std::unique_ptr<BagChunk> BagFile::load(std::uint32_t chunk) const
{
  return guarded(path_,
                 [&]
                 {
                   Cursor cursor(*source_, chunks_[chunk].position);
                   const Fields fields = cursor.record(Operation::chunk);
                   Bytes data = unpacked(fields, cursor.piece());
                   return std::make_unique<BagChunk>(path_, std::move(data.data), data.size);
                 });
}

std::string damaged(const std::string& path, std::string reason)
{
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return path + ": is cut off or damaged (" + reason + "); 'rosbag reindex' may rescue what there is";
}

}  // namespace vibro_impact::graph
