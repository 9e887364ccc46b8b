#include "vibro_impact/ros/view_scene.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
namespace
{
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double pi = 3.14159265358979323846;

/// Points along a beam.
constexpr int points = 41;

/// A section of which only stiffness and mass are known is drawn as a square of this share of the beam's length.
constexpr double unknown_section = 0.024;

/// A rigid body is drawn so much larger than the beam.
constexpr double body_size = 2.0;

/// Drawn sizes, m.
constexpr double block_size = 0.1;
constexpr double plate_size = 0.5;
constexpr double plate_thickness = 0.02;
constexpr double contact_size = 0.035;
constexpr double gauge = 0.22;  ///< along x and y, towards the viewer of rviz/view.rviz
constexpr double support_size = 0.04;
constexpr double largest_impact = 0.1;
constexpr double trail = 0.75;  ///< of the impacts, from the contact to where they have faded
constexpr double text_height = 0.042;
constexpr double text_above = 0.52;

std_msgs::ColorRGBA colour(int red, int green, int blue, double alpha = 1.0)
{
  std_msgs::ColorRGBA result;
  result.r = static_cast<float>(red) / 255.0F;
  result.g = static_cast<float>(green) / 255.0F;
  result.b = static_cast<float>(blue) / 255.0F;
  result.a = static_cast<float>(alpha);
  return result;
}

// M. Okabe and K. Ito, Color Universal Design (2008): told apart by whoever sees colours otherwise, too.
const std::array<std_msgs::ColorRGBA, 2> structure_colours = {colour(0, 114, 178), colour(230, 159, 0)};
const std_msgs::ColorRGBA force_colour = colour(0, 158, 115);
const std_msgs::ColorRGBA impact_colour = colour(204, 121, 167);
const std_msgs::ColorRGBA black = colour(0, 0, 0);
const std_msgs::ColorRGBA grey = colour(120, 120, 120);

geometry_msgs::Point at(double x, double y, double z)
{
  geometry_msgs::Point point;
  point.x = x;
  point.y = y;
  point.z = z;
  return point;
}

Marker marker(const std::string& name, int id, int type, const std_msgs::ColorRGBA& colour)
{
  Marker marker;
  marker.header.frame_id = base_frame;  // stamp 0: whenever
  marker.ns = name;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = colour;
  return marker;
}

Marker solid(const std::string& name, int id, int type, const std_msgs::ColorRGBA& colour,
             const geometry_msgs::Point& position, double size)
{
  Marker result = marker(name, id, type, colour);
  result.pose.position = position;
  result.scale.x = result.scale.y = result.scale.z = size;
  return result;
}

Marker words(const std::string& name, const std_msgs::ColorRGBA& colour, const geometry_msgs::Point& position,
             const std::string& text)
{
  Marker result = solid(name, 0, Marker::TEXT_VIEW_FACING, colour, position, text_height);
  result.text = text;
  return result;
}

Marker deleted(const std::string& name, int id)
{
  Marker result = marker(name, id, Marker::SPHERE, black);
  result.action = Marker::DELETE;
  return result;
}

std_msgs::ColorRGBA shaded(std_msgs::ColorRGBA colour, double share)
{
  colour.r *= static_cast<float>(share);
  colour.g *= static_cast<float>(share);
  colour.b *= static_cast<float>(share);
  return colour;
}

std::string name(int structure)
{
  return "structure " + std::to_string(structure);
}

/// Half of height and width in the coordinates of Side::section, corners of a rectangle or of a round one.
std::vector<std::array<double, 2>> corners(const core::BeamParameters& beam, double scale)
{
  if (const auto* tube = std::get_if<core::Tube>(&beam.cross_section))
  {
    constexpr int count = 16;
    std::vector<std::array<double, 2>> round;
    for (int i = 0; i < count; ++i)
    {
      const double angle = 2.0 * pi * i / count;
      round.push_back(
          {0.5 * scale * tube->outer_diameter * std::cos(angle), 0.5 * scale * tube->outer_diameter * std::sin(angle)});
    }
    return round;
  }
  const auto* rectangle = std::get_if<core::Rectangle>(&beam.cross_section);
  const double width = 0.5 * scale * (rectangle != nullptr ? rectangle->width : unknown_section * beam.length);
  const double height = 0.5 * scale * (rectangle != nullptr ? rectangle->height : unknown_section * beam.length);
  return {{width, height}, {-width, height}, {-width, -height}, {width, -height}};
}

double lengthScale(const core::SystemParameters& parameters)
{
  double longest = 0.0;
  for (const core::StructureParameters* structure : {&parameters.beam1, &parameters.beam2})
  {
    if (const auto* beam = std::get_if<core::BeamParameters>(structure))
    {
      longest = std::max(longest, beam->length);
    }
  }
  return longest > 0.0 ? 1.0 / longest : 1.0;
}

/// Structure 1 lies along x, structure 2 along y.
geometry_msgs::Point place(int structure, double along, double sideways, double z)
{
  return structure == 1 ? at(along, sideways, z) : at(-sideways, along, z);
}
}  // namespace

