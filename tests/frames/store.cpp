// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/frames/store.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <random>
#include <set>

#include "host/base/error.h"
#include "host/frames/exr.h"
#include "host/frames/sealed_file.h"
#include "host/scene/deformation.h"

namespace vitrine {
namespace {

namespace fs = std::filesystem;

struct TemporaryFolder {
  fs::path path =
      fs::temp_directory_path() / ("vitrine-store-" + std::to_string(::getpid()) + "-" + std::to_string(std::random_device{}()));
  ~TemporaryFolder() { fs::remove_all(path); }
};

// Three objects, of which a frame shows two.
Scene small_scene() {
  Scene scene;
  scene.nodes.resize(4);
  for (int i = 0; i < 3; ++i) {
    Object o;
    o.name = i == 0 ? "combined" : "object." + std::to_string(i);  // names that could be mistaken
    o.node = i + 1;
    o.geometry.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    o.geometry.normals.assign(3, {0, 0, 1});
    o.geometry.indices = {0, 1, 2};
    o.geometry.triangle_materials = {0};
    scene.objects.push_back(o);
  }
  scene.materials.resize(1);
  scene.lights.resize(1);
  scene.images.push_back({"picture", 1, 1, {1, 2, 3, 4}});
  scene.environment = {1, 1, {glm::vec3(0.5f)}, 0};
  return scene;
}

ObjectFrame object_frame(int object, int x, int y, int width, int height, std::mt19937& random) {
  ObjectFrame o{object, x, y, width, height, {}, {}, {}};
  std::uniform_real_distribution<float> light(0, 30), share(0, 1);
  for (int i = 0; i < width * height; ++i) {
    o.coverage.push_back(share(random));
    o.diffuse.emplace_back(light(random), light(random), light(random));
    o.specular.emplace_back(light(random), light(random), light(random));
  }
  return o;
}

Frame frame_of(int width, int height, std::mt19937& random) {
  Frame f{width, height, {}, {}};
  for (int i = 0; i < width * height; ++i) f.combined.emplace_back(static_cast<float>(random() % 1000) * 0.01f);
  f.objects.push_back(object_frame(0, 0, 0, width, height, random));
  f.objects.push_back(object_frame(2, 3, 1, 4, 2, random));
  return f;
}

// Half floats have 11 significant bits: relative error at most 2^-11.
void expect_half_precision(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[i][c], b[i][c], std::fabs(a[i][c]) * 0x1p-11 + 0x1p-25);
  }
}

fs::path only_file_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  EXPECT_EQ(files.size(), 1u);
  return files.empty() ? fs::path() : files[0];
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write_bytes(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

const StoreKey kKey{0x0123456789abcdefull, 42};

TEST(Store, FramesComeBackWithinHalfPrecision) {
  const TemporaryFolder folder;
  const Store store(folder.path);
  const Scene scene = small_scene();
  std::mt19937 random(1);
  const Frame frame = frame_of(9, 5, random);
  EXPECT_FALSE(store.has_frame(kKey));
  EXPECT_FALSE(store.load_frame(kKey, scene));
  store.save_frame(kKey, scene, frame);
  EXPECT_TRUE(store.has_frame(kKey));
  const auto loaded = store.load_frame(kKey, scene);
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->width, 9);
  EXPECT_EQ(loaded->height, 5);
  expect_half_precision(frame.combined, loaded->combined);
  ASSERT_EQ(loaded->objects.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    const ObjectFrame &a = frame.objects[i], &b = loaded->objects[i];
    EXPECT_EQ(a.object, b.object);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.y, b.y);
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    expect_half_precision(a.diffuse, b.diffuse);
    expect_half_precision(a.specular, b.specular);
    for (size_t k = 0; k < a.coverage.size(); ++k) EXPECT_NEAR(a.coverage[k], b.coverage[k], 0x1p-11);
  }
}

TEST(Store, LightBeyondHalfIsClampedNotInfinite) {
  const TemporaryFolder folder;
  const Store store(folder.path);
  const Frame frame{1, 1, {{1e9f, std::nanf(""), 1}}, {}};
  store.save_frame(kKey, small_scene(), frame);
  const auto loaded = store.load_frame(kKey, small_scene());
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->combined[0], glm::vec3(65504, 0, 1));
}

