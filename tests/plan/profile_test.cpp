// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "host/base/error.h"
#include "host/plan/plan.h"

namespace vitrine {
namespace {

class ProfileFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("vitrine_profile_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& text) {
    const std::filesystem::path path = folder_ / "mine.toml";
    std::ofstream(path) << text;
    return path.string();
  }
  std::string message_of(const std::string& text) {
    try {
      load_profile(write(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::filesystem::path folder_;
};

TEST(Profile, BuiltInNamesAreKnown) {
  for (const char* name : {"osmesa-30", "kiosk-60", "board-60", "desktop-120"}) {
    const Profile profile = load_profile(name);
    EXPECT_EQ(profile.name, name);
    EXPECT_GT(profile.units_per_frame, 0u);
    EXPECT_GT(profile.cache_bytes, 0u);
    EXPECT_GT(profile.upload_bytes_per_frame, 0u);
    EXPECT_EQ(std::string(name).substr(std::string(name).find('-') + 1), std::to_string(profile.frames_per_second));
  }
}

TEST(Profile, AnUnknownNameIsAnsweredWithTheKnownOnes) {
  try {
    load_profile("kiosk-61");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("there is no profile \"kiosk-61\""), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("desktop-120"), std::string::npos);
  }
}

TEST(Profile, OnlyAGraphicsCardIsGivenManyTaps) {
  EXPECT_EQ(load_profile("desktop-120").filter, SurfaceFilter::kAnisotropic4);
  for (const char* name : {"osmesa-30", "kiosk-60", "board-60"})
    EXPECT_EQ(load_profile(name).filter, SurfaceFilter::kTrilinear) << name;
}

TEST_F(ProfileFile, EveryTextureFilterHasAName) {
  const std::string good = "units_per_frame = 1\nupload_bytes_per_frame = 1\ncache_bytes = 1\n";
  EXPECT_EQ(load_profile(write(good)).filter, SurfaceFilter::kTrilinear);
  const std::pair<const char*, SurfaceFilter> filters[] = {{"bilinear", SurfaceFilter::kBilinear},
                                                           {"trilinear", SurfaceFilter::kTrilinear},
                                                           {"anisotropic2", SurfaceFilter::kAnisotropic2},
                                                           {"anisotropic4", SurfaceFilter::kAnisotropic4}};
  for (const auto& [name, filter] : filters)
    EXPECT_EQ(load_profile(write(good + "texture_filter = \"" + name + "\"\n")).filter, filter) << name;
  EXPECT_NE(message_of(good + "texture_filter = \"sharp\"\n").find("anisotropic2"), std::string::npos);
  EXPECT_NE(message_of(good + "texture_filter = 4\n").find("\"texture_filter\" is not a text"), std::string::npos);
}

TEST_F(ProfileFile, IsReadInFull) {
  const Profile profile = load_profile(write(
      "units_per_frame = 123\nupload_bytes_per_frame = 456\ncache_bytes = 789\nsupersampling = 3\nframes_per_second = 72\n"));
  EXPECT_EQ(profile.name, "mine");
  EXPECT_EQ(profile.units_per_frame, 123u);
  EXPECT_EQ(profile.upload_bytes_per_frame, 456u);
  EXPECT_EQ(profile.cache_bytes, 789u);
  EXPECT_EQ(profile.supersampling, 3);
  EXPECT_EQ(profile.frames_per_second, 72);
}

TEST_F(ProfileFile, MistakesAreNamed) {
  const std::string good = "units_per_frame = 1\nupload_bytes_per_frame = 1\ncache_bytes = 1\n";
  EXPECT_EQ(message_of(good), "");
  EXPECT_NE(message_of(good + "unit_per_frame = 2\n").find("unknown key \"unit_per_frame\""), std::string::npos);
  EXPECT_NE(message_of("units_per_frame = 1\ncache_bytes = 1\n").find("\"upload_bytes_per_frame\" is missing"),
            std::string::npos);
  EXPECT_NE(message_of(good + "supersampling = 9\n").find("\"supersampling\" is not a whole number from 1 to 4"),
            std::string::npos);
  EXPECT_NE(message_of(good + "supersampling = \"2\"\n").find("\"supersampling\""), std::string::npos);
  EXPECT_NE(message_of(good + "supersampling = 2.5\n").find("\"supersampling\""), std::string::npos);
  EXPECT_NE(message_of("units_per_frame = -1\nupload_bytes_per_frame = 1\ncache_bytes = 1\n").find("\"units_per_frame\""),
            std::string::npos);
  EXPECT_NE(message_of(good + "name = 3\n").find("\"name\" is not a text"), std::string::npos);
  EXPECT_NE(message_of(good + "oops\n").find("mine.toml:4"), std::string::npos);
}

TEST_F(ProfileFile, AFolderIsNoProfile) { EXPECT_THROW(load_profile(folder_.string()), InputError); }

}  // namespace
}  // namespace vitrine
