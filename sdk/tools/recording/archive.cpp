// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/archive.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>

#include <archive.h>
#include <archive_entry.h>

namespace odograph {
namespace fs = std::filesystem;

namespace {

struct Reader {
  archive* handle = archive_read_new();
  Reader() {
    // Only some filters: others (lrzip, grzip) would start a program on behalf of an untrusted file.
    archive_read_support_filter_gzip(handle);
    archive_read_support_filter_xz(handle);
    archive_read_support_format_zip(handle);
    archive_read_support_format_tar(handle);
    archive_read_support_format_7zip(handle);
  }
  ~Reader() { archive_read_free(handle); }
  std::string error() const {
    const char* text = archive_error_string(handle);
    return text ? text : "damaged";
  }
};

class Unpacking {
 public:
  Unpacking(const fs::path& file, const UnpackLimits& limits)
      : file_(file), limits_(limits), folder_(std::make_shared<TemporaryFolder>()) {}

  Result<std::shared_ptr<const TemporaryFolder>> run() {
    std::error_code error;
    if (folder_->path().empty()) return wrong("cannot create a temporary folder to unpack it");
    packed_ = fs::file_size(file_, error);
    const auto space = fs::space(folder_->path(), error);
    if (!error) limits_.bytes = std::min<uint64_t>(limits_.bytes, space.available / 10 * 9);
    if (archive_read_open_filename(reader_.handle, file_.c_str(), 1 << 16) != ARCHIVE_OK)
      return wrong("cannot be unpacked: " + reader_.error());
    archive_entry* entry = nullptr;
    for (;;) {
      const int next = archive_read_next_header(reader_.handle, &entry);
      if (next == ARCHIVE_EOF) break;
      if (next < ARCHIVE_WARN) return wrong("cannot be unpacked: " + reader_.error());
      if (++files_ > limits_.files) return wrong("more than " + std::to_string(limits_.files) + " files in it");
      if (const auto taken = take(entry); !taken) return taken.failure();
    }
    if (files_ == 0) return wrong("nothing in it");
    return std::shared_ptr<const TemporaryFolder>(folder_);
  }

 private:
  Failure wrong(const std::string& text) const { return {ODO_E_DATA, file_.string() + ": " + text}; }

  Result<bool> take(archive_entry* entry) {
    const char* name = archive_entry_pathname(entry);
    if (!name || !*name || std::strlen(name) > 1024) return wrong("a file in it has no usable name");
    const fs::path plain = fs::path(name).lexically_normal();
    const bool leads_out = plain.is_absolute() || plain.string().find('\\') != std::string::npos ||
                           std::any_of(plain.begin(), plain.end(), [](const fs::path& part) { return part == ".."; });
    if (leads_out) return wrong("'" + std::string(name) + "' leads out of its folder");
    std::error_code error;
    if (archive_entry_filetype(entry) == AE_IFDIR) {
      fs::create_directories(folder_->path() / plain, error);
      return error ? Result<bool>(wrong("'" + std::string(name) + "': " + error.message())) : true;
    }
    if (archive_entry_filetype(entry) != AE_IFREG || archive_entry_hardlink(entry))
      return wrong("'" + std::string(name) + "' is a link or a device; expected only files");
    if (archive_entry_is_encrypted(entry)) return wrong("has a password; export it without");
    fs::create_directories((folder_->path() / plain).parent_path(), error);
    std::ofstream out(folder_->path() / plain, std::ios::binary | std::ios::trunc);
    if (error || !out) return wrong("'" + std::string(name) + "' cannot be unpacked");
    return copy(name, out);
  }

  Result<bool> copy(const char* name, std::ofstream& out) {
    const void* block = nullptr;
    size_t size = 0;
    la_int64_t offset = 0;
    for (;;) {
      const int got = archive_read_data_block(reader_.handle, &block, &size, &offset);
      if (got == ARCHIVE_EOF) break;
      if (got < ARCHIVE_WARN) return wrong("'" + std::string(name) + "' is damaged: " + reader_.error());
      bytes_ += size;
      if (bytes_ > limits_.bytes || static_cast<uint64_t>(offset) > limits_.bytes)
        return wrong("unpacks to more than " + std::to_string(limits_.bytes >> 20) + " MB");
      if (bytes_ > limits_.free_bytes && bytes_ / limits_.ratio > packed_)
        return wrong("unpacks to more than " + std::to_string(limits_.ratio) + " times its size; no recording does");
      out.seekp(offset);
      out.write(static_cast<const char*>(block), static_cast<std::streamsize>(size));
    }
    return out.flush() ? Result<bool>(true) : wrong("'" + std::string(name) + "': writing failed; is the disk full?");
  }

  fs::path file_;
  UnpackLimits limits_;
  std::shared_ptr<TemporaryFolder> folder_;
  Reader reader_;
  uint64_t packed_ = 0, bytes_ = 0;
  size_t files_ = 0;
};

}  // namespace

bool looks_like_archive(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  char head[6]{};
  std::ifstream(file, std::ios::binary).read(head, sizeof head);
  const auto starts = [&](std::initializer_list<unsigned char> bytes) {
    return std::equal(bytes.begin(), bytes.end(), reinterpret_cast<const unsigned char*>(head));
  };
  return starts({'P', 'K', 3, 4}) || starts({'P', 'K', 5, 6}) || starts({0x1F, 0x8B}) ||
         starts({'7', 'z', 0xBC, 0xAF, 0x27, 0x1C}) || starts({0xFD, '7', 'z', 'X', 'Z', 0});
}

Result<std::shared_ptr<const TemporaryFolder>> unpack(const fs::path& file, const UnpackLimits& limits) {
  return Unpacking(file, limits).run();
}

bool unpack_bytes(std::span<const unsigned char> packed, uint64_t size, std::vector<unsigned char>& bytes) {
  const std::unique_ptr<archive, int (*)(archive*)> reader(archive_read_new(), archive_read_free);
  archive_read_support_filter_bzip2(reader.get());
  archive_read_support_filter_lz4(reader.get());
  archive_read_support_filter_zstd(reader.get());
  archive_read_support_format_raw(reader.get());
  archive_entry* entry = nullptr;
  bytes.clear();
  if (archive_read_open_memory(reader.get(), packed.data(), packed.size()) != ARCHIVE_OK ||
      archive_read_next_header(reader.get(), &entry) != ARCHIVE_OK)
    return false;
  while (bytes.size() <= size) {  // grows with the data: a stated size cannot be trusted
    unsigned char block[1 << 16];
    const auto got = archive_read_data(reader.get(), block, sizeof block);
    if (got < 0) return false;
    if (got == 0) break;
    bytes.insert(bytes.end(), block, block + got);
  }
  return bytes.size() == size;
}

}  // namespace odograph
