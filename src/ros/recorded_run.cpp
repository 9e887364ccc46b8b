#include "vibro_impact/ros/recorded_run.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <stdexcept>
#include <utility>

#include <geometry_msgs/AccelStamped.h>
#include <ros/message_traits.h>
#include <rosbag/bag.h>
#include <rosbag/query.h>
#include <rosbag/view.h>
#include <sensor_msgs/Imu.h>
#include <sys/stat.h>
#include <vibro_impact/ContactForce.h>
#include <vibro_impact/Gap.h>

#include "bag_structure.h"
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

void openBag(rosbag::Bag& bag, const std::string& path)
{
  try
  {
    bag.open(path, rosbag::bagmode::Read);
  }
  catch (const rosbag::BagUnindexedException&)
  {
    throw config::Error(path + ": has no index, the recording did not end properly; 'rosbag reindex' repairs it");
  }
  catch (const std::runtime_error& error)
  {
    throw config::Error(damaged(path, error.what()));
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

template <typename Block>
BlockHead headOf(const Block& block, std::size_t samples)
{
  return {block.seq, samples, block.header.stamp, block.sample_period};
}

// What is certain of a message by its topic's type, unless the type meant something else when it was recorded.
template <typename Message>
Message messageOf(const rosbag::MessageInstance& instance)
{
  if (instance.getMD5Sum() != ros::message_traits::md5sum<Message>())
  {
    throw config::Error("topic " + instance.getTopic() + ": was recorded with another definition of " +
                        instance.getDataType() + " (" + instance.getMD5Sum() + " instead of " +
                        ros::message_traits::md5sum<Message>() + ")");
  }
  // MessageInstance::instantiate() trusts the lengths in a message.
  std::vector<std::uint8_t> bytes(instance.size());
  ros::serialization::OStream copy(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  instance.write(copy);
  Message message;
  CheckedStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  stream.next(message);
  return message;
}
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
      requireSoundBag(path);
      bags.push_back(std::make_unique<rosbag::Bag>());
      openBag(*bags.back(), path);
    }
    try
    {
      everything = std::make_unique<rosbag::View>();
      for (const auto& bag : bags)
      {
        everything->addQuery(*bag);
      }
    }
    catch (const std::runtime_error& error)
    {
      throw config::Error(damaged(names, error.what()));
    }
  }

  template <typename Message>
  std::string find(const std::string& name_space, bool required)
  {
    const std::string type = ros::message_traits::datatype<Message>();
    std::set<std::string> all;
    std::set<std::string> inside;
    for (const rosbag::ConnectionInfo* connection : everything->getConnections())
    {
      if (connection->datatype == type)
      {
        all.insert(connection->topic);
        if (isInside(connection->topic, name_space))
        {
          inside.insert(connection->topic);
        }
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
    std::set<std::string> all;
    for (const rosbag::ConnectionInfo* connection : everything->getConnections())
    {
      if (connection->datatype == type)
      {
        if (absolute(connection->topic) == absolute(topic))
        {
          return connection->topic;
        }
        all.insert(connection->topic);
      }
    }
    throw config::Error(names + ": holds no topic " + topic + " of type " + type +
                        (all.empty() ? "" : " (but " + list(all) + ")"));
  }

  void read(const std::vector<std::string>& wanted, const Progress& progress,
            const std::function<void(const rosbag::MessageInstance&)>& take) const
  {
    try
    {
      rosbag::View view;
      for (const auto& bag : bags)
      {
        view.addQuery(*bag, rosbag::TopicQuery(wanted));
      }
      const double total = static_cast<double>(view.size());
      double done = 0.0;
      for (const rosbag::MessageInstance& instance : view)
      {
        take(instance);
        done += 1.0;
        if (progress)
        {
          progress(done / total);
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
      read({topic}, {}, [&](const rosbag::MessageInstance& instance) { sink(messageOf<Message>(instance)); });
    }
  }

  std::string names;  // of the bags, for messages
  std::vector<std::unique_ptr<rosbag::Bag>> bags;
  std::unique_ptr<rosbag::View> everything;  // of everything, for its connections
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
  std::vector<std::string> wanted;
  for (const std::string* topic : {&topics.base_excitation, &topics.gap, &topics.contact_force, &topics.model_info,
                                   &topics.impact, &topics.stream_start})
  {
    if (!topic->empty())
    {
      wanted.push_back(*topic);
    }
  }
  implementation_->read(wanted, progress,
                        [&](const rosbag::MessageInstance& instance)
                        {
                          const std::string& topic = instance.getTopic();
                          if (topic == topics.base_excitation)
                          {
                            sink.onExcitation(messageOf<BaseExcitation>(instance));
                          }
                          else if (topic == topics.gap)
                          {
                            const auto block = messageOf<Gap>(instance);
                            sink.onGap(headOf(block, block.gap.size()), block.gap);
                          }
                          else if (topic == topics.contact_force)
                          {
                            const auto block = messageOf<ContactForce>(instance);
                            sink.onContactForce(headOf(block, block.force.size()), block.force);
                          }
                          else if (topic == topics.impact)
                          {
                            sink.onImpact(messageOf<Impact>(instance));
                          }
                          else if (topic == topics.stream_start)
                          {
                            sink.onStreamStart(messageOf<StreamStart>(instance));
                          }
                          else
                          {
                            sink.onModelInfo(messageOf<ModelInfo>(instance));
                          }
                        });
}

void RecordedRun::readModelInfo(const std::function<void(const ModelInfo&)>& sink) const
{
  implementation_->readAll<ModelInfo>(implementation_->topics.model_info, sink);
}

void RecordedRun::readExcitation(const std::function<void(const BaseExcitation&)>& sink, const Progress& progress) const
{
  implementation_->read({implementation_->topics.base_excitation}, progress,
                        [&](const rosbag::MessageInstance& instance) { sink(messageOf<BaseExcitation>(instance)); });
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
