// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The dependency rules: a room includes only rooms that its vitrine_library() call names (or that those name in turn); target
// knows no window system, no GL, no operating system; formats knows nothing else.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
const fs::path kRoot = VITRINE_SOURCE_DIR;

std::string read(const fs::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

struct Room {
  std::string folder;
  std::set<std::string> uses;  // libraries
};

// Library -> room, from every CMakeLists.txt.
std::map<std::string, Room> rooms() {
  std::map<std::string, Room> result;
  result["vitrine_hal"] = {"hal", {"vitrine_formats"}};  // an interface library
  const std::regex call(R"(vitrine_library\(([^)]*)\))");
  for (const char* top : {"formats", "hal", "target", "host"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      if (entry.path().filename() != "CMakeLists.txt") continue;
      const std::string text = read(entry.path());
      for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it) {
        std::istringstream words((*it)[1]);
        std::string name, word;
        bool in_uses = false;
        Room room{fs::relative(entry.path().parent_path(), kRoot).string(), {}};
        words >> name;
        while (words >> word) {
          if (word == "USES" || word == "LINKS" || word == "TARGET_SIDE") in_uses = word == "USES";
          else if (in_uses) room.uses.insert(word);
        }
        result[name] = room;
      }
    }
  }
  return result;
}

void add_reachable(const std::map<std::string, Room>& all, const std::string& library, std::set<std::string>& folders) {
  const auto it = all.find(library);
  if (it == all.end() || !folders.insert(it->second.folder).second) return;
  for (const std::string& used : it->second.uses) add_reachable(all, used, folders);
}

std::vector<fs::path> sources(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp") files.push_back(entry.path());
  return files;
}

std::vector<std::string> matches(const fs::path& file, const std::regex& pattern) {
  std::vector<std::string> found;
  std::ifstream in(file);
  std::smatch match;
  for (std::string line; std::getline(in, line);)
    if (std::regex_search(line, match, pattern)) found.push_back(match[1]);
  return found;
}

TEST(Rooms, no_source_includes_a_room_that_its_library_does_not_name) {
  const auto all = rooms();
  ASSERT_GT(all.size(), 12u);
  const std::regex include(R"re(^\s*#\s*include\s*"((?:formats|hal|target|host|tools|tests)/[^"]*)")re");
  for (const auto& [library, room] : all) {
    std::set<std::string> allowed;
    add_reachable(all, library, allowed);
    if (allowed.count("target/decode") || allowed.count("target/draw")) allowed.insert("target");  // target/*.h: shared declarations
    if (room.folder.rfind("hal", 0) == 0) allowed.insert("hal");
    if (room.folder.rfind("target", 0) == 0) allowed.insert("target");
    for (const fs::path& file : sources(kRoot / room.folder))
      for (const std::string& included : matches(file, include))
        EXPECT_TRUE(allowed.count(fs::path(included).parent_path().string())) << file << " includes " << included << ", which " << library << " does not name";
  }
}

TEST(Rooms, target_and_formats_never_include_host_or_a_systems_headers) {
  const std::regex forbidden(R"re(#\s*include\s*(["<](?:host/|tools/|GL/|GLES|EGL/|SDL|libusb|unistd\.h|sys/|fcntl\.h|pthread\.h|windows\.h|hal/backends\.h)[^">]*))re");
  for (const char* folder : {"formats", "target", "target/decode", "target/draw"})
    for (const fs::path& file : sources(kRoot / folder)) EXPECT_TRUE(matches(file, forbidden).empty()) << file << " includes " << matches(file, forbidden)[0];
}

TEST(Rooms, target_and_formats_are_built_without_exceptions_and_rtti) {
  for (const char* folder : {"formats", "target", "target/decode", "target/draw"})
    EXPECT_NE(read(kRoot / folder / "CMakeLists.txt").find("TARGET_SIDE"), std::string::npos) << folder;
}

TEST(Rooms, every_source_carries_the_licence) {
  for (const char* top : {"formats", "hal", "target", "host", "tools", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      EXPECT_NE(read(entry.path()).substr(0, 120).find("SPDX-License-Identifier: Apache-2.0"), std::string::npos) << entry.path();
    }
  }
}

}  // namespace
