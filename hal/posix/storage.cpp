// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "hal/storage.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <utility>

namespace vitrine::hal {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }
  bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

Status io(const char* detail) { return {StatusCode::kIo, detail}; }

const char* why_not_opened() {
  switch (errno) {
    case ENOENT:
      return "no such file";
    case EACCES:
      return "no permission to read it";
    case EISDIR:
      return "it is a folder";
    default:
      return "cannot be opened";
  }
}

const char* why_not_written() {
  switch (errno) {
    case ENOENT:
      return "its folder does not exist";
    case EACCES:
    case EROFS:
      return "no permission to write there";
    case ENOSPC:
    case EDQUOT:
      return "the disk is full";
    default:
      return "cannot be written";
  }
}

bool write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return true;
}

// The rename itself must reach the disk before the caller may rely on it.
void sync_folder_of(const std::string& path) {
  const size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) ::fsync(fd.get());  // some file systems cannot: the rename is atomic all the same
}

// What a new file may be read and written by (mkstemp gives it to its owner alone).
mode_t usual_mode(const char* path) {
  struct stat existing {};
  if (::stat(path, &existing) == 0) return existing.st_mode & 07777;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

// Where a symbolic link leads, whether or not anything is there yet; other paths as they are.
std::string resolved(std::string path) {
  char target[4096];
  for (int links = 0; links < 16; ++links) {
    const ssize_t size = ::readlink(path.c_str(), target, sizeof target);
    if (size <= 0 || size == sizeof target) break;
    const size_t slash = path.rfind('/');
    const bool relative = target[0] != '/' && slash != std::string::npos;
    path = (relative ? path.substr(0, slash + 1) : "") + std::string(target, static_cast<size_t>(size));
  }
  return path;
}

// Renaming over it would put a file in the place of a device or a pipe.
bool is_something_else(const char* path) {
  struct stat existing {};
  return ::stat(path, &existing) == 0 && !S_ISREG(existing.st_mode);
}

}  // namespace

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

MappedFile::~MappedFile() {
  if (data_) ::munmap(const_cast<std::byte*>(data_), size_);
}

Result<MappedFile> MappedFile::open(const char* path) {
  const Descriptor fd(::open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // a FIFO must not hang us
  if (fd.get() < 0) return io(why_not_opened());
  struct stat status {};
  if (::fstat(fd.get(), &status) != 0) return io("cannot be examined");
  if (S_ISDIR(status.st_mode)) return io("it is a folder");
  if (!S_ISREG(status.st_mode)) return io("not a regular file");
  MappedFile file;
  if (status.st_size == 0) return file;
  void* data = ::mmap(nullptr, static_cast<size_t>(status.st_size), PROT_READ, MAP_PRIVATE, fd.get(), 0);
  if (data == MAP_FAILED) return io("cannot be mapped into memory");
  file.data_ = static_cast<const std::byte*>(data);
  file.size_ = static_cast<size_t>(status.st_size);
  return file;
}

Status write_file_atomically(const char* name, std::span<const std::byte> bytes) {
  if (is_something_else(name)) return io("it is not a regular file");
  const std::string target = resolved(name);
  const char* path = target.c_str();
  std::string beside = target + ".XXXXXX";
  Descriptor fd(::mkostemp(beside.data(), O_CLOEXEC));
  if (fd.get() < 0) return io(why_not_written());
  const bool written =
      write_all(fd.get(), bytes) && ::fchmod(fd.get(), usual_mode(path)) == 0 && ::fsync(fd.get()) == 0 && fd.close();
  if (written && std::rename(beside.c_str(), path) == 0) return sync_folder_of(path), Status{};
  const char* why = why_not_written();
  ::unlink(beside.c_str());
  return io(why);
}

}  // namespace vitrine::hal
