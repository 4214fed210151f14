#pragma once
/// \file Output files that are either complete or not there.

#include <fstream>
#include <string>

namespace vasohex {

/// Writes to a temporary name in the folder of `path`; commit() gives the file its name, replacing an older one.
/// Without commit() the temporary file is removed and an older file stays as it was.
class AtomicFile {
 public:
  /// Error bad_input if the file cannot be created, or `path` exists and is not a regular file.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Binary; a failed write shows at the next commit() or check().
  std::ostream& stream() { return stream_; }
  /// Error bad_input if a write has failed (disk full ..).
  void check();
  /// Error bad_input if a write has failed or the name cannot be given.
  void commit();

 private:
  [[noreturn]] void fail(const std::string& cause);

  std::string path_;
  std::string temporary_;
  std::ofstream stream_;
};

}  // namespace vasohex