ViewScene::ViewScene(const core::SystemParameters& parameters)
    : parameters_(parameters),
      model_(parameters),
      shapes_(parameters, model_, points),
      length_scale_(graph::lengthScale(parameters)),
      sides_{makeSide(parameters.beam1, 1), makeSide(parameters.beam2, 2)}
{
}

ViewScene::Side ViewScene::makeSide(const core::StructureParameters& parameters, int structure) const
{
  Side side;
  const auto* beam = std::get_if<core::BeamParameters>(&parameters);
  if (beam == nullptr)
  {
    side.half_height = 0.5 * (std::holds_alternative<core::RigidSurface>(parameters) ? plate_thickness : block_size);
    return side;
  }
  side.section = corners(*beam, length_scale_);
  for (const Point& corner : side.section)
  {
    side.half_height = std::max(side.half_height, corner[1]);
  }
  side.ends = beam->ends;
  const double arm = beam->rigid_body ? 0.5 * beam->rigid_body->length : -1.0;
  for (const double x : shapes_.positions(structure))
  {
    const double along = length_scale_ * (x - beam->contact_location);
    const double from_middle = std::abs(x - 0.5 * beam->length);
    const bool edge = arm > 0.0 && std::abs(from_middle - arm) < 1.0e-9 * beam->length;
    const double size = from_middle < arm ? body_size : 1.0;
    // at an edge of the body the section is both, the one before it first
    const bool ends_body = edge && x > 0.5 * beam->length;
    side.along.push_back(along);
    side.size.push_back(edge ? (ends_body ? body_size : 1.0) : size);
    if (edge)
    {
      side.along.push_back(along);
      side.size.push_back(ends_body ? 1.0 : body_size);
    }
  }
  side.half_height *= arm > 0.0 ? body_size : 1.0;
  return side;
}

double ViewScene::extent(const double* coordinates, double gap)
{
  shapes_.displacements(coordinates, gap, displacements_);
  double extent = std::abs(gap);
  for (std::size_t side = 0; side < 2; ++side)
  {
    extent = std::max(extent, std::abs(displacements_.contact_point[side]));
    if (displacements_.along[side].size() > 0)
    {
      extent = std::max(extent, displacements_.along[side].cwiseAbs().maxCoeff());
    }
  }
  return extent;
}

