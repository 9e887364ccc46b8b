#include "vibro_impact/ros/view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <iomanip>
#include <sstream>
#include <vector>

#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/parameter_reader.h"

namespace vibro_impact::graph
{
namespace
{
/// Drawn sizes that automatic scales aim at, m.
constexpr double drawn_displacement = 0.12;
constexpr double drawn_force = 0.3;

/// Silence after which the motion is stale, s.
constexpr double stale = 2.0;

/// Impacts that are remembered for the next stretch.
constexpr std::size_t most_impacts = 1000;

/// For a subscriber that only looks at the newest.
constexpr std::uint32_t queue_size = 20;

std::string number(double value)
{
  std::ostringstream text;
  text << std::setprecision(3) << value;
  return text.str();
}

/// With three digits and a prefix of the unit.
std::string prefixed(double value, const std::string& unit)
{
  const std::pair<double, const char*> prefixes[] = {{1.0, ""}, {1.0e-3, "m"}, {1.0e-6, "u"}, {1.0e-9, "n"}};
  for (const auto& [size, prefix] : prefixes)
  {
    if (std::abs(value) >= 0.9995 * size)
    {
      return number(value / size) + " " + prefix + unit;
    }
  }
  return number(value) + " " + unit;
}

/// In full, as scales are read.
std::string factor(double value)
{
  std::ostringstream text;
  text << std::setprecision(value >= 100.0  ? 0
                            : value >= 10.0 ? 1
                                            : 3)
       << (value >= 10.0 ? std::fixed : std::defaultfloat) << value;
  return text.str();
}

bool fits(const StructureMotion& motion, const core::SwitchedModel& model)
{
  const std::vector<core::StructureMode>& modes = model.structureModes();
  const auto same = [&](std::size_t i)
  {
    return motion.structure[i] == modes[i].structure && motion.mode[i] == static_cast<std::uint32_t>(modes[i].number) &&
           motion.contact_deflection[i] == modes[i].contact_deflection;
  };
  bool all = motion.mode.size() == modes.size() && motion.structure.size() == modes.size() &&
             motion.contact_deflection.size() == modes.size();
  for (std::size_t i = 0; all && i < modes.size(); ++i)
  {
    all = same(i);
  }
  return all;
}
}  // namespace

ViewParameters parseViewParameters(const XmlRpc::XmlRpcValue& tree, const std::string& name)
{
  ViewParameters parameters;
  ParameterReader reader(tree, "");
  parameters.frame_rate = reader.positive("frame_rate", parameters.frame_rate, 200.0, " (Hz)");
  parameters.slow_motion = reader.nonNegative("slow_motion", parameters.slow_motion, 1.0e9, "");
  parameters.stretch = reader.positive("stretch", parameters.stretch, 3600.0, " (s)");
  parameters.fade = reader.positive("fade", parameters.fade, 3600.0, " (s)");
  parameters.displacement_scale = reader.nonNegative("displacement_scale", parameters.displacement_scale, 1.0e12, "");
  parameters.force_scale = reader.nonNegative("force_scale", parameters.force_scale, 1.0e12, " (m/N)");
  reader.rejectUnknown();
  if (!reader.faults().empty())
  {
    throw config::Error(name, reader.faults());
  }
  return parameters;
}

View::View(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : node_(node),
      parameters_(
          [&private_node]
          {
            XmlRpc::XmlRpcValue tree;
            private_node.getParam(private_node.getNamespace(), tree);
            return parseViewParameters(tree, private_node.getNamespace());
          }()),
      player_(parameters_.slow_motion, parameters_.stretch),
      displacement_scale_(parameters_.displacement_scale),
      force_scale_(parameters_.force_scale),
      impulse_scale_(0.0)
{
  publisher_ = node_.advertise<visualization_msgs::MarkerArray>("view", 2);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  model_info_subscriber_ = node_.subscribe<ModelInfo>(
      "model_info", queue_size, [this](const ModelInfo::ConstPtr& info) { onModelInfo(*info); }, ros::VoidConstPtr(),
      hints);
  impact_subscriber_ = node_.subscribe<Impact>(
      "impact", most_impacts, [this](const Impact::ConstPtr& impact) { onImpact(*impact); }, ros::VoidConstPtr(),
      hints);
  timer_ = node_.createWallTimer(ros::WallDuration(1.0 / parameters_.frame_rate), &View::onFrame, this);
}

void View::onModelInfo(const ModelInfo& info)
{
  try
  {
    scene_ = std::make_unique<ViewScene>(fromMessage(info));
    model_fault_.clear();
    const auto elastic =
        std::find_if(info.free_frequencies.begin(), info.free_frequencies.end(), [](double f) { return f > 0.0; });
    player_.setNaturalFrequency(elastic == info.free_frequencies.end() ? 0.0 : *elastic);
  }
  catch (const std::exception& error)
  {
    scene_.reset();
    model_fault_ = error.what();
    ROS_ERROR("model_info is refused: %s", error.what());
  }
}

void View::onMotion(const StructureMotion& motion)
{
  if (scene_ == nullptr)
  {
    return;
  }
  if (!fits(motion, scene_->model()) || !player_.add(motion))
  {
    ROS_WARN_COND(refusals_.due(), "motion of sample %llu is refused: it is not that of the model in model_info",
                  static_cast<unsigned long long>(motion.seq));
    return;
  }
  last_motion_ = ros::SteadyTime::now();
}

void View::onImpact(const Impact& impact)
{
  if (!impacts_.empty() && impact.seq < impacts_.back().seq)
  {
    impacts_.clear();  // the stream has begun anew
  }
  impacts_.push_back(impact);
  if (impacts_.size() > most_impacts)
  {
    impacts_.pop_front();
  }
  addToStretch(impact);
}

/// Stream time over which a mark fades, s.
double View::fade() const
{
  return parameters_.fade / player_.slowMotion();
}

/// An impact may come later than the motion of its time.
void View::addToStretch(const Impact& impact)
{
  if (player_.playing())
  {
    const double onset = player_.time(impact.seq, impact.offset);
    if (onset >= -fade() && onset <= player_.duration())
    {
      stretch_impacts_.push_back(impact);
    }
  }
}

void View::onFrame(const ros::WallTimerEvent& event)
{
  if (publisher_.getNumSubscribers() == 0)
  {
    motion_subscriber_.shutdown();
    return;
  }
  if (!motion_subscriber_)
  {
    motion_subscriber_ = node_.subscribe<StructureMotion>(
        "motion", queue_size, [this](const StructureMotion::ConstPtr& motion) { onMotion(*motion); },
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  }
  // A frame that is late shows no more than two frames' time at once.
  const double frame = 1.0 / parameters_.frame_rate;
  const double passed = event.last_real.isZero() ? frame : (event.current_real - event.last_real).toSec();
  if (player_.advance(std::clamp(passed, 0.0, 2.0 * frame)))
  {
    measureStretch();
    stretch_impacts_.clear();
    for (const Impact& impact : impacts_)
    {
      addToStretch(impact);
    }
  }
  publisher_.publish(scene());
}

/// Scales by all that the new stretch shows.
void View::measureStretch()
{
  double extent = 0.0;
  double force = 0.0;
  for (const MotionPlayer::Row& row : player_.stretch())
  {
    if (scene_ == nullptr || row.coordinates.size() != scene_->model().structureModes().size())
    {
      return;
    }
    extent = std::max(extent, scene_->extent(row.coordinates.data(), row.gap));
    force = std::max(force, row.force);
  }
  if (scene_ != nullptr)
  {
    displacement_scale_.update(drawn_displacement / extent);
    force_scale_.update(drawn_force / force);
  }
}

std::string View::complaint() const
{
  if (scene_ == nullptr)
  {
    return model_fault_.empty() ? "waiting for topic " + model_info_subscriber_.getTopic()
                                : "model_info cannot be read: " + model_fault_;
  }
  if (!player_.playing())
  {
    return "waiting for topic " + node_.resolveName("motion");
  }
  const double silence = (ros::SteadyTime::now() - last_motion_).toSec();
  return silence > stale ? "stale: no motion for " + number(std::floor(silence)) + " s" : "";
}

visualization_msgs::MarkerArray View::scene()
{
  const std::string complaint = this->complaint();
  const MotionPlayer::Row row = player_.playing() ? player_.row() : MotionPlayer::Row();
  if (scene_ == nullptr || !player_.playing() || row.coordinates.size() != scene_->model().structureModes().size())
  {
    return ViewScene::drawText(complaint);
  }
  ViewScene::Moment moment;
  moment.coordinates = row.coordinates.data();
  moment.gap = row.gap;
  moment.force = row.force;
  moment.displacement_scale = displacement_scale_.value() > 0.0 ? displacement_scale_.value() : 1.0;
  moment.force_scale = force_scale_.value() > 0.0 ? force_scale_.value() : 1.0;
  const Impact* last = nullptr;
  for (auto impact = stretch_impacts_.rbegin(); impact != stretch_impacts_.rend(); ++impact)
  {
    const double age = (player_.position() - player_.time(impact->seq, impact->offset)) / fade();
    if (age >= 0.0 && age <= 1.0)
    {
      last = last == nullptr ? &*impact : last;
      moment.impacts.push_back({age, impact->impulse});
      moment.largest_impulse = std::max(moment.largest_impulse, impact->impulse);
    }
  }
  moment.largest_impulse = std::max(impulse_scale_.update(moment.largest_impulse), moment.largest_impulse);

  std::ostringstream text;
  text << "slowed " << factor(player_.slowMotion()) << " x: " << prefixed(player_.duration(), "s")
       << " of the stream, then the newest";
  if (player_.driveFrequency() > 0.0)
  {
    text << " (drive " << number(player_.driveFrequency()) << " Hz)";
  }
  text << "\nlengths x " << factor(scene_->lengthScale()) << ", displacement x " << factor(moment.displacement_scale)
       << " relative to the base"
       << "\nforce: " << prefixed(moment.force_scale > 0.0 ? 0.1 / moment.force_scale : 0.0, "N")
       << " = 100 mm, a cell of the grid"
       << "\ngap " << prefixed(moment.gap, "m") << ", force " << prefixed(moment.force, "N")
       << (last != nullptr ? ", last impulse " + prefixed(last->impulse, "N s") : std::string());
  if (!complaint.empty())
  {
    text << "\n" << complaint;
  }
  moment.text = text.str();
  return scene_->draw(moment);
}

}  // namespace vibro_impact::graph
