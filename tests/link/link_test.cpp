// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/link/link.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "formats/context_changes.h"
#include "formats/node_coding.h"
#include "host/base/error.h"
#include "host/base/mesh_grid.h"
#include "host/link/image_writer.h"
#include "host/link/mesh_encoder.h"
#include "host/link/rig_subset.h"

namespace vitrine {
namespace {

// A wavy grid: the first half of its triangles single-sided.
DrawnObject wavy_grid(int object, int n) {
  DrawnObject drawn;
  drawn.object = object;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(n), v = static_cast<float>(y) / static_cast<float>(n);
      drawn.vertices.push_back({u, v, 0.1f * std::sin(9 * u) * std::cos(7 * v), u, v});
    }
  drawn.vertices.push_back({9, 9, 9, 0, 0});  // used by no triangle
  drawn.grid = lay_on_grid(drawn.vertices);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const uint32_t a = static_cast<uint32_t>(y * (n + 1) + x), b = a + 1, c = a + static_cast<uint32_t>(n) + 1, d = c + 1;
      drawn.indices.insert(drawn.indices.end(), {a, b, d, a, d, c});
    }
  drawn.culled_index_count = static_cast<uint32_t>(drawn.indices.size() / 6 * 3);
  return drawn;
}

using Corner5 = std::array<float, 5>;
using Triangle = std::array<Corner5, 3>;