TEST(Store, PlanesComeBackInTheirOrder) {
  const TemporaryFolder folder;
  const Store store(folder.path);
  const LayeredImage image{2, 1, {{"z", {1, 2}}, {"a", {3, 4}}, {"m.R", {0.5f, -0.25f}}}};
  store.save_planes(kKey, image);
  EXPECT_TRUE(store.has_planes(kKey));
  EXPECT_FALSE(store.has_frame(kKey));
  const auto loaded = store.load_planes(kKey);
  ASSERT_TRUE(loaded);
  ASSERT_EQ(loaded->planes.size(), 3u);
  for (size_t p = 0; p < 3; ++p) {
    EXPECT_EQ(loaded->planes[p].name, image.planes[p].name);
    EXPECT_EQ(loaded->planes[p].values, image.planes[p].values);
  }
}

TEST(Store, DamagedFilesCountAsAbsent) {
  const TemporaryFolder folder;
  const Store store(folder.path);
  const Scene scene = small_scene();
  std::mt19937 random(2);
  store.save_frame(kKey, scene, frame_of(9, 5, random));
  const fs::path file = only_file_in(folder.path / "frames");
  const std::string whole = bytes_of(file);
  for (size_t size = 0; size < whole.size(); size += 1 + whole.size() / 60) {  // cut short
    write_bytes(file, whole.substr(0, size));
    EXPECT_FALSE(store.load_frame(kKey, scene)) << size << " bytes of " << whole.size();
    EXPECT_FALSE(store.has_frame(kKey));
  }
  for (int i = 0; i < 100; ++i) {  // a flipped bit
    std::string damaged = whole;
    damaged[random() % damaged.size()] ^= static_cast<char>(1 << random() % 8);
    write_bytes(file, damaged);
    EXPECT_FALSE(store.load_frame(kKey, scene));
  }
  write_bytes(file, whole + "x");
  EXPECT_FALSE(store.load_frame(kKey, scene));
  write_bytes(file, whole);
  EXPECT_TRUE(store.load_frame(kKey, scene));
}

// Even where the seal is right (a file forged with care), nothing in the file is trusted.
TEST(Store, HostileFilesUnderAGoodSealDoNotCrash) {
  const TemporaryFolder folder;
  const Store store(folder.path);
  std::mt19937 random(3);
  store.save_frame(kKey, small_scene(), frame_of(9, 5, random));
  const std::string content = *read_sealed(only_file_in(folder.path / "frames"));
  for (int i = 0; i < 400; ++i) {
    std::string forged = content;
    for (int k = 0; k < 1 + i % 4; ++k) forged[random() % std::min<size_t>(forged.size(), 1500)] = static_cast<char>(random());
    const auto file = decode_exr(forged);
    if (!file) continue;
    for (const ExrPart& part : file->parts) {
      EXPECT_TRUE(part.x >= 0 && part.y >= 0 && part.x + part.width <= file->width && part.y + part.height <= file->height);
      for (const ExrChannel& c : part.channels) {
        EXPECT_EQ(c.values.size(), static_cast<size_t>(part.width) * static_cast<size_t>(part.height));
      }
    }
  }
}

// A well-formed file that is not a frame of this scene.
TEST(Store, WellFormedFilesThatAreNoFramesAreRefused) {
  const TemporaryFolder folder;
  const Store store(folder.path);
  const auto part = [](const char* name, int tag, int x, int size, int channels) {
    ExrPart p{name, tag, x, 0, size, size, {}};
    for (int c = 0; c < channels; ++c)
      p.channels.push_back({"c" + std::to_string(c), std::vector<float>(static_cast<size_t>(size * size))});
    return p;
  };
  store.save_frame(kKey, small_scene(), {1, 1, {glm::vec3(1)}, {}});
  const fs::path file = only_file_in(folder.path / "frames");
  const auto loads = [&](const ExrFile& content) {
    write_sealed(file, folder.path / "scratch", encode_exr(content));
    return store.load_frame(kKey, small_scene()).has_value();
  };
  EXPECT_TRUE(loads({4, 4, {part("combined", -1, 0, 4, 3), part("a", 1, 2, 2, 7), part("b", 2, 0, 1, 7)}}));
  EXPECT_FALSE(loads({4, 4, {part("combined", -1, 0, 3, 3)}}));                         // not the whole picture
  EXPECT_FALSE(loads({4, 4, {part("combined", -1, 0, 4, 2)}}));                         // a channel short
  EXPECT_FALSE(loads({4, 4, {part("combined", -1, 0, 4, 3), part("a", 1, 3, 2, 7)}}));  // beyond the picture
  EXPECT_FALSE(loads({4, 4, {part("combined", -1, 0, 4, 3), part("a", 3, 0, 2, 7)}}));  // no such object
  EXPECT_FALSE(loads({4, 4, {part("combined", -1, 0, 4, 3), part("a", 1, 0, 2, 6)}}));  // a channel short
  EXPECT_FALSE(loads({4, 4, {part("combined", -1, 0, 4, 3), part("b", 2, 0, 1, 7), part("a", 1, 0, 1, 7)}}));  // out of order
}

