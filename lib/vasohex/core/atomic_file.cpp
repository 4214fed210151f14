#include "vasohex/core/atomic_file.h"

#include <cerrno>
#include <filesystem>
#include <random>
#include <system_error>

#include "vasohex/core/error.h"

namespace vasohex {

namespace fs = std::filesystem;

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
  std::error_code error;
  if (fs::is_symlink(path_, error)) {  // the file it points to is replaced, not the link
    const fs::path target = fs::weakly_canonical(path_, error);
    if (!error) {
      path_ = target.string();
    }
  }
  const fs::file_status status = fs::status(path_, error);
  if (fs::is_directory(status)) {
    fail("it is a folder; give the name of a file in it");
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    fail("it exists and is not a regular file; choose another name");
  }
  const fs::path folder = fs::path(path_).has_parent_path() ? fs::path(path_).parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    fail("there is no folder " + folder.string() + "; create it or choose another name");
  }
  std::random_device random;
  temporary_ = path_ + "." + std::to_string(random()) + ".part";
  errno = 0;
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) {
    const int cause = errno;
    temporary_.clear();
    fail(std::system_category().message(cause) + "; choose a folder you may write to");
  }
}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty()) {
    stream_.close();
    std::error_code ignored;
    fs::remove(temporary_, ignored);
  }
}

void AtomicFile::check() {
  if (!stream_) {
    fail(std::system_category().message(errno != 0 ? errno : EIO) + "; free some space or choose another folder");
  }
}

void AtomicFile::commit() {
  errno = 0;
  stream_.flush();
  check();
  stream_.close();
  check();
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) {
    fail(error.message() + "; choose another name");
  }
  temporary_.clear();
}

void AtomicFile::fail(const std::string& cause) {
  throw Error(ErrorCode::bad_input, "cannot write " + path_ + ": " + cause);
}

}  // namespace vasohex
