// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/frames/sealed_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <random>

#include "host/base/error.h"

namespace vitrine {
namespace {

struct Seal {
  char magic[8];
  uint64_t size, hash;
};
static_assert(sizeof(Seal) == 24);
constexpr char kMagic[8] = {'V', 'I', 'T', 'R', 'S', 'E', 'A', 'L'};

Seal seal_of(const std::string& content, size_t size) {
  Seal seal{{}, size, XXH3_64bits(content.data(), size)};
  std::memcpy(seal.magic, kMagic, sizeof kMagic);
  return seal;
}

// A file descriptor that closes itself.
struct Descriptor {
  int fd;
  explicit Descriptor(int descriptor) : fd(descriptor) {}
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  throw InputError(path.string(), fmt::format("cannot be written ({})", std::strerror(error)),
                   "free space there or choose another folder for the work");
}

// Unique among processes and machines that share the folder.
std::filesystem::path fresh_name(const std::filesystem::path& scratch) {
  static std::atomic<uint64_t> counter{0};
  static const uint64_t process = (static_cast<uint64_t>(std::random_device{}()) << 32) | std::random_device{}();
  return scratch / fmt::format("{:016x}-{}-{}", process, static_cast<long>(::getpid()), counter.fetch_add(1));
}

bool write_all(int fd, const std::string& data) {
  for (size_t done = 0; done < data.size();) {
    const ssize_t n = ::write(fd, data.data() + done, data.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<size_t>(n);
  }
  return true;
}

bool read_all(int fd, char* data, size_t size, off_t offset) {
  for (size_t done = 0; done < size;) {
    const ssize_t n = ::pread(fd, data + done, size - done, offset + static_cast<off_t>(done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<size_t>(n);
  }
  return true;
}

// Size of the content of an open file whose seal has the right form.
std::optional<size_t> sealed_size(int fd, Seal& seal) {
  struct stat status {};
  if (::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size < static_cast<off_t>(sizeof seal)) return {};
  const auto size = static_cast<uint64_t>(status.st_size) - sizeof seal;
  if (!read_all(fd, reinterpret_cast<char*>(&seal), sizeof seal, static_cast<off_t>(size))) return {};
  if (std::memcmp(seal.magic, kMagic, sizeof kMagic) != 0 || seal.size != size) return {};
  return size;
}

}  // namespace

void write_sealed(const std::filesystem::path& path, const std::filesystem::path& scratch, std::string content) {
  const Seal seal = seal_of(content, content.size());
  content.append(reinterpret_cast<const char*>(&seal), sizeof seal);
  const std::filesystem::path temporary = fresh_name(scratch);
  bool written = false;
  {
    const Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file.fd < 0) fail(temporary, errno);
    written = write_all(file.fd, content) && ::fsync(file.fd) == 0;
  }
  int error = written ? 0 : errno;
  std::error_code ignored;
  if (written) {
    std::filesystem::create_directories(path.parent_path(), ignored);
    if (::rename(temporary.c_str(), path.c_str()) == 0) return;
    error = errno;
  }
  std::filesystem::remove(temporary, ignored);
  fail(path, error);
}

std::optional<std::string> read_sealed(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.fd < 0) return {};
  Seal seal;
  const auto size = sealed_size(file.fd, seal);
  if (!size) return {};
  std::string content(*size, '\0');
  if (!read_all(file.fd, content.data(), *size, 0)) return {};
  if (seal_of(content, *size).hash != seal.hash) {
    ::unlink(path.c_str());  // has_sealed does not read it all: gone, it is made again
    return {};
  }
  return content;
}

bool has_sealed(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  Seal seal;
  return file.fd >= 0 && sealed_size(file.fd, seal).has_value();
}

void clean_scratch(const std::filesystem::path& scratch) {
  std::error_code error;
  const auto limit = std::filesystem::file_time_type::clock::now() - std::chrono::hours(24);
  for (const auto& entry : std::filesystem::directory_iterator(scratch, error)) {
    const auto time = entry.last_write_time(error);
    if (!error && time < limit) std::filesystem::remove(entry.path(), error);
  }
}

}  // namespace vitrine