TEST(Store, FramesOfAnotherSceneAreRefused) {
  const TemporaryFolder folder;
  const Store store(folder.path);
  Scene scene = small_scene();
  std::mt19937 random(4);
  store.save_frame(kKey, scene, frame_of(9, 5, random));
  scene.objects.pop_back();  // the frame shows it
  EXPECT_FALSE(store.load_frame(kKey, scene));
}

TEST(Store, RenamedObjectsStillFindTheirFrames) {
  const TemporaryFolder folder;
  const Store store(folder.path);
  Scene scene = small_scene();
  std::mt19937 random(4);
  store.save_frame(kKey, scene, frame_of(9, 5, random));
  scene.objects[2].name = "renamed";
  EXPECT_TRUE(store.load_frame(kKey, scene));
}

// A process that is killed while it saves leaves whole files or none.
TEST(Store, KilledWriterLeavesWholeFilesOrNone) {
  const TemporaryFolder folder;
  const Scene scene = small_scene();
  { const Store created(folder.path); }
  for (int round = 0; round < 10; ++round) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      const Store store(folder.path);
      std::mt19937 random(5);
      const Frame frame = frame_of(60, 50, random);
      for (uint64_t i = 0;; ++i) store.save_frame({i, 1}, scene, frame);
    }
    ::usleep(static_cast<useconds_t>(15000 + 3000 * round));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const Store store(folder.path);
    for (uint64_t i = 0; i < 100; ++i) {
      if (store.has_frame({i, 1})) {
        EXPECT_TRUE(store.load_frame({i, 1}, scene));
      }
    }
    size_t visible = 0, whole = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path / "frames")) {
      if (!entry.is_regular_file()) continue;
      ++visible;
      whole += read_sealed(entry.path()).has_value();
    }
    EXPECT_EQ(visible, whole);
  }
}

TEST(Store, LeftoversOfKilledWritersAreClearedAfterADay) {
  const TemporaryFolder folder;
  { const Store created(folder.path); }
  const fs::path old = folder.path / "scratch" / "old", fresh = folder.path / "scratch" / "fresh";
  write_bytes(old, "x");
  write_bytes(fresh, "x");
  fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(25));
  const Store store(folder.path);
  EXPECT_FALSE(fs::exists(old));
  EXPECT_TRUE(fs::exists(fresh));  // another machine may be writing it
}

TEST(Store, FolderThatCannotBeIsAnInputError) {
  const TemporaryFolder folder;
  write_bytes(folder.path, "a file");
  EXPECT_THROW(Store{folder.path}, InputError);
}

TEST(Store, SavingAFrameIsQuick) {
  const TemporaryFolder folder;
  const Store store(folder.path);
  Scene scene = small_scene();
  scene.objects.resize(7, scene.objects[1]);
  for (size_t i = 0; i < 7; ++i) scene.objects[i].name = "o" + std::to_string(i);
  std::mt19937 random(6);
  Frame frame{320, 240, std::vector<glm::vec3>(320 * 240, glm::vec3(0.5f)), {}};
  for (int o = 0; o < 7; ++o) frame.objects.push_back(object_frame(o, 40 * o, 20, 80, 80, random));
  const auto start = std::chrono::steady_clock::now();
  constexpr int kFrames = 5;
  for (uint64_t i = 0; i < kFrames; ++i) store.save_frame({i, 0}, scene, frame);
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count() / kFrames;
  RecordProperty("milliseconds", std::to_string(ms));
  std::printf("saving a frame of 320 x 240 with 7 objects: %.1f ms\n", ms);
}

// Keys.

StoreKey frame_key_of(const Scene& scene, const TraceOptions& options = {}, const Position& position = {}) {
  return frame_key(scene_key(scene), scene, position, options);
}

