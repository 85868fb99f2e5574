// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

/// Message of the system for an error number, e.g. "No space left on device".
[[gnu::cold]] inline std::string system_reason(int code) {
  return std::generic_category().message(code);
}

/// Open file, closed by the destructor. A failed call throws FileError with `name` (the path given
/// by the user) and the system's reason.
class File {
 public:
  File(const std::string& path, int flags, std::string name)
      : name_(std::move(name)), descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0)
      fail((flags & O_ACCMODE) == O_RDONLY ? "cannot be opened for reading"
                                           : "cannot be opened for writing");
  }
  File(File&& other) noexcept
      : name_(std::move(other.name_)), descriptor_(std::exchange(other.descriptor_, -1)) {}
  File& operator=(File&& other) noexcept {
    std::swap(name_, other.name_), std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~File() {
    if (is_open()) ::close(descriptor_);
  }

  bool is_open() const { return descriptor_ >= 0; }
  const std::string& name() const { return name_; }

  std::uint64_t size() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) fail("cannot be read");
    if (S_ISDIR(status.st_mode)) fail("cannot be read", EISDIR);
    return static_cast<std::uint64_t>(status.st_size);
  }

  /// Appends all `bytes`.
  void write(const void* data, std::size_t bytes) {
    const char* from = static_cast<const char*>(data);
    while (bytes > 0) {
      const auto written = ::write(descriptor_, from, bytes);
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail("cannot be written");
      from += written, bytes -= static_cast<std::size_t>(written);
    }
  }

  /// Reads exactly `bytes` from `offset` on.
  void read_at(std::uint64_t offset, void* data, std::size_t bytes) const {
    char* to = static_cast<char*>(data);
    while (bytes > 0) {
      const auto got = ::pread(descriptor_, to, bytes, static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail("cannot be read");
      if (got == 0)
        throw FileError(text("file '", name_, "' ended at byte ", offset, " while it was read, ",
                             bytes, " bytes too early; another program shortened it"));
      to += got, offset += static_cast<std::uint64_t>(got), bytes -= static_cast<std::size_t>(got);
    }
  }

  /// False if another program has locked the file; the lock ends with the file or the program.
  bool lock() { return ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0; }

  void truncate(std::uint64_t bytes) {
    if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) fail("cannot be shortened");
  }

  /// Returns when everything written is on the disk.
  void flush_to_disk() {
    if (::fsync(descriptor_) != 0) fail("cannot be flushed to the disk");
  }

  void close() {
    if (::close(std::exchange(descriptor_, -1)) != 0) fail("cannot be closed");
  }

 private:
  [[noreturn]] void fail(std::string_view what, int code = errno) const {
    throw FileError(text("file '", name_, "' ", what, ": ", system_reason(code)));
  }

  std::string name_;
  int descriptor_;
};

/// Refuses a file larger than this machine's memory (it may be sparse) before reading it.
inline void check_size(std::uint64_t bytes, const std::string& name) {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page <= 0) return;  // unknown
  const auto memory = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page);
  if (bytes > memory)
    throw FileError(text("file '", name, "' has ", bytes, " bytes, more than this machine's ",
                         memory, " bytes of memory; it is damaged, or too large to be read here"));
}

/// Reads from a file by `read(file)`; lack of memory becomes a FileError too.
template <class Read>
auto read_from(const std::string& path, const Read& read) {
  const File file(path, O_RDONLY, path);
  const std::uint64_t bytes = file.size();
  check_size(bytes, path);
  try {
    return read(file, bytes);
  } catch (const std::bad_alloc&) {
    throw FileError(text("file '", path, "' of ", bytes, " bytes exceeds the memory"));
  }
}

/// Reads a file in blocks and calls accept(all so far) after each; a file refused early needs
/// little memory.
template <class Accept>
std::string read_blocks(const File& file, std::uint64_t bytes, const Accept& accept) {
  constexpr std::uint64_t first = 1 << 16;
  std::string content;
  for (std::uint64_t at = 0; at < bytes;) {
    const std::uint64_t block = std::min(bytes - at, std::max(first, at));  // doubles
    content.resize(at + block);
    file.read_at(at, content.data() + at, block);
    accept(std::string_view(content).substr(at));
    at += block;
  }
  return content;
}

inline std::string read_file(const std::string& path) {
  return read_from(path, [](const File& file, std::uint64_t bytes) {
    return read_blocks(file, bytes, [](std::string_view) {});
  });
}

inline constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";  // a byte-order mark

/// Content of a text file without a byte-order mark, which some editors add.
/// Errors: FileError for one with zero bytes: binary, or text in UTF-16.
inline std::string read_text(const std::string& path) {
  std::string content = read_from(path, [&](const File& file, std::uint64_t bytes) {
    return read_blocks(file, bytes, [&](std::string_view block) {
      if (block.find('\0') == std::string_view::npos) return;
      const bool wide = block.starts_with("\xFF\xFE") || block.starts_with("\xFE\xFF");
      throw FileError(
          text("file '", path, "' ",
               wide ? "is text in UTF-16; save it as UTF-8" : "is not text: it has zero bytes"));
    });
  });
  if (content.starts_with(utf8_mark)) content.erase(0, utf8_mark.size());
  return content;
}