void ViewScene::addStructure(int structure, double height, double scale, MarkerArray& scene) const
{
  const auto index = static_cast<std::size_t>(structure - 1);
  const Side& side = sides_[index];
  const std_msgs::ColorRGBA& colour = structure_colours[index];
  if (side.section.empty())
  {
    const bool rigid =
        std::holds_alternative<core::RigidSurface>(structure == 1 ? parameters_.beam1 : parameters_.beam2);
    Marker block = solid(name(structure), 0, Marker::CUBE, colour,
                         at(0.0, 0.0, height + scale * displacements_.contact_point[index]), block_size);
    if (rigid)
    {
      block.scale.x = block.scale.y = plate_size;
      block.scale.z = plate_thickness;
    }
    scene.markers.push_back(block);
    return;
  }
  Marker mesh = marker(name(structure), 0, Marker::TRIANGLE_LIST, colour);
  Marker rest = marker(name(structure) + " at rest", 0, Marker::LINE_STRIP, grey);
  rest.scale.x = 0.004;
  const std::size_t count = side.section.size();
  // Both sections at an edge of a body belong to one position.
  std::vector<double> centre;
  const std::vector<double>& positions = shapes_.positions(structure);
  for (std::size_t i = 0, position = 0; i < side.along.size(); ++i)
  {
    position += i > 0 && side.along[i] > side.along[i - 1] ? 1 : 0;
    centre.push_back(height + scale * displacements_.along[index](
                                          static_cast<Eigen::Index>(std::min(position, positions.size() - 1))));
  }
  const auto corner = [&](std::size_t i, std::size_t n)
  {
    const Point& offset = side.section[n % count];
    return place(structure, side.along[i], side.size[i] * offset[0], centre[i] + side.size[i] * offset[1]);
  };
  // Shaded here, as by a light from above: RViz's own leaves what lies flat in the dark.
  const auto shade = [&](std::size_t n)
  {
    const Point& from = side.section[n];
    const Point& to = side.section[(n + 1) % count];
    const double up = (from[0] - to[0]) / std::hypot(from[0] - to[0], from[1] - to[1]);  // of the normal outwards
    return shaded(colour, 0.8 + 0.2 * up);
  };
  for (std::size_t i = 0; i + 1 < side.along.size(); ++i)
  {
    for (std::size_t n = 0; n < count; ++n)
    {
      // outside is where a triangle is seen to run counterclockwise
      for (const auto& [row, column] :
           {std::array<std::size_t, 2>{i, n}, {i + 1, n + 1}, {i + 1, n}, {i, n}, {i, n + 1}, {i + 1, n + 1}})
      {
        mesh.points.push_back(corner(row, column));
        mesh.colors.push_back(shade(n));
      }
    }
  }
  for (std::size_t n = 1; n + 1 < count; ++n)
  {
    for (const std::size_t column : {std::size_t{0}, n + 1, n})
    {
      mesh.points.push_back(corner(0, column));
    }
    for (const std::size_t column : {std::size_t{0}, n, n + 1})
    {
      mesh.points.push_back(corner(side.along.size() - 1, column));
    }
  }
  mesh.colors.resize(mesh.points.size(), shaded(colour, 0.8));
  rest.points = {place(structure, side.along.front(), 0.0, height), place(structure, side.along.back(), 0.0, height)};
  scene.markers.push_back(mesh);
  scene.markers.push_back(rest);
  addSupports(structure, height, scene);
}

void ViewScene::addSupports(int structure, double height, MarkerArray& scene) const
{
  const Side& side = sides_[static_cast<std::size_t>(structure - 1)];
  for (std::size_t end = 0; end < 2; ++end)
  {
    if (side.ends[end] == core::End::free)
    {
      continue;
    }
    const bool clamped = side.ends[end] == core::End::clamped;
    const double along = end == 0 ? side.along.front() : side.along.back();
    scene.markers.push_back(solid(name(structure) + " supports", static_cast<int>(end),
                                  clamped ? Marker::CUBE : Marker::SPHERE, grey, place(structure, along, 0.0, height),
                                  std::max(support_size, 2.4 * side.half_height)));
  }
}