TEST(Key, ChangesWithWhateverLightDependsOn) {
  std::set<std::string> keys = {frame_key_of(small_scene()).hex()};
  size_t expected = 1;
  const auto expect_new = [&](const char* what, const std::function<void(Scene&)>& change) {
    Scene scene = small_scene();
    change(scene);
    keys.insert(frame_key_of(scene).hex());
    EXPECT_EQ(keys.size(), ++expected) << what;
  };
  expect_new("position", [](Scene& s) { s.objects[1].geometry.positions[0].x = 1e-6f; });
  expect_new("normal", [](Scene& s) { s.objects[1].geometry.normals[0] = {0, 1, 0}; });
  expect_new("texcoord", [](Scene& s) { s.objects[1].geometry.texcoords[0].assign(3, {0, 0}); });
  expect_new("texcoord set", [](Scene& s) { s.objects[1].geometry.texcoords[1].assign(3, {0, 0}); });
  expect_new("colour", [](Scene& s) { s.objects[1].geometry.colors.assign(3, glm::vec4(1)); });
  expect_new("index", [](Scene& s) { s.objects[1].geometry.indices = {0, 2, 1}; });
  expect_new("triangle's material", [](Scene& s) { s.objects[1].geometry.triangle_materials = {-1}; });
  expect_new("variant", [](Scene& s) { s.objects[1].variant_materials = {{0}, {0}}; });
  expect_new("base colour", [](Scene& s) { s.materials[0].base_color.a = 0.5f; });
  expect_new("roughness", [](Scene& s) { s.materials[0].roughness = 0.5f; });
  expect_new("emission", [](Scene& s) { s.materials[0].emissive.y = 1; });
  expect_new("double-sided", [](Scene& s) { s.materials[0].double_sided = true; });
  expect_new("unlit", [](Scene& s) { s.materials[0].unlit = true; });
  expect_new("alpha", [](Scene& s) { s.materials[0].alpha_mode = AlphaMode::kMask; });
  expect_new("texture", [](Scene& s) { s.materials[0].base_color_texture.image = 0; });
  expect_new("other texture", [](Scene& s) { s.materials[0].normal_texture.image = 0; });
  expect_new("transmission", [](Scene& s) { s.materials[0].transmission = 0.1f; });
  expect_new("absorption", [](Scene& s) { s.materials[0].attenuation_distance = 0.1f; });
  expect_new("coat", [](Scene& s) { s.materials[0].clearcoat = 0.1f; });
  expect_new("texel", [](Scene& s) { s.images[0].rgba[0] = 9; });
  expect_new("light", [](Scene& s) { s.lights[0].intensity.z = 2; });
  expect_new("light's kind", [](Scene& s) { s.lights[0].kind = LightKind::kDirectional; });
  expect_new("environment", [](Scene& s) { s.environment.radiance[0].x = 0.6f; });
  expect_new("environment's rotation", [](Scene& s) { s.environment.rotation = 1; });
  expect_new("background", [](Scene& s) { s.background_is_environment = false; });
  expect_new("lens", [](Scene& s) { s.camera.yfov = 0.5f; });
  expect_new("camera's node", [](Scene& s) { s.nodes[0].translation.x = 1; });
  expect_new("object's node", [](Scene& s) { s.nodes[2].translation.x = 1; });
  expect_new("clamp", [](Scene& s) { s.settings.max_radiance = 1; });
  expect_new("caustics", [](Scene& s) { s.settings.caustics = true; });
  for (int option = 0; option < 7; ++option) {
    TraceOptions o;
    if (option == 0) o.width = 10;
    if (option == 1) o.height = 10;
    if (option == 2) o.samples_per_pixel = 10;
    if (option == 3) o.seed = 10;
    if (option == 4) o.layers = false;
    if (option == 5) o.noise_db = 40;
    if (option == 6) o.views = 4;
    keys.insert(frame_key_of(small_scene(), o).hex());
    EXPECT_EQ(keys.size(), ++expected) << "option " << option;
  }
}

// Object 2 with two morph targets that axis 0 drives, on a joint at node 3.
Scene deforming_scene(const std::function<void(Deformation&)>& change = {}) {
  Scene scene = small_scene();
  scene.axes.push_back({"shape", {AxisKind::kLinear, 3}, 1, {}});
  MeshPrimitive primitive;
  primitive.vertices = scene.objects[2].geometry;
  primitive.targets.resize(2);
  primitive.targets[0].positions.assign(3, {0, 0, 1});
  primitive.influences.assign(3, {0, 1});
  primitive.influences_per_vertex = 1;
  primitive.materials = {0};
  Deformation deformation{{primitive}, {0, 0}, {{3, glm::mat4(1)}}};
  if (change) change(deformation);
  scene.objects[2].deformation = std::make_shared<Deformation>(deformation);
  scene.objects[2].node = 2;
  scene.weight_tracks.push_back({2, 0, Interpolation::kLinear, {0, 1}, {0, 0, 1, 1}});
  return scene;
}