inline bool file_exists(const std::string& path) { return ::access(path.c_str(), F_OK) == 0; }

/// Makes a rename in the folder of `path` survive a power failure.
inline void flush_folder_of(const std::string& path) {
  const auto slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int code = descriptor < 0 || ::fsync(descriptor) != 0 ? errno : 0;
  if (descriptor >= 0) ::close(descriptor);
  // EINVAL: this file system (some network ones) has no fsync for folders; nothing more can be
  // done.
  if (code != 0 && code != EINVAL)
    throw FileError(text("file '", path,
                         "' is written, but its folder cannot be flushed: ", system_reason(code)));
}

/// View of a caller's array that is read later, when the file is written.
template <class Values>
auto lasting_view(Values&& values) {
  static_assert(std::is_lvalue_reference_v<Values> ||
                    std::ranges::enable_borrowed_range<std::remove_cvref_t<Values>>,
                "the array is read when the file is written: pass a named array or a span of one, "
                "not a temporary");
  using Value = std::remove_cvref_t<decltype(*std::data(values))>;
  return std::span<const Value>(std::data(values), std::size(values));
}

}  // namespace detail

/// Creates the folder `path` and its parents if missing.
/// Errors: FileError with the part of the path that is a file or cannot be created.
[[gnu::cold]] inline void make_folder(const std::string& path) {
  require(!path.empty(), "make_folder: the path is empty; '.' is the present folder");
  for (std::size_t end = 0; end != std::string::npos;) {
    end = path.find('/', end + 1);
    const std::string part = path.substr(0, end);
    if (::mkdir(part.c_str(), 0777) == 0) continue;
    const int code = errno;
    struct stat status {};
    const bool exists = ::stat(part.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) continue;
    throw FileError(text("folder '", path, "' cannot be created: ",
                         exists ? text("'", part, "' is a file")
                                : text("'", part, "': ", detail::system_reason(code))));
  }
}
/// Creates the folder of a file.
inline void make_folder_of(const std::string& path) {
  if (const auto slash = path.rfind('/'); slash != path.npos && slash > 0)
    make_folder(path.substr(0, slash));
}

/// Whether closing a file waits for the disk. Files needed for a restart do. A picture may be lost
/// in a power failure, and waiting would take longer than writing it.
enum class Flush { ToDisk, Never };

/// File that appears complete or not at all: written as `<path>.partial`, and renamed to `path` by
/// `commit` after it has reached the disk. At any moment, and after a kill or power failure, `path`
/// is the whole old file or the whole new one. With Flush::Never this excludes power failures,
/// which may leave a file of the last minute empty or truncated.
/// Errors: every failed call throws FileError with the path and the system's reason, removes the
///         partial file and leaves `path` unchanged. The destructor without `commit` does the same
///         silently.
class AtomicFile {
 public:
  explicit AtomicFile(std::string path, Flush flush = Flush::ToDisk)
      : path_(need_file(std::move(path))),
        partial_(path_ + ".partial"),
        waits_(flush == Flush::ToDisk),
        file_(partial_, O_WRONLY | O_CREAT | O_TRUNC, path_) {}
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile() {
    if (open_) remove_partial();
  }

  void write(const void* data, std::size_t bytes) {
    require_open("write");
    if (buffer_.size() + bytes > buffer_size) flush();
    if (bytes > buffer_size)
      or_remove([&] { file_.write(data, bytes); });
    else
      buffer_.append(static_cast<const char*>(data), bytes);
  }
  void write(std::string_view characters) { write(characters.data(), characters.size()); }

  void commit() {
    require_open("commit");
    flush();
    or_remove([&] {
      if (waits_) file_.flush_to_disk();
      file_.close();
      if (std::rename(partial_.c_str(), path_.c_str()) != 0)
        throw FileError(text("file '", path_, "' cannot be put in place (renamed from '", partial_,
                             "'): ", detail::system_reason(errno)));
    });
    open_ = false;
    if (waits_) detail::flush_folder_of(path_);
  }

 private:
  static constexpr std::size_t buffer_size = std::size_t{1} << 18;

  /// FileError for a device or a pipe, such as /dev/null: the rename would replace it.
  static std::string need_file(std::string path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
      throw FileError(text("file '", path,
                           "' cannot be written: it is a device or a pipe, which a file would "
                           "replace; name a file"));
    return path;
  }
  void require_open(std::string_view call) const {
    require(open_, "AtomicFile '", path_, "': ", call,
            " after commit or after a failed write; make a new AtomicFile");
  }
  void flush() {
    or_remove([&] { file_.write(buffer_.data(), buffer_.size()); });
    buffer_.clear();
  }
  void remove_partial() noexcept {
    open_ = false;
    ::unlink(partial_.c_str());
  }
  template <class Action>
  void or_remove(Action&& action) {
    try {
      action();
    } catch (...) {
      remove_partial();
      throw;
    }
  }

  std::string path_, partial_;
  bool waits_;  // for the disk
  detail::File file_;
  std::string buffer_;
  bool open_ = true;  // neither committed nor failed
};

}  // namespace silt
