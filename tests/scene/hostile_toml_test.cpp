// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// scene.toml files with mistakes: each gets one line with the file, the key and what to do.
#include <gtest/gtest.h>

#include "tests/scene/scene_files.h"

namespace vitrine {
namespace {

using test::Folder;
using test::Model;

struct Mistake {
  const char* toml;
  const char* error;
};

const std::string kModel = "scene = \"model.glb\"\n";

// After the line that names the model.
const Mistake kMistakes[] = {
    {"resolutoin = [640, 480]\n", "scene.toml: there is no key \"resolutoin\" here: did you mean \"resolution\"?"},
    {"resolution = [0, 480]\n", "scene.toml: \"resolution\" is 0: it must lie between 1 and 8192"},
    {"resolution = [640]\n", "\"resolution\" is not a list of 2 numbers"},
    {"resolution = [640.5, 480]\n", "\"resolution\" is not whole"},
    {"resolution = \"large\"\n", "\"resolution\" is not a list of 2 numbers"},
    {"samples_per_pixel = -1\n", "\"samples_per_pixel\" is -1"},
    {"samples_per_pixel = nan\n", "\"samples_per_pixel\" is nan"},
    {"noise = 5\n", "\"noise\" is 5"},
    {"caustics = 1\n", "\"caustics\""},
    {"[target]\nbetween = 1\n", "\"between\""},
    {"exposure = inf\n", "\"exposure\" is inf"},
    {"environment = [1, 2]\n", "\"environment\" is not a list of 3 numbers"},
    {"environment = [1, -2, 1]\n", "\"environment\" is -2"},
    {"environment = \"nowhere.exr\"\n", "nowhere.exr: there is no such file"},
    {"environment = \"scene.toml\"\n", "this is neither an OpenEXR nor a Radiance HDR picture"},
    {"background = \"sky\"\nenvironment = [1,1,1]\n", "\"background\" is \"sky\": write \"environment\" or [r, g, b]"},
    {"background = \"environment\"\n", "\"background\" shows an environment, but there is none"},
    {"camera = \"cam\"\n", "there is no camera \"cam\": the model has none"},
    {"[axis]\nname = \"a\"\n", "\"axis\" is not a list of tables: write [[axis]]"},
    {"[[axis]]\nsamples = 4\n", "scene.toml: axis 1: the axis has no name"},
    {"[[axis]]\nname = \"a b\"\nanimation = \"x\"\nsamples = 4\n", "the name \"a b\" cannot be used"},
    {"[[axis]]\nname = \"frame\"\nanimation = \"x\"\nsamples = 4\n", "the name \"frame\" cannot be used"},
    {"[[axis]]\nname = \"a\"\nsamples = 4\n",
     "the axis drives nothing: give it exactly one of animation, orbit, variants, lights, lamp"},
    {"[[axis]]\nname = \"a\"\nanimation = \"x\"\norbit = {}\nsamples = 4\n", "the axis drives two things"},
    {"[[axis]]\nname = \"a\"\nanimation = \"x\"\nsamples = 4\n", "there is no animation \"x\": the file has none"},
    {"[[axis]]\nname = \"a\"\norbit = {}\n", "the axis has no \"samples\""},
    {"[[axis]]\nname = \"a\"\norbit = {}\nsamples = 0\n", "\"samples\" is 0"},
    {"[[axis]]\nname = \"a\"\norbit = {}\nsamples = 5000\n", "\"samples\" is 5000"},
    {"[[axis]]\nname = \"a\"\norbit = {}\nsamples = 4\nkind = \"circular\"\n", "there is no kind \"circular\""},
    {"[[axis]]\nname = \"a\"\norbit = { radius = 0 }\nsamples = 4\n", "scene.toml: axis 1: orbit: \"radius\" is 0"},
    {"[[axis]]\nname = \"a\"\norbit = { raduis = 1 }\nsamples = 4\n",
     "there is no key \"raduis\" here: did you mean \"radius\"?"},
    {"[[axis]]\nname = \"a\"\norbit = {}\nsamples = 4\nmax_speed = 0\n", "\"max_speed\" is 0"},
    {"[[axis]]\nname = \"a\"\nvariants = [\"red\"]\n", "there is no material variant \"red\": the file has none"},
    {"[[axis]]\nname = \"a\"\nvariants = []\n", "a switch of 0 values"},
    {"[[axis]]\nname = \"a\"\nvariants = [\"red\"]\nkind = \"linear\"\n", "a switch has nothing between its values"},
    {"[[axis]]\nname = \"a\"\nlights = [[\"lamp\"], []]\n", "there is no node \"lamp\": did you mean \"thing\"?"},
    {"[[axis]]\nname = \"a\"\nlights = [[\"thing\"], []]\n", "the node \"thing\" emits nothing"},
    {"[[axis]]\nname = \"a\"\nlights = [\"thing\"]\n", "\"lights\" is not a list of lists of node names"},
    {"[[axis]]\nname = \"a\"\norbit = {}\nsamples = 2\n[[axis]]\nname = \"a\"\norbit = {}\nsamples = 2\n",
     "two axes are named \"a\""},
    {"[[axis]]\nname = \"a\"\norbit = {}\nsamples = 2\n[[axis]]\nname = \"b\"\norbit = {}\nsamples = 2\n",
     "there is an orbit already"},
    {"[[axis]]\nname = \"a\"\norbit = {}\nsamples = 4096\n[[axis]]\nname = \"b\"\nlamp = {}\nsamples = 4096\n",
     "the grid has 16777216 samples"},
    {"[[object]]\nnode = \"thong\"\n", "scene.toml: object 1: there is no object \"thong\": did you mean \"thing\"?"},
    {"[[object]]\nnode = \"thing\"\nrepresentation = \"lightfield\"\n",
     "the representation \"lightfield\" does not exist in this version: write \"texture\""},
    {"[[object]]\nrepresentation = \"texture\"\n", "the entry names no node"},
    {"[target]\nstorage = \"small\"\n", "scene.toml: target: \"storage\" is \"small\""},
    {"[target]\nexposure = 2\n[[axis]]\nname = 3\n", "\"name\" is not a string in quotes"},
    {"exposure = 1\n[target]\nexposure = 2\n", "\"exposure\" stands twice"},
    {"x = \n", "scene.toml: line 2: "},
    {"x = 1\nx = 2\n", "scene.toml: line 3: "},
    {"\"\\u000a\\u001b[31m\" = 1\n", "there is no key \"??[31m\" here"},
};

TEST(HostileToml, EveryMistakeGetsOneLineWithFileKeyAndRemedy) {
  for (const Mistake& mistake : kMistakes) {
    SCOPED_TRACE(mistake.toml);
    const Folder folder;
    const std::string error = test::error_of([&] { test::load(folder, Model::triangle(), mistake.toml); });
    EXPECT_NE(error.find(mistake.error), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    EXPECT_EQ(error.rfind(folder.path().string(), 0), 0u) << error;
  }
}

TEST(HostileToml, FiveAxesAreRefused) {
  std::string toml;
  for (int a = 0; a < 5; ++a) toml += "[[axis]]\nname = \"a" + std::to_string(a) + "\"\nlamp = {}\nsamples = 2\n";
  const Folder folder;
  const std::string error = test::error_of([&] { test::load(folder, Model::triangle(), toml); });
  EXPECT_NE(error.find("there are 5 axes: leave 4 at most"), std::string::npos) << error;
}

TEST(HostileToml, SceneMustBeNamedAndBeThere) {
  const Folder folder;
  EXPECT_NE(test::error_of([&] {
              load_scene(folder.path());
            }).find("the folder holds no scene.toml: make a scene with: vitrine new DIR"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] { load_scene(folder.path() / "none"); }).find("there is no such scene"), std::string::npos);
  folder.write("scene.toml", "");
  EXPECT_NE(test::error_of([&] { load_scene(folder.path()); }).find("it does not name the model: write scene = \"model.glb\""),
            std::string::npos);
  folder.write("scene.toml", "scene = \"gone.glb\"\n");
  EXPECT_NE(test::error_of([&] { load_scene(folder.path()); }).find("gone.glb: there is no such file"), std::string::npos);
  folder.write("deep.toml", "x = " + std::string(100000, '['));
  const std::string deep = test::error_of([&] { load_scene(folder.path() / "deep.toml"); });
  EXPECT_NE(deep.find("deep.toml: line 1: "), std::string::npos) << deep;
  EXPECT_EQ(deep.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace vitrine