TEST(Key, ChangesWithWhateverAShapeDependsOn) {
  std::set<std::string> keys = {frame_key_of(small_scene()).hex(), frame_key_of(deforming_scene()).hex()};
  size_t expected = 2;
  const auto expect_new = [&](const char* what, const Scene& scene, const Position& position = {}) {
    keys.insert(frame_key_of(scene, {}, position).hex());
    EXPECT_EQ(keys.size(), ++expected) << what;
  };
  const auto expect_new_with = [&](const char* what, const std::function<void(Deformation&)>& change) {
    expect_new(what, deforming_scene(change));
  };
  expect_new("weights of the pose", deforming_scene(), {0.5f});
  expect_new("weights at the end", deforming_scene(), {1});
  Scene moved = deforming_scene();
  moved.nodes[3].translation.y = 1;
  expect_new("joint's node", moved);
  expect_new_with("inverse bind matrix", [](Deformation& d) { d.joints[0].node_from_bind[3].x = 1; });
  expect_new_with("vertex", [](Deformation& d) { d.primitives[0].vertices.positions[0].x = 1e-6f; });
  expect_new_with("kind of primitive", [](Deformation& d) { d.primitives[0].parts = PrimitiveParts::kPoints; });
  expect_new_with("displacement", [](Deformation& d) { d.primitives[0].targets[0].positions[0].z = 2; });
  expect_new_with("displacement of the second",
                  [](Deformation& d) { std::swap(d.primitives[0].targets[0], d.primitives[0].targets[1]); });
  expect_new_with("displacement of a normal", [](Deformation& d) { d.primitives[0].targets[0].normals.assign(3, {1, 0, 0}); });
  expect_new_with("displacement of a tangent", [](Deformation& d) { d.primitives[0].targets[0].tangents.assign(3, {1, 0, 0}); });
  expect_new_with("influence", [](Deformation& d) { d.primitives[0].influences[1].weight = 0; });
  expect_new_with("material", [](Deformation& d) { d.primitives[0].materials = {-1}; });
  expect_new_with("normal map's coordinates", [](Deformation& d) { d.primitives[0].tangent_texcoord = 1; });
  expect_new_with("normal map's transform", [](Deformation& d) { d.primitives[0].tangent_transform[2].x = 1; });
}

TEST(Key, StaysWhereNothingThatIsSeenChanges) {
  const StoreKey key = frame_key_of(small_scene());
  const auto expect_same = [&](const char* what, const std::function<void(Scene&)>& change) {
    Scene scene = small_scene();
    change(scene);
    EXPECT_EQ(frame_key_of(scene), key) << what;
  };
  expect_same("names",
              [](Scene& s) { s.name = s.objects[0].name = s.materials[0].name = s.images[0].name = s.lights[0].name = "other"; });
  expect_same("target settings", [](Scene& s) {
    s.settings.profile = "other";
    s.settings.storage = "9:1";
    s.settings.exposure = 2;
  });
  expect_same("representation", [](Scene& s) { s.objects[0].representation = "mirror"; });
  expect_same("samples of an axis", [](Scene& s) { s.axes.push_back({"view", {AxisKind::kLinear, 9}, 1, {}}); });
  expect_same("file", [](Scene& s) { s.file = "elsewhere"; });
}

// Stable across runs, machines and releases: whoever changes what goes into keys must mean it.
TEST(Key, HasTheValueThatItAlwaysHad) {
  KeyBuilder key;
  key.text("vitrine");
  key.number(-0.0);
  key.integer(-1);
  key.bytes("ab", 2);
  KeyBuilder again;
  again.text("vitrine");
  again.number(0.0);
  again.integer(-1);
  again.bytes("ab", 2);
  EXPECT_EQ(key.finish(), again.finish());
  EXPECT_EQ(key.finish().hex(), "b98d774be1d89801a05fde44a4c6b77c");
}

TEST(Key, AppendsDoNotRunIntoEachOther) {
  KeyBuilder a, b, c;
  a.text("ab");
  a.text("c");
  b.text("a");
  b.text("bc");
  c.bytes("ab", 2);
  c.bytes("c", 1);
  EXPECT_NE(a.finish(), b.finish());
  EXPECT_NE(a.finish(), c.finish());
  const KeyBuilder copy(a);
  a.integer(1);
  EXPECT_NE(a.finish(), copy.finish());
}

}  // namespace
}  // namespace vitrine
