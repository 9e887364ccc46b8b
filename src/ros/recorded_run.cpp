#include "vibro_impact/ros/recorded_run.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <utility>

#include <geometry_msgs/AccelStamped.h>
#include <ros/message_traits.h>
#include <sensor_msgs/Imu.h>
#include <sys/stat.h>
#include <vibro_impact/ContactForce.h>
#include <vibro_impact/Gap.h>

#include "bag_file.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/checked_stream.h"

namespace vibro_impact::graph
{
namespace
{
void requireBag(const std::string& path)
{
  struct stat status
  {
  };
  if (stat(path.c_str(), &status) != 0)
  {
    throw config::Error(path + ": no such file");
  }
  if (!S_ISREG(status.st_mode))
  {
    throw config::Error(path + ": is not a file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file)
  {
    throw config::Error(path + ": cannot be read");
  }
  const std::string expected = "#ROSBAG V";
  std::string magic(expected.size(), '\0');
  file.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (magic != expected)
  {
    throw config::Error(path + ": is not a bag");
  }
}

std::string list(const std::set<std::string>& names)
{
  std::string text;
  for (const std::string& name : names)
  {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

std::string absolute(const std::string& topic)
{
  return topic.empty() || topic.front() != '/' ? "/" + topic : topic;
}

bool isInside(const std::string& topic, const std::string& name_space)
{
  std::string prefix = name_space;
  while (!prefix.empty() && prefix.back() == '/')
  {
    prefix.pop_back();
  }
  if (!prefix.empty() && prefix.front() != '/')
  {
    prefix.insert(0, 1, '/');
  }
  return absolute(topic).compare(0, prefix.size() + 1, prefix + "/") == 0;
}

// A message as it was recorded.
struct RecordedMessage
{
  const BagConnection& connection;
  BagMessage bytes;
};

// Its topic's type may have meant something else when it was recorded. The message is one to be written over, whose
// memory serves again.
template <typename Message>
const Message& decode(const RecordedMessage& recorded, Message& message)
{
  const BagConnection& connection = recorded.connection;
  if (connection.md5sum != ros::message_traits::md5sum<Message>())
  {
    throw config::Error("topic " + connection.topic + ": was recorded with another definition of " +
                        connection.datatype + " (" + connection.md5sum + " instead of " +
                        ros::message_traits::md5sum<Message>() + ")");
  }
  CheckedStream stream(recorded.bytes.data, recorded.bytes.size);
  stream.next(message);
  return message;
}

// The chunks used last: bags whose messages lie in another order than that of their times, and several at once, go to
// and fro between a few.
class ChunkCache
{
public:
  const BagChunk& get(const BagFile& bag, std::uint32_t chunk)
  {
    const auto same = [&](const Slot& slot) { return slot.bag == &bag && slot.number == chunk; };
    auto found = std::find_if(slots_.begin(), slots_.end(), same);
    if (found == slots_.end())
    {
      found = std::prev(slots_.end());
      *found = {&bag, chunk, nullptr};  // before the next one is loaded: its memory serves again
      found->chunk = bag.load(chunk);
    }
    std::rotate(slots_.begin(), found, std::next(found));
    return *slots_.front().chunk;
  }

private:
  struct Slot
  {
    const BagFile* bag = nullptr;
    std::uint32_t number = 0;
    std::unique_ptr<const BagChunk> chunk;
  };
  std::array<Slot, 4> slots_;  // the one used last first
};
}  // namespace

struct RecordedRun::Implementation
{
  void open(const std::vector<std::string>& paths)
  {
    if (paths.empty())
    {
      throw config::Error("no bag is given");
    }
    for (const std::string& path : paths)
    {
      names += (names.empty() ? "" : ", ") + path;
      requireBag(path);
      bags.push_back(std::make_unique<const BagFile>(path));
    }
  }

  std::set<std::string> topicsOf(const std::string& type) const
  {
    std::set<std::string> topics_of_type;
    for (const auto& bag : bags)
    {
      for (const auto& [id, connection] : bag->connections())
      {
        if (connection.datatype == type)
        {
          topics_of_type.insert(connection.topic);
        }
      }
    }
    return topics_of_type;
  }

  template <typename Message>
  std::string find(const std::string& name_space, bool required)
  {
    const std::string type = ros::message_traits::datatype<Message>();
    std::set<std::string> all;
    std::set<std::string> inside;
    for (const std::string& topic : topicsOf(type))
    {
      all.insert(topic);
      if (isInside(topic, name_space))
      {
        inside.insert(topic);
      }
    }
    if (inside.empty() && !required)
    {
      return {};
    }
    if (all.empty())
    {
      throw config::Error(names + ": holds no topic of type " + type);
    }
    if (inside.size() != 1)
    {
      throw config::Error(names + ": holds " + std::to_string(all.size()) +
                          (all.size() == 1 ? " topic of type " : " topics of type ") + type + " (" + list(all) + "); " +
                          (name_space.empty() ? "choose the run by --namespace"
                                              : "--namespace '" + name_space + "' must hold one, holds " +
                                                    std::to_string(inside.size())));
    }
    return *inside.begin();
  }

  /// The topic of this name; a name is that of the bag with or without its leading slash.
  template <typename Message>
  std::string require(const std::string& topic) const
  {
    const std::string type = ros::message_traits::datatype<Message>();
    const std::set<std::string> all = topicsOf(type);
    for (const std::string& name : all)
    {
      if (absolute(name) == absolute(topic))
      {
        return name;
      }
    }
    throw config::Error(names + ": holds no topic " + topic + " of type " + type +
                        (all.empty() ? "" : " (but " + list(all) + ")"));
  }

  struct Entry
  {
    BagEntry entry;
    std::uint32_t bag = 0;
  };

  /// The messages of these topics, in the order of recording; those of one time in that of the files.
  std::vector<Entry> entriesOf(const std::set<std::string>& wanted) const
  {
    std::vector<Entry> entries;
    for (std::uint32_t i = 0; i < bags.size(); ++i)
    {
      std::set<std::uint32_t> connections;
      for (const auto& [id, connection] : bags[i]->connections())
      {
        if (wanted.count(connection.topic) != 0)
        {
          connections.insert(id);
        }
      }
      for (const BagEntry& entry : bags[i]->entries(connections))
      {
        entries.push_back({entry, i});
      }
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.entry.time < b.entry.time; });
    return entries;
  }

  void read(const std::set<std::string>& wanted, const Progress& progress,
            const std::function<void(const RecordedMessage&)>& take) const
  {
    const std::vector<Entry> entries = entriesOf(wanted);
    ChunkCache chunks;
    try
    {
      for (std::size_t i = 0; i < entries.size(); ++i)
      {
        const auto& [entry, bag] = entries[i];
        const BagChunk& chunk = chunks.get(*bags[bag], entry.chunk);
        take({bags[bag]->connections().at(entry.connection), chunk.message(entry)});
        if (progress)
        {
          progress(static_cast<double>(i + 1) / static_cast<double>(entries.size()));
        }
      }
    }
    catch (const ros::Exception& error)
    {
      throw config::Error(damaged(names, error.what()));
    }
  }

  /// A topic alone, if there is one.
  template <typename Message>
  void readAll(const std::string& topic, const std::function<void(const Message&)>& sink) const
  {
    if (!topic.empty())
    {
      Message message;
      read({topic}, {}, [&](const RecordedMessage& recorded) { sink(decode(recorded, message)); });
    }
  }

  std::string names;  // of the bags, for messages
  std::vector<std::unique_ptr<const BagFile>> bags;
  RecordedTopics topics;
};

RecordedRun::RecordedRun(const std::vector<std::string>& paths, const std::string& name_space,
                         RecordedContents contents, const std::string& excitation)
    : implementation_(std::make_unique<Implementation>())
{
  Implementation& self = *implementation_;
  self.open(paths);
  self.topics.base_excitation =
      excitation.empty() ? self.find<BaseExcitation>(name_space, true) : self.require<BaseExcitation>(excitation);
  const bool whole = contents == RecordedContents::whole_run;
  if (whole)
  {
    self.topics.gap = self.find<Gap>(name_space, true);
    self.topics.contact_force = self.find<ContactForce>(name_space, true);
    self.topics.impact = self.find<Impact>(name_space, false);
  }
  self.topics.model_info = self.find<ModelInfo>(name_space, whole);
  self.topics.stream_start = self.find<StreamStart>(name_space, false);
}

RecordedRun::~RecordedRun() = default;
RecordedRun::RecordedRun(RecordedRun&&) noexcept = default;
RecordedRun& RecordedRun::operator=(RecordedRun&&) noexcept = default;

const RecordedTopics& RecordedRun::topics() const
{
  return implementation_->topics;
}

void RecordedRun::read(RecordingSink& sink, const Progress& progress) const
{
  const RecordedTopics& topics = implementation_->topics;
  std::set<std::string> wanted;
  for (const std::string* topic : {&topics.base_excitation, &topics.gap, &topics.contact_force, &topics.model_info,
                                   &topics.impact, &topics.stream_start})
  {
    if (!topic->empty())
    {
      wanted.insert(*topic);
    }
  }
  BaseExcitation excitation;
  Gap gap;
  ContactForce force;
  Impact impact;
  StreamStart start;
  ModelInfo info;
  implementation_->read(wanted, progress,
                        [&](const RecordedMessage& recorded)
                        {
                          const std::string& topic = recorded.connection.topic;
                          if (topic == topics.base_excitation)
                          {
                            sink.onExcitation(decode(recorded, excitation));
                          }
                          else if (topic == topics.gap)
                          {
                            decode(recorded, gap);
                            sink.onGap(headOf(gap, gap.gap.size()), gap.gap);
                          }
                          else if (topic == topics.contact_force)
                          {
                            decode(recorded, force);
                            sink.onContactForce(headOf(force, force.force.size()), force.force);
                          }
                          else if (topic == topics.impact)
                          {
                            sink.onImpact(decode(recorded, impact));
                          }
                          else if (topic == topics.stream_start)
                          {
                            sink.onStreamStart(decode(recorded, start));
                          }
                          else
                          {
                            sink.onModelInfo(decode(recorded, info));
                          }
                        });
}

void RecordedRun::readModelInfo(const std::function<void(const ModelInfo&)>& sink) const
{
  implementation_->readAll<ModelInfo>(implementation_->topics.model_info, sink);
}

void RecordedRun::readExcitation(const std::function<void(const BaseExcitation&)>& sink, const Progress& progress) const
{
  BaseExcitation block;
  implementation_->read({implementation_->topics.base_excitation}, progress,
                        [&](const RecordedMessage& recorded) { sink(decode(recorded, block)); });
}

template <typename Message>
void readTopic(const std::vector<std::string>& paths, const std::string& topic,
               const std::function<void(const Message&)>& sink)
{
  RecordedRun::Implementation recording;
  recording.open(paths);
  recording.readAll<Message>(recording.require<Message>(topic), sink);
}

template void readTopic(const std::vector<std::string>&, const std::string&,
                        const std::function<void(const BaseExcitation&)>&);
template void readTopic(const std::vector<std::string>&, const std::string&,
                        const std::function<void(const geometry_msgs::AccelStamped&)>&);
template void readTopic(const std::vector<std::string>&, const std::string&,
                        const std::function<void(const sensor_msgs::Imu&)>&);

}  // namespace vibro_impact::graph
