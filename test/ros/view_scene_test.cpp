#include "vibro_impact/ros/view_scene.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "vibro_impact/core/beam.h"

namespace core = vibro_impact::core;
using vibro_impact::graph::ViewScene;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

namespace
{
constexpr double length = 0.0529;

core::SystemParameters twoBeams()
{
  core::SystemParameters parameters;
  const core::BeamParameters beam{1.66e9, 954.0, length, core::Rectangle{0.00127, 0.0127}, 0.4 * length};
  parameters.beam1 = beam;
  parameters.beam2 = beam;
  std::get<core::BeamParameters>(parameters.beam2).youngs_modulus *= 3.0;
  std::get<core::BeamParameters>(parameters.beam2).cross_section = core::Tube{0.002, 0.0005, 0.0};
  std::get<core::BeamParameters>(parameters.beam2).ends = {core::End::clamped, core::End::free};
  parameters.contact = {24309.4, 5.0e-6};
  parameters.damping = {0.01, 0.05};
  parameters.basis = core::AttachmentBasis{2};
  return parameters;
}

const Marker& find(const MarkerArray& scene, const std::string& name, int id = 0)
{
  const auto found = std::find_if(scene.markers.begin(), scene.markers.end(),
                                  [&](const Marker& marker) { return marker.ns == name && marker.id == id; });
  EXPECT_NE(found, scene.markers.end()) << name;
  static const Marker none;
  return found == scene.markers.end() ? none : *found;
}

/// Structures bent at will, with the gap that belongs to it.
struct Bent
{
  explicit Bent(const core::SystemParameters& parameters) : scene(parameters)
  {
    const std::vector<core::StructureMode>& modes = scene.model().structureModes();
    moment.gap = scene.model().clearance();
    for (std::size_t i = 0; i < modes.size(); ++i)
    {
      coordinates.push_back(1.0e-7 * std::cos(static_cast<double>(i)));
      const double share = modes[i].contact_deflection * coordinates[i];
      contact[static_cast<std::size_t>(modes[i].structure - 1)] += share;
    }
    moment.gap += contact[0] - contact[1];
    moment.coordinates = coordinates.data();
    moment.displacement_scale = 2000.0;
    moment.force_scale = 2.0;
    moment.text = "words";
  }

