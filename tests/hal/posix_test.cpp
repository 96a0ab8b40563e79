// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "hal/backends.h"
#include "hal/storage.h"

namespace vitrine::hal {
namespace {

class Storage : public ::testing::Test {
 protected:
  void SetUp() override {
    char pattern[] = "/tmp/vitrine_storage_XXXXXX";
    folder = ::mkdtemp(pattern);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::string path(const char* name) const { return folder + "/" + name; }
  static std::span<const std::byte> bytes(const std::string& text) { return std::as_bytes(std::span(text)); }
  std::string folder;
};

TEST_F(Storage, WhatWasWrittenIsMapped) {
  ASSERT_TRUE(write_file_atomically(path("a").c_str(), bytes("first")).ok());
  ASSERT_TRUE(write_file_atomically(path("a").c_str(), bytes("second one")).ok());
  auto file = MappedFile::open(path("a").c_str());
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(file.value().bytes().data()), file.value().bytes().size()), "second one");
  EXPECT_EQ(reinterpret_cast<uintptr_t>(file.value().bytes().data()) % 64, 0u);
  const MappedFile moved = std::move(file.value());
  EXPECT_EQ(moved.bytes().size(), 10u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1) << "something was left beside it";
}

TEST_F(Storage, AMappingKeepsItsBytesWhenTheFileIsReplaced) {
  ASSERT_TRUE(write_file_atomically(path("a").c_str(), bytes("old")).ok());
  auto file = MappedFile::open(path("a").c_str());
  ASSERT_TRUE(write_file_atomically(path("a").c_str(), bytes("new")).ok());
  EXPECT_EQ(static_cast<char>(file.value().bytes()[0]), 'o');
}

TEST_F(Storage, AnEmptyFileMapsToNothing) {
  ASSERT_TRUE(write_file_atomically(path("empty").c_str(), {}).ok());
  const auto file = MappedFile::open(path("empty").c_str());
  ASSERT_TRUE(file.ok());
  EXPECT_TRUE(file.value().bytes().empty());
}

TEST_F(Storage, FoldersPipesAndAbsentFilesAreErrorsAndDoNotHang) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(MappedFile::open(path("pipe").c_str()).status().code(), StatusCode::kIo);
  EXPECT_EQ(MappedFile::open(folder.c_str()).status().code(), StatusCode::kIo);
  EXPECT_STREQ(MappedFile::open(path("absent").c_str()).status().detail(), "no such file");
  EXPECT_EQ(write_file_atomically(path("no/such/folder").c_str(), bytes("x")).code(), StatusCode::kIo);
}

TEST_F(Storage, AFailedWriteLeavesTheOldFileAlone) {
  std::filesystem::create_directory(path("taken"));
  EXPECT_FALSE(write_file_atomically(path("taken").c_str(), bytes("x")).ok());
  EXPECT_TRUE(std::filesystem::is_directory(path("taken")));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST_F(Storage, NewFilesGetTheUsualPermissionsAndOldOnesKeepTheirs) {
  const mode_t mask = ::umask(022);
  ASSERT_TRUE(write_file_atomically(path("a").c_str(), bytes("x")).ok());
  ::umask(mask);
  struct stat status {};
  ASSERT_EQ(::stat(path("a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0644u);
  ::chmod(path("a").c_str(), 0640);
  ASSERT_TRUE(write_file_atomically(path("a").c_str(), bytes("y")).ok());
  ASSERT_EQ(::stat(path("a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST(Clock, TheVirtualClockMovesOnlyWhenAskedTo) {
  const auto clock = create_virtual_clock();
  const int64_t start = clock->now_ns();
  clock->sleep_until(start + 5'000'000'000);
  EXPECT_EQ(clock->now_ns(), start + 5'000'000'000);
  clock->sleep_until(start);
  EXPECT_EQ(clock->now_ns(), start + 5'000'000'000);
}

TEST(Clock, ThePosixClockSleepsUntilTheTimeAndNotForThePast) {
  const auto clock = create_posix_clock();
  const int64_t start = clock->now_ns();
  clock->sleep_until(start - 1'000'000'000);
  clock->sleep_until(start + 3'000'000);
  EXPECT_GE(clock->now_ns(), start + 3'000'000);
}

}  // namespace
}  // namespace vitrine::hal