// A triangle as its corners' values, begun at the least of them: equal up to the rotation that the codec may make.
Triangle triangle_of(std::span<const MeshVertex> vertices, const uint32_t* indices) {
  Triangle t;
  for (size_t i = 0; i < 3; ++i) {
    const MeshVertex& v = vertices[indices[i]];
    t[i] = {v.x, v.y, v.z, v.u, v.v};
  }
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}
std::vector<Triangle> triangles_of(std::span<const MeshVertex> vertices, std::span<const uint32_t> indices) {
  std::vector<Triangle> triangles;
  for (size_t i = 0; i < indices.size(); i += 3) triangles.push_back(triangle_of(vertices, indices.data() + i));
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

struct Input {
  Scene scene;
  Inference inference;
  std::vector<EncodedField> encoded;
  LinkInput link;
};

EncodedField encoded_field(const ParameterSpace& space, uint32_t seed) {
  EncodedField field;
  field.shape.space = space;
  field.shape.pyramid.level_count = 2;
  for (int a = 0; a < space.axis_count; ++a) {
    field.shape.block_size[a] = space.axes[a].samples > 1 ? 4 : 1;
    field.shape.stagger[a] = space.axes[a].samples > 4 ? 2 : 0;
    field.shape.pyramid.cell[0][a] = field.shape.block_size[a];
    field.shape.pyramid.cell[1][a] = 1;
  }
  field.level_steps = {64, 64, 64, 16, 16, 16};
  field.contexts.assign(2 * kContextBytesPerLevel, 0x81);
  std::mt19937 random(seed);
  for (int node = 0; node < field.shape.node_count(); ++node) {
    const bool coded = field.shape.samples_of(node).last[0] >= 0 && random() % 3 != 0;
    const uint32_t bytes = coded ? 1 + static_cast<uint32_t>(random() % 20) : 0;
    for (uint32_t i = 0; i < bytes; ++i) field.nodes.push_back(static_cast<uint8_t>(random()));
    field.node_bytes.push_back(bytes);
    field.node_units.push_back(coded ? 500 : 0);
  }
  return field;
}

// Six rig nodes of which the picture needs four: root 0 - camera 2 (animated), root 0 - 3 - object 4; 1 and 5 are a lamp's.
std::unique_ptr<Input> make_input() {
  auto input = std::make_unique<Input>();
  Scene& scene = input->scene;
  scene.file = "table/scene.toml";
  const int parents[] = {-1, -1, 0, 0, 3, 1};
  for (int n = 0; n < 6; ++n) {
    RigNode node;
    node.parent = parents[n];
    node.translation = {static_cast<float>(n), 0.5f, 0};
    scene.nodes.push_back(node);
  }
  scene.nodes[3].matrix[3] = glm::vec4(1, 2, 3, 1);
  scene.track_data = {{0, 1}, {0, 0, 0, 1, 2, 3}, {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0}};
  scene.tracks.push_back({1, 1, TrackPath::kTranslation, Interpolation::kLinear, scene.track_data[0], scene.track_data[1]});
  scene.tracks.push_back({2, 0, TrackPath::kTranslation, Interpolation::kStep, scene.track_data[0], scene.track_data[1]});
  scene.tracks.push_back({4, 1, TrackPath::kRotation, Interpolation::kLinear, scene.track_data[2], scene.track_data[3]});
  scene.camera.node = 2;
  scene.axes = {{"view", {AxisKind::kLinear, 6}, 0.25f, {}}, {"lamp", {AxisKind::kPeriodic, 4}, 0.1f, {}}};
  for (const char* name : {"unseen", "vase", "dome"}) {
    Object object;
    object.name = name;
    object.node = 4;
    scene.objects.push_back(std::move(object));
  }
  scene.objects[2].follows_camera = true;
  scene.objects[2].node = 0;
  scene.settings.exposure = 1.5f;
  scene.settings.interpolate = true;
  input->inference.objects = {wavy_grid(1, 12), wavy_grid(2, 3)};
  // Fields of two objects, mixed up.
  const struct {
    int drawn;
    const char* layer;
    AxisMask axes;
  } fields[] = {{1, "diffuse", 0}, {0, "diffuse", 2}, {0, "specular", 3}};
  for (const auto& f : fields) {
    Field field;
    field.drawn_object = f.drawn;
    field.layer = f.layer;
    field.axes = f.axes;
    field.space = scene.space().restricted(f.axes);
    input->encoded.push_back(encoded_field(field.space, static_cast<uint32_t>(input->encoded.size())));
    field.texture_width = 48 - f.drawn;
    field.texture_height = 32 + static_cast<int>(f.axes);
    field.maps = {PatchMap{{0.5f, 0}, glm::mat2(1, 2, 3, 4), {5, static_cast<float>(f.axes)}}};
    input->inference.fields.push_back(std::move(field));
  }
  input->link = {.scene = &scene,
                 .width = 320,
                 .height = 240,
                 .filter = SurfaceFilter::kAnisotropic4,
                 .inference = &input->inference,
                 .encoded = &input->encoded,
                 .plan = {1000, 900, 800, 700, 6, 5}};
  return input;
}

TEST(Link, TheImageHoldsWhatTheStagesMade) {
  const auto input = make_input();
  const AlignedBytes file(link_image(input->link));
  const Result<ImageView> opened = ImageView::open(file.bytes());
  ASSERT_TRUE(opened.ok()) << opened.status().detail();
  const ImageView& view = opened.value();
  const fb::Image& d = view.directory();
  EXPECT_EQ(d.width(), 320u);
  EXPECT_EQ(d.supersampling(), 2u);
  EXPECT_EQ(view.filter(), SurfaceFilter::kAnisotropic4);
  EXPECT_EQ(d.exposure(), 1.5f);
  EXPECT_TRUE(d.interpolate());
  EXPECT_EQ(d.axes()->Get(1)->name()->str(), "lamp");
  EXPECT_EQ(d.plan()->units_budget(), 1000u);
  EXPECT_EQ(d.plan()->units_worst(), 900u);
  EXPECT_EQ(d.plan()->upload_worst(), 800u);
  EXPECT_EQ(d.plan()->cache_bytes(), 700u);
  EXPECT_EQ(d.plan()->settle_frames(), 6u);
  EXPECT_EQ(d.plan()->horizon_frames(), 5u);
  ASSERT_EQ(d.objects()->size(), 2u);
  EXPECT_EQ(d.objects()->Get(0)->name()->str(), "vase");
  EXPECT_TRUE(d.objects()->Get(1)->follows_camera());
  ASSERT_EQ(d.objects()->Get(0)->fields()->size(), 2u);
  const std::pair<const fb::Field*, size_t> fields[] = {{d.objects()->Get(0)->fields()->Get(0), 1},
                                                        {d.objects()->Get(0)->fields()->Get(1), 2},
                                                        {d.objects()->Get(1)->fields()->Get(0), 0}};
  for (const auto& [field, number] : fields) {
    const EncodedField& encoded = input->encoded[number];
    EXPECT_EQ(field->layer()->str(), input->inference.fields[number].layer);
    EXPECT_EQ(field->axes(), input->inference.fields[number].axes);
    EXPECT_EQ(static_cast<int>(field->texture_width()), input->inference.fields[number].texture_width);
    EXPECT_EQ(static_cast<int>(field->texture_height()), input->inference.fields[number].texture_height);
    EXPECT_EQ(field->maps()->size(), static_cast<uint32_t>(kTextureMapValues));
    EXPECT_EQ(view.map_of(*field, 0), input->inference.fields[number].maps[0]);
    EXPECT_EQ(view.shape_of(*field).node_count(), encoded.shape.node_count());
    const auto nodes = view.section(field->nodes());
    ASSERT_EQ(nodes.size(), encoded.nodes.size());
    EXPECT_EQ(std::memcmp(nodes.data(), encoded.nodes.data(), nodes.size()), 0);
    std::vector<uint8_t> contexts(encoded.contexts.size());
    ASSERT_TRUE(expand_contexts(context_changes_of(*field), default_context_bytes(), contexts).ok());
    EXPECT_EQ(contexts, encoded.contexts);
    for (uint32_t n = 0; n < encoded.node_bytes.size(); ++n) EXPECT_EQ(field->node_bytes()->Get(n), encoded.node_bytes[n]);
  }
}

TEST(Link, EveryBlockKeepsItsOwnMap) {
  const auto input = make_input();
  input->scene.settings.interpolate = false;
  Field& field = input->inference.fields[2];
  ASSERT_EQ(input->encoded[2].shape.block_count(), 2);
  field.maps.push_back(PatchMap{{0, 0.25f}, glm::mat2(2), {-1, 0}});
  field.block_maps = {1, 0};
  const AlignedBytes file(link_image(input->link));
  const ImageView view = ImageView::open(file.bytes()).value();
  const fb::Field& linked = *view.directory().objects()->Get(0)->fields()->Get(1);
  EXPECT_EQ(view.map_of(linked, 0), field.maps[1]);
  EXPECT_EQ(view.map_of(linked, 1), field.maps[0]);
}

TEST(Link, EveryPatchKeepsItsOwnMap) {
  const auto input = make_input();
  TextureMap& map = input->inference.fields[2].maps.front();
  map.patch_count = 3;
  for (size_t k = 0; k < kMaxPatches; ++k) map.patches[k].offset.x = static_cast<float>(std::min<size_t>(k, 2));
  const AlignedBytes file(link_image(input->link));
  const ImageView view = ImageView::open(file.bytes()).value();
  const fb::Field& linked = *view.directory().objects()->Get(0)->fields()->Get(1);
  EXPECT_EQ(linked.patches(), 3);
  EXPECT_EQ(view.map_of(linked, 0), map);
}

TEST(Link, TheRigIsCutDownAndMovesAsBefore) {
  const auto input = make_input();
  const AlignedBytes file(link_image(input->link));
  const ImageView view = ImageView::open(file.bytes()).value();
  std::vector<RigNode> nodes(view.directory().nodes()->size());
  std::vector<RigTrack> tracks(view.directory().tracks()->size());
  ASSERT_EQ(nodes.size(), 4u);
  ASSERT_EQ(tracks.size(), 2u);
  view.read_rig(nodes, tracks);
  for (const Position position : {Position{0, 0}, Position{0.4f, 0.7f}, Position{1, 1}}) {
    std::vector<glm::mat4> whole(6), cut(4);
    evaluate_rig(input->scene.rig(), position, whole);
    evaluate_rig({nodes, tracks}, position, cut);
    EXPECT_EQ(cut[static_cast<size_t>(view.camera().node)], whole[2]);
    EXPECT_EQ(cut[view.directory().objects()->Get(0)->node()], whole[4]);
    EXPECT_EQ(cut[view.directory().objects()->Get(1)->node()], whole[0]);
  }
}

TEST(Link, TheSameInputMakesTheSameBytes) {
  const auto first = make_input(), second = make_input();
  EXPECT_EQ(link_image(first->link), link_image(second->link));
}

TEST(Link, NamesThatAnImageCannotHoldAreTheUsersToChange) {
  for (const std::string& name : {std::string("a\nb"), std::string(300, 'x'), std::string()}) {
    const auto input = make_input();
    input->scene.objects[1].name = name;
    EXPECT_THROW(link_image(input->link), InputError);
  }
}

TEST(Link, AnImageThatItsOwnReaderRefusesIsABug) {
  const auto input = make_input();
  input->encoded[1].node_bytes[0] += 1;
  EXPECT_THROW(link_image(input->link), std::logic_error);
}

TEST(Mesh, TrianglesAndTheirSidesSurviveExactly) {
  const auto input = make_input();
  const AlignedBytes file(link_image(input->link));
  const ImageView view = ImageView::open(file.bytes()).value();
  for (uint32_t i = 0; i < 2; ++i) {
    const fb::Object& object = *view.directory().objects()->Get(i);
    const DrawnObject& drawn = input->inference.objects[i];
    EXPECT_EQ(object.vertex_count(), drawn.vertices.size() - 1);  // without the unused one
    std::vector<MeshVertex> vertices(object.vertex_count());
    std::vector<uint32_t> indices(object.index_count());
    ASSERT_TRUE(decode_mesh(view, object, vertices, indices).ok());
    const size_t culled = object.culled_index_count();
    ASSERT_EQ(culled, drawn.culled_index_count);
    const std::span<const uint32_t> decoded(indices), original(drawn.indices);
    EXPECT_EQ(triangles_of(vertices, decoded.first(culled)), triangles_of(drawn.vertices, original.first(culled)));
    EXPECT_EQ(triangles_of(vertices, decoded.subspan(culled)), triangles_of(drawn.vertices, original.subspan(culled)));
  }
}

TEST(Mesh, IsCodedInFarFewerBytesThanItHas) {
  const DrawnObject drawn = wavy_grid(0, 60);
  const EncodedMesh mesh = encode_mesh(drawn.vertices, drawn.grid, drawn.indices, drawn.culled_index_count);
  EXPECT_LT(mesh.indices.size(), drawn.indices.size());  // under 3 bytes a triangle, of 12
  EXPECT_LT(mesh.vertices.size() * 4, drawn.vertices.size() * sizeof(MeshVertex) * 3);
}

TEST(Mesh, AllSingleSidedOrAllDoubleSidedIsCodedToo) {
  DrawnObject drawn = wavy_grid(0, 2);
  for (const uint32_t culled : {0u, static_cast<uint32_t>(drawn.indices.size())})
    EXPECT_EQ(encode_mesh(drawn.vertices, drawn.grid, drawn.indices, culled).vertex_count, 9u);
}

TEST(Rig, OnlyCarriersAndWhatIsAboveThemAreKept) {
  const auto input = make_input();
  const RigSubset subset = select_rig(input->scene, {2, 4, 4});
  EXPECT_EQ(subset.nodes, (std::vector<uint32_t>{0, 2, 3, 4}));
  EXPECT_EQ(subset.new_number, (std::vector<int32_t>{0, -1, 1, 2, 3, -1}));
  EXPECT_EQ(subset.tracks, (std::vector<uint32_t>{1, 2}));
}

}  // namespace
}  // namespace vitrine
