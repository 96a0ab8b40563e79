// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// vitrine-play as a user runs it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "tests/target/played_image.h"

namespace vitrine {
namespace {

namespace fs = std::filesystem;
const std::string kPlay = std::string(VITRINE_BIN_DIR) + "/vitrine-play";

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Ran {
  int code = -1;
  std::string out, err;
};

class Play : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    char pattern[] = "/tmp/vitrine_play_XXXXXX";
    folder = ::mkdtemp(pattern);
    const test::PlayedImage image({});
    write("image.vit", {reinterpret_cast<const char*>(image.bytes().data()), image.bytes().size()});
    write("path.csv", "frame,view,lamp\n0,0,0\n60,0.9,0.4\n");
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }
  static void write(const std::string& name, const std::string& content) {
    std::ofstream(folder / name, std::ios::binary) << content;
  }
  static Ran run(const std::string& arguments) {
    const std::string command =
        "cd " + folder.string() + " && env -u DISPLAY -u WAYLAND_DISPLAY " + kPlay + " " + arguments + " >out.txt 2>err.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(folder / "out.txt"), read_text(folder / "err.txt")};
  }
  static void expect_error(const std::string& arguments, int code, const std::string& begins) {
    const Ran ran = run(arguments);
    EXPECT_EQ(ran.code, code) << arguments;
    EXPECT_EQ(ran.out, "") << arguments;
    EXPECT_TRUE(ran.err.starts_with("vitrine-play: " + begins)) << arguments << "\n" << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
  static fs::path folder;
};
fs::path Play::folder;

TEST_F(Play, StatsAreOneJsonObjectWithThePromisedKeys) {
  const Ran ran = run("image.vit --backend null --script path.csv --stats --json");
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json.at("frames"), 61);
  EXPECT_EQ(json.at("late_nodes"), 0);
  EXPECT_EQ(json.at("overruns"), 0);
  EXPECT_EQ(json.at("allocations"), 0);
  EXPECT_GT(json.at("units").at("max"), 0);
  EXPECT_GT(json.at("units").at("mean"), 0);
  EXPECT_EQ(json.at("units").at("budget"), 1u << 30);
  EXPECT_GT(json.at("upload_bytes").at("max"), 0);
  EXPECT_GT(json.at("cache_bytes"), 0);
  EXPECT_LE(json.at("frame_ms").at("p50"), json.at("frame_ms").at("p99"));
  EXPECT_LE(json.at("frame_ms").at("p99"), json.at("frame_ms").at("max"));
  EXPECT_EQ(ran.err, "");
}

TEST_F(Play, AStillIsTheSameHoweverItsPositionIsNamed) {
  ASSERT_EQ(run("image.vit --at view=#15,lamp=0.25 --out a.png").code, 0);
  ASSERT_EQ(run("image.vit --at lamp=#2,view=1 --out b.png --backend osmesa").code, 0);
  ASSERT_EQ(run("image.vit --out c.png").code, 0);
  const std::string a = read_text(folder / "a.png");
  EXPECT_TRUE(a.starts_with("\x89PNG"));
  EXPECT_EQ(a, read_text(folder / "b.png"));
  EXPECT_NE(a, read_text(folder / "c.png"));
}

TEST_F(Play, AScriptWritesNumberedFrames) {
  const Ran ran = run("image.vit --script path.csv --frames 3 --out frames --quiet");
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out + ran.err, "");
  EXPECT_TRUE(fs::exists(folder / "frames/frame_00000.png"));
  EXPECT_TRUE(fs::exists(folder / "frames/frame_00002.png"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "frames"), {}), 3);
}

TEST_F(Play, MistakesGetOneLineThatNamesTheFileOrTheOption) {
  write("empty.vit", "");
  write("noise.vit", std::string(5000, 'x'));
  write("bad.csv", "frame,door\n0,1\n");
  const std::string good = read_text(folder / "image.vit");
  write("cut.vit", good.substr(0, good.size() / 2));
  std::string flipped = good;
  flipped[good.size() / 2] ^= 4;
  write("flipped.vit", flipped);
  expect_error("absent.vit", 1, "absent.vit: no such file: ");
  expect_error(".", 1, ".: it is a folder: ");
  for (const char* name : {"empty.vit", "noise.vit", "cut.vit", "flipped.vit"})
    expect_error(std::string(name) + " --backend null", 1, std::string(name) + ": ");
  expect_error("image.vit --backend null --script bad.csv", 1, "bad.csv: ");
  expect_error("image.vit --backend null --script absent.csv", 1, "absent.csv: no such file: ");
  expect_error("image.vit --out no/such/folder/a.png", 1, "no/such/folder/a.png: ");
  expect_error("", 2, "");
  expect_error("image.vit --nonsense", 2, "");
  expect_error("image.vit --backend vulkan", 2, "");
  expect_error("image.vit --backend null --at door=1", 2, "--at: ");
  expect_error("image.vit --backend null --at view=2", 2, "--at: ");
  expect_error("image.vit --backend null --at view=#16", 2, "--at: ");
  expect_error("image.vit --backend null --at view", 2, "--at: ");
  expect_error("image.vit --backend null --frames 0", 2, "--frames: ");
}

TEST_F(Play, HelpShowsAnExampleAndVersionAVersion) {
  const Ran help = run("--help"), version = run("--version");
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("vitrine-play table.vit --at view=0.5"), std::string::npos);
  EXPECT_EQ(version.code, 0);
  EXPECT_TRUE(version.out.starts_with("vitrine-play ")) << version.out;
}

// Whether the process has come so far as to install its handler, however slow the machine is.
bool catches_sigterm(pid_t process) {
  const std::string status = read_text("/proc/" + std::to_string(process) + "/status");
  const size_t at = status.find("SigCgt:");
  return at != std::string::npos && (std::stoull(status.substr(at + 7), nullptr, 16) >> (SIGTERM - 1) & 1);
}

TEST_F(Play, ASignalEndsItCleanlyWithItsStats) {
  const pid_t child = ::fork();
  if (child == 0) {
    (void)!std::freopen((folder / "signal.txt").c_str(), "w", stdout);
    ::execl(kPlay.c_str(), kPlay.c_str(), (folder / "image.vit").c_str(), "--backend", "null", "--frames", "1000000000", "--json",
            nullptr);
    ::_exit(127);
  }
  for (int i = 0; i < 3000 && !catches_sigterm(child); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ::kill(child, SIGTERM);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_GE(nlohmann::json::parse(read_text(folder / "signal.txt")).at("frames"), 0);
}

TEST_F(Play, LinksNothingOfTheCompiler) {
  ASSERT_EQ(std::system(("readelf -d " + kPlay + " > " + (folder / "needed.txt").string()).c_str()), 0);
  const std::string needed = read_text(folder / "needed.txt");
  ASSERT_NE(needed.find("(NEEDED)"), std::string::npos);
  for (const char* library : {"embree", "OpenEXR", "Imath", "tinygltf", "toml", "tbb", "webp", "libGL.so"})
    EXPECT_EQ(needed.find(library), std::string::npos) << library;
  std::printf("vitrine-play: %ju bytes\n", static_cast<uintmax_t>(fs::file_size(kPlay)));
  RecordProperty("vitrine_play_bytes", std::to_string(fs::file_size(kPlay)));
}

}  // namespace
}  // namespace vitrine