  ViewScene scene;
  std::vector<double> coordinates;
  ViewScene::Moment moment;
  double contact[2] = {0.0, 0.0};
};

TEST(ViewScene, marksAreApartByTheGapAndSurfacesMeetThem)
{
  Bent bent(twoBeams());
  const MarkerArray scene = bent.scene.draw(bent.moment);
  const double upper = find(scene, "contact point", 1).pose.position.z;
  const double lower = find(scene, "contact point", 2).pose.position.z;
  EXPECT_NEAR(upper - lower, 2000.0 * bent.moment.gap, 1e-12);
  EXPECT_NEAR(lower, 2000.0 * bent.contact[1], 1e-12);
  EXPECT_NEAR(find(scene, "gap", 1).pose.position.z, upper, 1e-12);
  EXPECT_NEAR(find(scene, "gap", 2).pose.position.z, lower, 1e-12);

  // The undersides of beam 1 and the top of beam 2 at x = y = 0.
  double underside = 1e9;
  for (const geometry_msgs::Point& point : find(scene, "structure 1").points)
  {
    underside = std::abs(point.x) < 1e-9 ? std::min(underside, point.z) : underside;
  }
  EXPECT_NEAR(underside, upper, 1e-9);
  double top = -1e9;
  for (const geometry_msgs::Point& point : find(scene, "structure 2").points)
  {
    top = std::abs(point.y) < 1e-9 ? std::max(top, point.z) : top;
  }
  EXPECT_NEAR(top, lower, 1e-9);
}

TEST(ViewScene, beamsHaveTheirTrueShape)
{
  Bent bent(twoBeams());
  std::fill(bent.coordinates.begin(), bent.coordinates.end(), 0.0);
  bent.coordinates[1] = 1.0e-7;  // the second mode of structure 1
  bent.moment.gap = 5.0e-6 + bent.scene.model().structureModes()[1].contact_deflection * 1.0e-7;
  EXPECT_EQ(bent.scene.lengthScale(), 1.0 / length);
  const MarkerArray scene = bent.scene.draw(bent.moment);
  const Marker& mesh = find(scene, "structure 1");
  ASSERT_EQ(mesh.type, Marker::TRIANGLE_LIST);
  ASSERT_EQ(mesh.points.size() % 3, 0u);
  ASSERT_EQ(mesh.colors.size(), mesh.points.size());
  const core::Beam beam(std::get<core::BeamParameters>(twoBeams().beam1));
  const double half = 0.5 * 0.00127 / length;
  for (const geometry_msgs::Point& point : mesh.points)
  {
    const double x = std::clamp((point.x + 0.4) * length, 0.0, length);
    const double middle = half + 2000.0 * (5.0e-6 + 1.0e-7 * beam.modeShape(2, {x})[0]);
    EXPECT_NEAR(std::abs(point.z - middle), half, 1e-9);
    EXPECT_NEAR(std::abs(point.y), 0.5 * 0.0127 / length, 1e-12);
  }
  // A round tube along y.
  for (const geometry_msgs::Point& point : find(scene, "structure 2").points)
  {
    EXPECT_NEAR(std::hypot(point.x, point.z + 0.001 / length), 0.001 / length, 1e-12);
    EXPECT_GE(point.y, -0.4 - 1e-12);
    EXPECT_LE(point.y, 0.6 + 1e-12);
  }
  EXPECT_EQ(find(scene, "structure 1 supports", 0).type, Marker::SPHERE);
  EXPECT_EQ(find(scene, "structure 1 supports", 1).type, Marker::SPHERE);
  EXPECT_EQ(find(scene, "structure 2 supports", 0).type, Marker::CUBE);
  EXPECT_EQ(std::count_if(scene.markers.begin(), scene.markers.end(),
                          [](const Marker& marker) { return marker.ns == "structure 2 supports"; }),
            1)
      << "the other end is free";
}

TEST(ViewScene, aBodyIsRigidAndLarger)
{
  core::SystemParameters parameters = twoBeams();
  auto& beam = std::get<core::BeamParameters>(parameters.beam1);
  beam.contact_location = 0.5 * length;
  beam.rigid_body = core::RigidBody{0.2 * length, 1e-3, 1e-8};
  Bent bent(parameters);
  const MarkerArray scene = bent.scene.draw(bent.moment);
  // All that is twice as wide lies within the body, its corners on straight lines.
  double low = 1.0;
  double high = -1.0;
  for (const geometry_msgs::Point& point : find(scene, "structure 1").points)
  {
    if (std::abs(point.y) > 0.0127 / length - 1e-9)
    {
      low = std::min(low, point.x);
      high = std::max(high, point.x);
    }
    else
    {
      EXPECT_NEAR(std::abs(point.y), 0.5 * 0.0127 / length, 1e-9);
      EXPECT_GE(std::abs(point.x), 0.1 - 1e-9);
    }
  }
  EXPECT_NEAR(low, -0.1, 1e-9);
  EXPECT_NEAR(high, 0.1, 1e-9);
}

TEST(ViewScene, platesAndBlocks)
{
  core::SystemParameters parameters = twoBeams();
  parameters.beam2 = core::RigidSurface{};
  Bent plate(parameters);
  EXPECT_EQ(find(plate.scene.draw(plate.moment), "structure 2").type, Marker::CUBE);
  EXPECT_NEAR(find(plate.scene.draw(plate.moment), "contact point", 2).pose.position.z, 0.0, 1e-15);

  core::ModalTableParameters table;
  table.frequency_hz = {300.0, 900.0};
  table.contact_deflection = {20.0, -15.0};
  table.participation = {0.03, 0.01};
  parameters.beam2 = table;
  Bent block(parameters);
  const MarkerArray scene = block.scene.draw(block.moment);
  const Marker& marker = find(scene, "structure 2");
  EXPECT_EQ(marker.type, Marker::CUBE);
  EXPECT_NEAR(marker.pose.position.z + 0.5 * marker.scale.z, find(scene, "contact point", 2).pose.position.z, 1e-12);
  EXPECT_NE(block.contact[1], 0.0);

  parameters.beam1 = table;
  parameters.beam2 = core::RigidSurface{};
  Bent no_beam(parameters);
  EXPECT_EQ(no_beam.scene.lengthScale(), 1.0);
  EXPECT_NEAR(find(no_beam.scene.draw(no_beam.moment), "contact point", 1).pose.position.z, 2000.0 * no_beam.moment.gap,
              1e-12);
}

TEST(ViewScene, theArrowIsTheForce)
{
  Bent bent(twoBeams());
  EXPECT_EQ(find(bent.scene.draw(bent.moment), "force").action, Marker::DELETE);
  bent.moment.force = 0.15;
  const MarkerArray scene = bent.scene.draw(bent.moment);
  const Marker& arrow = find(scene, "force");
  ASSERT_EQ(arrow.type, Marker::ARROW);
  ASSERT_EQ(arrow.points.size(), 2u);
  EXPECT_NEAR(arrow.points[1].z - arrow.points[0].z, 0.3, 1e-12);
  EXPECT_EQ(arrow.points[0].z, find(scene, "contact point", 1).pose.position.z);
}

TEST(ViewScene, impactsFadeAndAreSizedByImpulse)
{
  Bent bent(twoBeams());
  bent.moment.impacts = {{0.0, 4.0e-5}, {0.5, 1.0e-5}};
  bent.moment.largest_impulse = 4.0e-5;
  const MarkerArray scene = bent.scene.draw(bent.moment);
  const Marker& now = find(scene, "impacts", 0);
  const Marker& before = find(scene, "impacts", 1);
  EXPECT_NEAR(before.scale.x / now.scale.x, 0.5, 1e-6);
  EXPECT_NEAR(now.color.a, 1.0, 1e-6);
  EXPECT_NEAR(before.color.a, 0.5, 1e-6);
  EXPECT_GT(before.pose.position.x, now.pose.position.x);
  EXPECT_EQ(find(scene, "impacts", 2).action, Marker::DELETE);

  bent.moment.impacts.assign(1000, {0.1, 1.0e-5});
  const MarkerArray many = bent.scene.draw(bent.moment);
  EXPECT_EQ(std::count_if(many.markers.begin(), many.markers.end(),
                          [](const Marker& marker) { return marker.ns == "impacts" && marker.action == Marker::ADD; }),
            static_cast<std::ptrdiff_t>(ViewScene::most_impacts));
}

TEST(ViewScene, everyMarkerIsInBaseFrameAndItsNameItsOwn)
{
  Bent bent(twoBeams());
  std::set<std::pair<std::string, int>> names;
  for (const Marker& marker : bent.scene.draw(bent.moment).markers)
  {
    EXPECT_EQ(marker.header.frame_id, "base_frame");
    EXPECT_TRUE(marker.header.stamp.isZero());
    EXPECT_TRUE(names.insert({marker.ns, marker.id}).second) << marker.ns << " " << marker.id;
    EXPECT_GT(marker.scale.x * marker.scale.y * marker.scale.z, 0.0) << marker.ns;
  }
  const MarkerArray words = ViewScene::drawText("waiting");
  ASSERT_EQ(words.markers.size(), 2u);
  EXPECT_EQ(words.markers[0].action, Marker::DELETEALL);
  EXPECT_EQ(words.markers[1].text, "waiting");
}

TEST(ViewScene, theExtentIsTheLargestDisplacementOrTheGap)
{
  Bent bent(twoBeams());
  EXPECT_EQ(bent.scene.extent(bent.coordinates.data(), 1.0), 1.0);
  const double extent = bent.scene.extent(bent.coordinates.data(), 0.0);
  EXPECT_GE(extent, std::max(std::abs(bent.contact[0]), std::abs(bent.contact[1])));
}
}  // namespace