MarkerArray ViewScene::draw(const Moment& moment)
{
  shapes_.displacements(moment.coordinates, moment.gap, displacements_);
  const double scale = moment.displacement_scale;
  const double clearance = moment.gap - (displacements_.contact_point[0] - displacements_.contact_point[1]);
  const std::array<double, 2> height = {sides_[0].half_height + scale * clearance, -sides_[1].half_height};
  const std::array<double, 2> surface = {scale * (clearance + displacements_.contact_point[0]),
                                         scale * displacements_.contact_point[1]};
  MarkerArray scene;
  for (const int structure : {1, 2})
  {
    const auto index = static_cast<std::size_t>(structure - 1);
    addStructure(structure, height[index], scale, scene);
    // The point itself, and a gauge where no beam hides it: what is between its two marks is the gap.
    scene.markers.push_back(
        solid("contact point", structure, Marker::SPHERE, black, at(0.0, 0.0, surface[index]), contact_size));
    scene.markers.push_back(solid("gap", structure, Marker::SPHERE, structure_colours[index],
                                  at(-gauge, -gauge, surface[index]), contact_size));
    Marker lead = marker("gap", 2 + structure, Marker::LINE_STRIP, black);
    lead.scale.x = 0.004;
    lead.points = {at(0.0, 0.0, surface[index]), at(-gauge, -gauge, surface[index])};
    scene.markers.push_back(lead);
    const Side& side = sides_[index];
    const double end = side.along.empty() ? 0.5 * plate_size : side.along.back();
    scene.markers.push_back(
        words("name of " + name(structure), black, place(structure, end + 0.17, 0.0, height[index]), name(structure)));
  }

  Marker between = marker("gap", 5, Marker::LINE_STRIP, black);
  between.scale.x = 0.008;
  between.points = {at(-gauge, -gauge, surface[0]), at(-gauge, -gauge, surface[1])};
  scene.markers.push_back(between);
  scene.markers.push_back(words("name of gap", black, at(-gauge - 0.06, -gauge - 0.06, surface[1] - 0.06), "gap"));

  Marker arrow = marker("force", 0, Marker::ARROW, force_colour);
  if (moment.force > 0.0)
  {
    arrow.points = {at(0.0, 0.0, surface[0]), at(0.0, 0.0, surface[0] + moment.force_scale * moment.force)};
    arrow.scale.x = 0.03;
    arrow.scale.y = 0.06;
    arrow.scale.z = std::min(0.08, 0.5 * moment.force_scale * moment.force);
    scene.markers.push_back(arrow);
  }
  else
  {
    scene.markers.push_back(deleted("force", 0));
  }

  for (std::size_t i = 0; i < most_impacts; ++i)
  {
    if (i >= moment.impacts.size())
    {
      scene.markers.push_back(deleted("impacts", static_cast<int>(i)));
      continue;
    }
    const Impact& impact = moment.impacts[i];
    const double share = moment.largest_impulse > 0.0 ? std::max(0.0, impact.impulse / moment.largest_impulse) : 0.0;
    const double away = trail * impact.age / std::sqrt(2.0);
    // The area of a mark is proportional to the impulse.
    Marker mark = solid("impacts", static_cast<int>(i), Marker::SPHERE, impact_colour, at(away, away, 0.0),
                        std::max(0.1 * largest_impact, largest_impact * std::sqrt(std::min(1.0, share))));
    mark.color.a = static_cast<float>(std::clamp(1.0 - impact.age, 0.05, 1.0));
    scene.markers.push_back(mark);
  }
  scene.markers.push_back(words("words", black, at(0.0, 0.0, text_above), moment.text));
  return scene;
}

MarkerArray ViewScene::drawText(const std::string& text)
{
  MarkerArray scene;
  Marker all = deleted("", 0);
  all.action = Marker::DELETEALL;
  scene.markers.push_back(all);
  scene.markers.push_back(words("words", black, at(0.0, 0.0, text_above), text));
  return scene;
}

}  // namespace vibro_impact::graph
