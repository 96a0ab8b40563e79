// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Opening images: what was written is read back, and everything that is wrong is refused with the right code.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/formats/test_image.h"

namespace vitrine {
namespace {

using test::coded_indices;
using test::coded_vertices;
using test::make_test_image;
using test::TestImage;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

Status open_status(const AlignedBytes& file) { return ImageView::open(file.bytes()).status(); }

// Reads all that an engine reads.
void use(const ImageView& view) {
  std::vector<RigNode> nodes(view.directory().nodes()->size());
  std::vector<RigTrack> tracks(view.directory().tracks()->size());
  view.read_rig(nodes, tracks);
  std::vector<glm::mat4> matrices(nodes.size());
  evaluate_rig({nodes, tracks}, {0.3f, 0.6f}, matrices);
  for (const fb::Object* object : *view.directory().objects()) {
    std::vector<MeshVertex> vertices(object->vertex_count());
    std::vector<uint32_t> indices(object->index_count());
    (void)decode_mesh(view, *object, vertices, indices);
    for (const fb::Field* field : *object->fields()) {
      const FieldShape shape = view.shape_of(*field);
      for (int node = 0; node < shape.node_count(); ++node) (void)shape.samples_of(node);
      for (int block = 0; block < shape.block_count(); ++block) (void)view.map_of(*field, block);
    }
  }
}

TEST(Image, WhatWasWrittenIsReadBack) {
  TestImage image = make_test_image();
  const AlignedBytes file = image.file();
  const Result<ImageView> opened = ImageView::open(file.bytes());
  ASSERT_TRUE(opened.ok()) << opened.status().detail();
  const ImageView& view = opened.value();
  EXPECT_EQ(view.version(), kImageVersion);
  EXPECT_EQ(view.file_bytes(), file.bytes().size());
  EXPECT_EQ(view.space().axis_count, 2);
  EXPECT_EQ(view.space().axes[1].kind, AxisKind::kPeriodic);
  EXPECT_EQ(view.space().axes[0].samples, 10);
  EXPECT_EQ(view.camera().node, 2);
  EXPECT_EQ(view.camera().far_distance, 100.0f);
  EXPECT_EQ(view.filter(), SurfaceFilter::kAnisotropic2);
  for (uint32_t i = 0; i < image.sections.size(); ++i) {
    const auto section = view.section(i);
    EXPECT_TRUE(std::equal(section.begin(), section.end(), image.sections[i].bytes.begin(), image.sections[i].bytes.end()));
  }
  const FieldShape shape = view.shape_of(*view.directory().objects()->Get(0)->fields()->Get(0));
  EXPECT_EQ(shape.space.axes[0].samples, 1);
  EXPECT_EQ(shape.space.axes[1].samples, 4);
  EXPECT_EQ(shape.pyramid.level_count, 3);
  EXPECT_EQ(shape.pyramid.cell[1][1], 2);
}

TEST(Image, ABlockLiesOnTheMeshByTheMapThatWasWrittenForIt) {
  TestImage image = make_test_image();
  const TextureMap maps[] = {{}, PatchMap{{0.25f, 1}, glm::mat2(0.5f, 0.125f, -0.25f, 2), {0.75f, -1}}};
  fb::FieldT& written = *image.directory.objects[0]->fields[1];
  written.maps.clear();
  for (const TextureMap& map : maps) test::add_map(written, map);
  image.directory.objects[1]->fields[0]->block_maps.clear();
  const AlignedBytes file = image.file();
  const Result<ImageView> opened = ImageView::open(file.bytes());
  ASSERT_TRUE(opened.ok()) << opened.status().detail();
  const fb::Field& several = *opened.value().directory().objects()->Get(0)->fields()->Get(1);
  for (const int block : {0, 1, 2, 5}) EXPECT_EQ(opened.value().map_of(several, block), maps[block % 2]) << block;
  const fb::Field& still = *opened.value().directory().objects()->Get(1)->fields()->Get(0);
  EXPECT_EQ(opened.value().map_of(still, 0), TextureMap{}) << "without numbers all blocks have the first";
}

TEST(Image, EachPatchOfAMeshLiesByTheMapThatWasWrittenForIt) {
  TestImage image = make_test_image();
  TextureMap maps[2];
  for (int block = 0; block < 2; ++block) {
    maps[block].patch_count = 3;
    for (int k = 0; k < kMaxPatches; ++k)  // beyond the last patch: as the last
      maps[block].patches[static_cast<size_t>(k)].offset = {block, std::min(k, 2)};
  }
  fb::FieldT& written = *image.directory.objects[0]->fields[1];
  written.maps.clear();
  for (const TextureMap& map : maps) test::add_map(written, map);
  const AlignedBytes file = image.file();
  const Result<ImageView> opened = ImageView::open(file.bytes());
  ASSERT_TRUE(opened.ok()) << opened.status().detail();
  const fb::Field& field = *opened.value().directory().objects()->Get(0)->fields()->Get(1);
  for (const int block : {0, 1}) {
    EXPECT_EQ(opened.value().map_of(field, block), maps[block]);
    EXPECT_EQ(opened.value().map_of(field, block)({2 * 1 + 0.25f, 0.5f}), glm::vec2(block + 0.25f, 1.5f));
  }
}

TEST(Image, BlendedSamplesOfAFieldLieOnTheMeshByOneMap) {
  TestImage image = make_test_image();
  image.directory.interpolate = true;
  EXPECT_EQ(open_status(image.file()).code(), StatusCode::kMalformed);
  for (auto& object : image.directory.objects)
    for (auto& field : object->fields) {
      field->maps.resize(kTextureMapValues);
      field->block_maps.clear();
    }
  const Status status = open_status(image.file());
  EXPECT_TRUE(status.ok()) << status.detail();
}

TEST(Image, RigIsReadBackWithDefaultsForWhatIsAbsent) {
  TestImage image = make_test_image();
  image.directory.nodes[0]->translation.reset();
  image.directory.nodes[0]->rotation.reset();
  image.directory.nodes[0]->scale.reset();
  const AlignedBytes file = image.file();
  const Result<ImageView> opened = ImageView::open(file.bytes());
  ASSERT_TRUE(opened.ok()) << opened.status().detail();
  std::vector<RigNode> nodes(4);
  std::vector<RigTrack> tracks(2);
  opened.value().read_rig(nodes, tracks);
  EXPECT_EQ(nodes[0].parent, -1);
  EXPECT_EQ(nodes[0].scale, glm::vec3(1));
  EXPECT_EQ(nodes[0].rotation, glm::quat(1, 0, 0, 0));
  EXPECT_EQ(nodes[2].parent, 1);
  EXPECT_EQ(nodes[2].translation, glm::vec3(0, 0, 2));
  EXPECT_EQ(nodes[3].matrix, glm::mat4(1));
  EXPECT_EQ(tracks[0].path, TrackPath::kRotation);
  EXPECT_EQ(tracks[0].positions.size(), 3u);
  EXPECT_EQ(tracks[0].values[5], 1.0f);
  EXPECT_EQ(tracks[1].interpolation, Interpolation::kCubicSpline);
}

TEST(Image, MeshesAreReadBackUpToTheStartOfTriangles) {
  TestImage image = make_test_image();
  const AlignedBytes file = image.file();
  const Result<ImageView> opened = ImageView::open(file.bytes());
  ASSERT_TRUE(opened.ok()) << opened.status().detail();
  const fb::Object& object = *opened.value().directory().objects()->Get(0);
  std::vector<MeshVertex> vertices(object.vertex_count());
  std::vector<uint32_t> indices(object.index_count());
  ASSERT_TRUE(decode_mesh(opened.value(), object, vertices, indices).ok());
  const auto expected_vertices = test::test_vertices();
  const auto expected = test::test_indices();
  for (size_t i = 0; i < vertices.size(); ++i) {
    EXPECT_EQ(vertices[i].x, expected_vertices[i].x);
    EXPECT_NEAR(vertices[i].v, expected_vertices[i].v, 0.5f / kTextureSteps);
  }
  for (size_t t = 0; t < expected.size(); t += 3) {
    bool same = false;
    for (size_t turn = 0; turn < 3; ++turn)
      same = same || (indices[t] == expected[t + turn] && indices[t + 1] == expected[t + (turn + 1) % 3] &&
                      indices[t + 2] == expected[t + (turn + 2) % 3]);
    EXPECT_TRUE(same) << t;
  }
  EXPECT_FALSE(decode_mesh(opened.value(), object, std::span(vertices).first(3), indices).ok());
}

TEST(Image, WithoutAxesAndObjectsIsAnImageToo) {
  TestImage image;
  TestImage model = make_test_image();
  image.directory.width = image.directory.height = image.directory.supersampling = 1;
  image.directory.nodes.push_back(test::make_node(-1, 0));
  image.directory.camera = std::move(model.directory.camera);
  image.directory.camera->node = 0;
  image.directory.plan = std::move(model.directory.plan);
  const Status status = open_status(image.file());
  EXPECT_TRUE(status.ok()) << status.detail();
}

// ---- one defect at a time ----

struct Defect {
  const char* name;
  void (*make)(TestImage&);
  StatusCode expected = StatusCode::kMalformed;
};

std::string numbered(int n) { return std::string(1, static_cast<char>('a' + n)); }
fb::FieldT& field_of(TestImage& image) { return *image.directory.objects[0]->fields[1]; }
fb::ObjectT& object_of(TestImage& image) { return *image.directory.objects[0]; }

const Defect kDefects[] = {
    {"PictureWithoutWidth", [](TestImage& i) { i.directory.width = 0; }},
    {"PictureTooHigh", [](TestImage& i) { i.directory.height = 8193; }},
    {"NoSupersampling", [](TestImage& i) { i.directory.supersampling = 0; }},
    {"TooMuchSupersampling", [](TestImage& i) { i.directory.supersampling = 5; }},
    {"ExposureZero", [](TestImage& i) { i.directory.exposure = 0; }},
    {"ExposureNaN", [](TestImage& i) { i.directory.exposure = kNaN; }},
    {"FilterUnknown", [](TestImage& i) { i.directory.filter = static_cast<fb::SurfaceFilter>(4); }},
    {"ProducerWithControlCharacters", [](TestImage& i) { i.directory.producer = "\x1b[2J"; }},
    {"FiveAxes",
     [](TestImage& i) {
       for (int a = 0; a < 3; ++a) i.directory.axes.push_back(test::make_axis(numbered(a), fb::AxisKind::linear, 2));
     }},
    {"AxisWithoutName", [](TestImage& i) { i.directory.axes[0]->name = ""; }},
    {"AxisNameNotUtf8", [](TestImage& i) { i.directory.axes[0]->name = "\xc3("; }},
    {"AxisNameOverlong", [](TestImage& i) { i.directory.axes[0]->name = std::string(256, 'a'); }},
    {"AxisNameWithNul", [](TestImage& i) { i.directory.axes[0]->name = std::string("a\0b", 3); }},
    {"AxisNamesEqual", [](TestImage& i) { i.directory.axes[0]->name = "lamp"; }},
    {"AxisKindUnknown", [](TestImage& i) { i.directory.axes[0]->kind = static_cast<fb::AxisKind>(3); }},
    {"AxisWithoutSamples", [](TestImage& i) { i.directory.axes[0]->samples = 0; }},
    {"AxisWithTooManySamples", [](TestImage& i) { i.directory.axes[0]->samples = 4097; }},
    {"AxisSpeedNegative", [](TestImage& i) { i.directory.axes[0]->max_speed = -1; }},
    {"AxisSpeedInfinite", [](TestImage& i) { i.directory.axes[0]->max_speed = kInfinity; }},
    {"GridTooLarge",
     [](TestImage& i) {
       for (auto& a : i.directory.axes) a->samples = 4096;
       i.directory.axes.push_back(test::make_axis("c", fb::AxisKind::linear, 2));
     }},
    {"NodeIsItsOwnParent", [](TestImage& i) { i.directory.nodes[1]->parent = 1; }},
    {"NodeParentAfterIt", [](TestImage& i) { i.directory.nodes[1]->parent = 3; }},
    {"NodeParentBelowNone", [](TestImage& i) { i.directory.nodes[1]->parent = -2; }},
    {"NodeTranslationNaN",
     [](TestImage& i) { i.directory.nodes[1]->translation = std::make_unique<fb::Vec3>(kNaN, 0.0f, 0.0f); }},
    {"NodeScaleInfinite", [](TestImage& i) { i.directory.nodes[1]->scale = std::make_unique<fb::Vec3>(1.0f, kInfinity, 0.0f); }},
    {"NodeRotationZero",
     [](TestImage& i) { i.directory.nodes[1]->rotation = std::make_unique<fb::Quat>(0.0f, 0.0f, 0.0f, 0.0f); }},
    {"NodeRotationNaN",
     [](TestImage& i) { i.directory.nodes[1]->rotation = std::make_unique<fb::Quat>(kNaN, 0.0f, 0.0f, 1.0f); }},
    {"NodeMatrixShort", [](TestImage& i) { i.directory.nodes[3]->matrix.resize(15); }},
    {"NodeMatrixNaN", [](TestImage& i) { i.directory.nodes[3]->matrix[7] = kNaN; }},
    {"TrackOfNoNode", [](TestImage& i) { i.directory.tracks[0]->node = 4; }},
    {"TrackOfNoAxis", [](TestImage& i) { i.directory.tracks[0]->axis = 2; }},
    {"TrackPathUnknown", [](TestImage& i) { i.directory.tracks[0]->path = static_cast<fb::TrackPath>(3); }},
    {"TrackInterpolationUnknown", [](TestImage& i) { i.directory.tracks[0]->interpolation = static_cast<fb::Interpolation>(3); }},
    {"TrackWithoutKeys",
     [](TestImage& i) {
       i.directory.tracks[0]->positions.clear();
       i.directory.tracks[0]->values.clear();
     }},
    {"TrackKeysEqual", [](TestImage& i) { i.directory.tracks[0]->positions[1] = 0; }},
    {"TrackKeysDescend",
     [](TestImage& i) { std::swap(i.directory.tracks[0]->positions[1], i.directory.tracks[0]->positions[2]); }},
    {"TrackKeyBeyondAxis", [](TestImage& i) { i.directory.tracks[0]->positions[2] = 1.5f; }},
    {"TrackKeyNaN", [](TestImage& i) { i.directory.tracks[0]->positions[1] = kNaN; }},
    {"TrackValueMissing", [](TestImage& i) { i.directory.tracks[0]->values.pop_back(); }},
    {"TrackValueNaN", [](TestImage& i) { i.directory.tracks[1]->values[4] = kNaN; }},
    {"TrackRotationZero", [](TestImage& i) { i.directory.tracks[0]->values[5] = 0; }},
    {"SplineWithoutTangents", [](TestImage& i) { i.directory.tracks[1]->values.resize(6); }},
    {"CameraOnNoNode", [](TestImage& i) { i.directory.camera->node = 4; }},
    {"CameraFieldOfViewZero", [](TestImage& i) { i.directory.camera->yfov = 0; }},
    {"CameraFieldOfViewBeyondPi", [](TestImage& i) { i.directory.camera->yfov = 3.2f; }},
    {"CameraFieldOfViewNaN", [](TestImage& i) { i.directory.camera->yfov = kNaN; }},
    {"CameraMagnificationZero",
     [](TestImage& i) {
       i.directory.camera->perspective = false;
       i.directory.camera->ymag = 0;
     }},
    {"CameraNearZero", [](TestImage& i) { i.directory.camera->near_distance = 0; }},
    {"CameraFarBeforeNear", [](TestImage& i) { i.directory.camera->far_distance = 0.1f; }},
    {"CameraFarInfinite", [](TestImage& i) { i.directory.camera->far_distance = kInfinity; }},
    {"PlanWithoutBudget", [](TestImage& i) { i.directory.plan->units_budget = 0; }},
    {"PlanUnitsAbsurd", [](TestImage& i) { i.directory.plan->units_worst = ~uint64_t{0}; }},
    {"PlanCacheAbsurd", [](TestImage& i) { i.directory.plan->cache_bytes = ~uint64_t{0}; }},
    {"PlanCacheAndTexturesTooLarge", [](TestImage& i) { i.directory.plan->cache_bytes = limits::kEngineBytes - 1; }},
    {"PlanUploadAbsurd", [](TestImage& i) { i.directory.plan->upload_worst = ~uint64_t{0}; }},
    {"PlanHorizonAbsurd", [](TestImage& i) { i.directory.plan->horizon_frames = ~0u; }},
    {"PlanSettlesNever", [](TestImage& i) { i.directory.plan->settle_frames = ~0u; }},
    {"ObjectWithoutName", [](TestImage& i) { object_of(i).name = ""; }},
    {"ObjectNamesEqual", [](TestImage& i) { object_of(i).name = "floor"; }},
    {"ObjectRepresentationUnknown", [](TestImage& i) { object_of(i).representation = static_cast<fb::Representation>(1); },
     StatusCode::kUnsupported},
    {"ObjectOnNoNode", [](TestImage& i) { object_of(i).node = 4; }},
    {"ObjectWithoutVertices", [](TestImage& i) { object_of(i).vertex_count = 0; }},
    {"ObjectWithTooManyVertices", [](TestImage& i) { object_of(i).vertex_count = kMaxVertices + 1; }},
    {"ObjectWithoutIndices", [](TestImage& i) { object_of(i).index_count = 0; }},
    {"ObjectWithHalfATriangle", [](TestImage& i) { object_of(i).index_count = 8; }},
    {"ObjectCulledBeyondIndices", [](TestImage& i) { object_of(i).culled_index_count = 12; }},
    {"ObjectCulledHalfATriangle", [](TestImage& i) { object_of(i).culled_index_count = 4; }},
    {"ObjectMeshElsewhere", [](TestImage& i) { object_of(i).mesh = 1; }},
    {"ObjectMeshBeyondSections", [](TestImage& i) { object_of(i).mesh = 1000; }},
    {"ObjectMeshShared", [](TestImage& i) { i.directory.objects[1]->mesh = object_of(i).mesh; }},
    {"ObjectVerticesTakeTooMuch", [](TestImage& i) { object_of(i).coded_vertex_bytes = ~0u; }},
    {"ObjectIndicesTakeTooMuch", [](TestImage& i) { object_of(i).coded_index_bytes = 1u << 20; }},
    {"ObjectGridNowhere", [](TestImage& i) { object_of(i).grid_origin = std::make_unique<fb::Vec3>(0.0f, kNaN, 0.0f); }},
    {"ObjectGridTooWide", [](TestImage& i) { object_of(i).grid_step = kInfinity; }},
    {"SectionOfWrongKind", [](TestImage& i) { i.sections[1].kind = fb::SectionKind::mesh; }},
    {"SectionKindUnknown", [](TestImage& i) { i.sections[1].kind = static_cast<fb::SectionKind>(2); }},
    {"SectionThatNothingUses", [](TestImage& i) { i.add(fb::SectionKind::nodes, {}); }},
    {"SectionMissing", [](TestImage& i) { i.sections.pop_back(); }},
    {"TooManyFields",
     [](TestImage& i) {
       for (int n = 0; n < 8; ++n) i.directory.objects[1]->fields.push_back(test::make_field(i, numbered(n), 0));
     }},
    {"FieldLayersEqual", [](TestImage& i) { field_of(i).layer = "diffuse"; }},
    {"FieldLayerWithoutName", [](TestImage& i) { field_of(i).layer = ""; }},
    {"FieldOnNoAxis", [](TestImage& i) { field_of(i).axes = 7; }},
    {"FieldTextureWithoutWidth", [](TestImage& i) { field_of(i).texture_width = 0; }},
    {"FieldTextureWithoutHeight", [](TestImage& i) { field_of(i).texture_height = 0; }},
    {"FieldTextureTooWide", [](TestImage& i) { field_of(i).texture_width = kMaxTextureSize + 1; }},
    {"FieldTextureTooHigh", [](TestImage& i) { field_of(i).texture_height = kMaxTextureSize + 1; }},
    {"FieldTexturesTooLargeTogether",
     [](TestImage& i) {
       for (auto& object : i.directory.objects)
         for (auto& field : object->fields) field->texture_width = field->texture_height = kMaxTextureSize;
     }},
    {"MapsMissing", [](TestImage& i) { field_of(i).maps.clear(); }},
    {"MapShort", [](TestImage& i) { field_of(i).maps.pop_back(); }},
    {"MapsTooManyOfAField", [](TestImage& i) { field_of(i).maps.assign(kTextureMapValues * 65537, 0.5f); }},
    {"MapsTooManyTogether",
     [](TestImage& i) {
       for (uint32_t n = 0; n < 17; ++n) {
         i.directory.objects.push_back(test::make_object(i, "o" + std::to_string(n), 0));
         i.directory.objects.back()->fields.push_back(test::make_field(i, "layer", 0));
         i.directory.objects.back()->fields[0]->maps.assign(kTextureMapValues * 65536, 0.5f);
       }
     }},
    {"PatchesNone", [](TestImage& i) { field_of(i).patches = 0; }},
    {"PatchesTooMany", [](TestImage& i) { field_of(i).patches = kMaxPatches + 1; }},
    {"PatchesFarTooMany", [](TestImage& i) { field_of(i).patches = 255; }},
    {"MapOfAPatchMissing", [](TestImage& i) { field_of(i).patches = 3; }},
    {"BlockMapThatDoesNotExistForAllPatches", [](TestImage& i) { field_of(i).patches = 2; }},
    {"MapCutNegative", [](TestImage& i) { field_of(i).maps[8] = -0.01f; }},
    {"MapCutBeyondOne", [](TestImage& i) { field_of(i).maps[9] = 1.01f; }},
    {"MapCutNaN", [](TestImage& i) { field_of(i).maps[0] = kNaN; }},
    {"MapNaN", [](TestImage& i) { field_of(i).maps[2] = kNaN; }},
    {"MapInfinite", [](TestImage& i) { field_of(i).maps[15] = kInfinity; }},
    {"MapTooSteep", [](TestImage& i) { field_of(i).maps[6] = -1.1e6f; }},
    {"MapTooFarAway", [](TestImage& i) { field_of(i).maps[4] = 1.1e6f; }},
    {"BlockMapMissing", [](TestImage& i) { field_of(i).block_maps.pop_back(); }},
    {"BlockMapOfNoBlock", [](TestImage& i) { field_of(i).block_maps.push_back(0); }},
    {"BlockMapThatDoesNotExist", [](TestImage& i) { field_of(i).block_maps[3] = 2; }},
    {"BlockMapFarBeyond", [](TestImage& i) { field_of(i).block_maps.back() = 65535; }},
    {"FieldCoderUnknown", [](TestImage& i) { field_of(i).coder = static_cast<fb::NodeCoder>(2); }, StatusCode::kUnsupported},
    {"BlockSizePerAxisMissing", [](TestImage& i) { field_of(i).block_size.pop_back(); }},
    {"BlockSizeNotAPowerOfTwo", [](TestImage& i) { field_of(i).block_size[0] = 6; }},
    {"BlockSizeZero", [](TestImage& i) { field_of(i).block_size[0] = 0; }},
    {"BlockSizeTooLarge", [](TestImage& i) { field_of(i).block_size[0] = 16; }},
    {"StaggerBeyondBlock", [](TestImage& i) { field_of(i).stagger[0] = 4; }},
    {"StaggerPerAxisMissing", [](TestImage& i) { field_of(i).stagger.clear(); }},
    {"CellsMissing", [](TestImage& i) { field_of(i).cells.pop_back(); }},
    {"CellLargerThanBlock", [](TestImage& i) { field_of(i).cells[0] = 8; }},
    {"CellZero", [](TestImage& i) { field_of(i).cells[2] = 0; }},
    {"CellGrows", [](TestImage& i) { field_of(i).cells[0] = 1; }},
    {"LastCellNotOne", [](TestImage& i) { field_of(i).cells[4] = 2; }},
    {"StepsNotByThrees", [](TestImage& i) { field_of(i).level_steps.pop_back(); }},
    {"StepsOfNoLevel", [](TestImage& i) { field_of(i).level_steps.clear(); }},
    {"StepsOfTooManyLevels",
     [](TestImage& i) {
       field_of(i).level_steps.assign(3 * (kMaxLevels + 1), 1);
       field_of(i).cells.assign(2 * (kMaxLevels + 1), 1);
       field_of(i).contexts.clear();
     }},
    {"StepZero", [](TestImage& i) { field_of(i).level_steps[4] = 0; }},
    {"NodeTableShort", [](TestImage& i) { field_of(i).node_bytes.pop_back(); }},
    {"NodeUnitsTableLong", [](TestImage& i) { field_of(i).node_units.push_back(0); }},
    {"NodeBytesBeyondSection", [](TestImage& i) { field_of(i).node_bytes[0] += 1; }},
    {"NodeCostsNothing", [](TestImage& i) { field_of(i).node_units[0] = 0; }},
    {"NodeOffTheGridHasBytes",
     [](TestImage& i) {
       // Cell 0 of the finest level of the first block lies before the grid: the stagger is 1. Moves a byte there.
       field_of(i).node_bytes[0] -= 1;
       field_of(i).node_bytes[1 + 4] += 1;
     }},
    {"HalvedAxesMissing", [](TestImage& i) { field_of(i).halved = {-1, -1}; }},
    {"HalvedAxisUnknown", [](TestImage& i) { field_of(i).halved = {-1, 2, -1}; }},
    {"HalvedAxisNegative", [](TestImage& i) { field_of(i).halved = {-1, -1, -2}; }},
    {"HalvedTop", [](TestImage& i) { field_of(i).halved = {0, -1, -1}; }},
    {"HalvedCellOfOne", [](TestImage& i) { field_of(i).halved = {-1, -1, 0}; }},
    {"ContextsShort", [](TestImage& i) { field_of(i).contexts.pop_back(); }},
    {"ContextsLong", [](TestImage& i) { field_of(i).contexts.push_back(0); }},
    {"ContextThatDoesNotExist", [](TestImage& i) { field_of(i).contexts[7] = 160; }},
    {"ContextsNotAscending", [](TestImage& i) { field_of(i).contexts[3] = 0; }},
};

class ImageDefect : public testing::TestWithParam<Defect> {};

TEST_P(ImageDefect, IsRefused) {
  TestImage image = make_test_image();
  ASSERT_TRUE(open_status(image.file()).ok());
  GetParam().make(image);
  const Status status = open_status(image.file());
  EXPECT_EQ(status.code(), GetParam().expected) << status.detail();
}

INSTANTIATE_TEST_SUITE_P(All, ImageDefect, testing::ValuesIn(kDefects), [](const auto& defect) { return defect.param.name; });

// ---- the file around the directory ----

void put_u64(AlignedBytes& file, size_t at, uint64_t value) {
  for (size_t i = 0; i < 8; ++i) file.bytes()[at + i] = static_cast<std::byte>(value >> 8 * i & 0xff);
}
void reseal(AlignedBytes& file) { put_u64(file, 56, checksum_of(file.bytes().first(56))); }

TEST(ImageFile, OfAnotherKindIsNamedSo) {
  TestImage image = make_test_image();
  AlignedBytes file = image.file();
  file.bytes()[0] = std::byte{'P'};
  EXPECT_EQ(open_status(file).code(), StatusCode::kBadMagic);
  const AlignedBytes text(std::as_bytes(std::span("PNG", 3)));
  EXPECT_EQ(open_status(text).code(), StatusCode::kBadMagic);
}

TEST(ImageFile, OfALaterVersionIsRefusedAsSuch) {
  TestImage image = make_test_image();
  AlignedBytes file = image.file();
  file.bytes()[8] = std::byte{kImageVersion + 1};
  EXPECT_EQ(open_status(file).code(), StatusCode::kUnsupportedVersion);
  file.bytes()[8] = std::byte{0};
  EXPECT_EQ(open_status(file).code(), StatusCode::kUnsupportedVersion);
}

TEST(ImageFile, NotAtAMultipleOf64IsRefused) {
  TestImage image = make_test_image();
  std::vector<std::byte> bytes(8);
  for (const std::byte b : write_image(image.directory, image.sections)) bytes.push_back(b);
  const AlignedBytes shifted(bytes);
  EXPECT_EQ(ImageView::open(shifted.bytes().subspan(8)).status().code(), StatusCode::kUnsupported);
}

TEST(ImageFile, WithAForgedHeaderIsRefused) {
  TestImage image = make_test_image();
  for (const size_t at : {12, 24, 48}) {  // header size, directory offset, its expanded size
    AlignedBytes file = image.file();
    file.bytes()[at] ^= std::byte{4};
    EXPECT_EQ(open_status(file).code(), StatusCode::kChecksumMismatch) << at;
    reseal(file);
    EXPECT_EQ(open_status(file).code(), StatusCode::kMalformed) << at;
  }
  for (const size_t at : {32, 48})  // directory size, packed and expanded
    for (const uint64_t size : {uint64_t{0}, uint64_t{1} << 28, uint64_t{1} << 40, ~uint64_t{0}}) {
      AlignedBytes file = image.file();
      put_u64(file, at, size);
      reseal(file);
      EXPECT_FALSE(open_status(file).ok()) << at << ' ' << size;
    }
}

TEST(ImageFile, WithBytesBehindItsEndIsRefused) {
  TestImage image = make_test_image();
  std::vector<std::byte> bytes = write_image(image.directory, image.sections);
  bytes.resize(bytes.size() + 64);
  EXPECT_EQ(open_status(AlignedBytes(bytes)).code(), StatusCode::kMalformed);
}

TEST(ImageFile, WithSectionsThatOverlapOrLieOutsideIsRefused) {
  using Edit = fb::Section (*)(const fb::Section&);
  const Edit edits[] = {
      [](const fb::Section& s) { return fb::Section(s.kind(), s.offset() - 64, s.size(), s.checksum()); },
      [](const fb::Section& s) { return fb::Section(s.kind(), s.offset() + 64, s.size(), s.checksum()); },
      [](const fb::Section& s) { return fb::Section(s.kind(), s.offset() + 1, s.size(), s.checksum()); },
      [](const fb::Section& s) { return fb::Section(s.kind(), s.offset(), ~uint64_t{0}, s.checksum()); },
      [](const fb::Section& s) { return fb::Section(s.kind(), s.offset(), ~uint64_t{0} - s.offset() + 1, s.checksum()); },
      [](const fb::Section& s) { return fb::Section(s.kind(), ~uint64_t{63}, s.size(), s.checksum()); },
  };
  for (const Edit edit : edits)
    for (const size_t which : {size_t{0}, size_t{2}, size_t{4}}) {
      TestImage image = make_test_image();
      (void)write_image(image.directory, image.sections);
      ASSERT_LT(which, image.directory.sections.size());
      image.directory.sections[which] = edit(image.directory.sections[which]);
      const AlignedBytes file(write_file(serialize_directory(image.directory), image.sections));
      EXPECT_EQ(open_status(file).code(), StatusCode::kMalformed) << which;
    }
}

TEST(ImageFile, CutAnywhereIsRefused) {
  TestImage image = make_test_image();
  const std::vector<std::byte> bytes = write_image(image.directory, image.sections);
  for (size_t size = 0; size < bytes.size(); ++size) {
    const Status status = open_status(AlignedBytes(std::span(bytes).first(size)));
    ASSERT_EQ(status.code(), StatusCode::kTruncated) << size;
  }
}

// Every byte of a file counts: nothing can change without being noticed.
TEST(ImageFile, WithAnyOneBitFlippedIsRefused) {
  TestImage image = make_test_image();
  AlignedBytes file = image.file();
  for (size_t bit = 0; bit < 8 * file.bytes().size(); ++bit) {
    std::byte& byte = file.bytes()[bit / 8];
    byte ^= static_cast<std::byte>(1 << bit % 8);
    ASSERT_FALSE(open_status(file).ok()) << bit;
    byte ^= static_cast<std::byte>(1 << bit % 8);
  }
  EXPECT_TRUE(open_status(file).ok());
}

// A hostile writer makes the checksums right: then the directory's own checks must hold.
TEST(ImageFile, WithAHostileDirectoryNeverCrashesAReader) {
  TestImage image = make_test_image();
  (void)write_image(image.directory, image.sections);
  const std::vector<std::byte> original = serialize_directory(image.directory);
  std::mt19937 random(1);
  int opened = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<std::byte> directory = original;
    for (int flips = 1 + trial % 3; flips > 0; --flips) {
      std::byte& byte = directory[random() % directory.size()];
      byte = trial % 2 == 0 ? byte ^ static_cast<std::byte>(1 << random() % 8)
                            : static_cast<std::byte>(random() % 5 == 0 ? 255 : random() % 256);
    }
    const AlignedBytes file(write_file(directory, image.sections, kFastCompression));
    const Result<ImageView> view = ImageView::open(file.bytes());
    if (!view.ok()) continue;
    ++opened;
    use(view.value());
  }
  EXPECT_GT(opened, 100);  // names, speeds, units: some changes are harmless, and the harness does reach the readers
}

// Damage that a hostile writer does after compression.
TEST(ImageFile, WithAHostileCompressedDirectoryNeverCrashesAReader) {
  TestImage image = make_test_image();
  const AlignedBytes original = image.file();
  const size_t packed_bytes = compress(serialize_directory(image.directory)).size();
  std::mt19937 random(3);
  for (int trial = 0; trial < 20000; ++trial) {
    AlignedBytes file(original.bytes());
    const std::span<std::byte> packed = file.bytes().subspan(kHeaderBytes, packed_bytes);
    for (int flips = 1 + trial % 3; flips > 0; --flips)
      packed[random() % packed_bytes] ^= static_cast<std::byte>(1 << random() % 8);
    put_u64(file, 40, checksum_of(packed));
    reseal(file);
    const Result<ImageView> view = ImageView::open(file.bytes());
    if (view.ok()) use(view.value());
  }
}

// Every mesh of the damaged image is read.
int refused_meshes(TestImage& image) {
  const AlignedBytes file = image.file();
  const Result<ImageView> view = ImageView::open(file.bytes());
  EXPECT_TRUE(view.ok()) << view.status().detail();
  int refused = 0;
  for (const fb::Object* object : *view.value().directory().objects()) {
    std::vector<MeshVertex> vertices(object->vertex_count());
    std::vector<uint32_t> indices(object->index_count());
    const Status status = decode_mesh(view.value(), *object, vertices, indices);
    refused += !status.ok();
    if (!status.ok()) continue;
    for (const uint32_t index : indices) EXPECT_LT(index, vertices.size());
  }
  return refused;
}

TEST(ImageFile, WithHostileMeshesNeverCrashesAReader) {
  std::mt19937 random(2);
  int refused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    TestImage image = make_test_image();
    fb::ObjectT& object = *image.directory.objects[0];
    std::vector<std::byte> coded = coded_vertices(test::test_vertices());
    const auto indices = coded_indices(test::test_indices(), 5);
    coded.insert(coded.end(), indices.begin(), indices.end());
    const bool before = trial % 2 == 0;  // compression, or after it
    std::vector<std::byte>& section = image.sections[object.mesh].bytes;
    std::vector<std::byte>& bytes = before ? coded : section;
    if (trial % 5 == 0 && !before)
      bytes.resize(random() % bytes.size());
    else
      bytes[random() % bytes.size()] = static_cast<std::byte>(random() % 256);
    if (before) section = compress(coded);
    refused += refused_meshes(image);
  }
  EXPECT_GT(refused, 500);
}

TEST(ImageFile, MeshStreamsOfOtherCodecVersionsAreRefused) {
  for (const bool vertices : {true, false}) {
    TestImage image = make_test_image();
    std::vector<std::byte> first = coded_vertices(test::test_vertices()), second = coded_indices(test::test_indices(), 5);
    (vertices ? first : second)[0] ^= std::byte{1};  // index version 0 would decode: an image never holds it
    first.insert(first.end(), second.begin(), second.end());
    image.sections[image.directory.objects[0]->mesh].bytes = compress(first);
    EXPECT_EQ(refused_meshes(image), 1);
  }
}

}  // namespace
}  // namespace vitrine
