// SPDX-License-Identifier: Apache-2.0
//
// Checks the file before dlopen: the dynamic loader maps a truncated library without an error and dies of SIGBUS.
#include <cstring>
#include <fstream>

#include "sdk/host/plugin_host/library.hpp"

#if defined(__linux__)
#include <elf.h>
#include <link.h>
#endif

namespace odograph {

#if defined(__linux__)
namespace {

constexpr uint16_t machine_of_this_build() {
#if defined(__x86_64__)
  return EM_X86_64;
#elif defined(__aarch64__)
  return EM_AARCH64;
#elif defined(__arm__)
  return EM_ARM;
#elif defined(__riscv)
  return EM_RISCV;
#elif defined(__i386__)
  return EM_386;
#else
  return EM_NONE;
#endif
}

}  // namespace

Result<bool> check_shared_library(const std::filesystem::path& path, const std::filesystem::path& name) {
  const auto fail = [&](const std::string& text) { return Failure{ODO_E_DATA, name.string() + ": " + text}; };
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    return fail("is a folder, a pipe or a device; expected a shared library");
  std::ifstream file(path, std::ios::binary);
  if (!file) return Failure{ODO_E_NOT_FOUND, name.string() + ": cannot be opened"};
  const uint64_t size = std::filesystem::file_size(path, error);
  ElfW(Ehdr) header{};
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  if (file.gcount() < EI_NIDENT || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0)
    return fail("not an ELF file; expected a shared library");
  if (header.e_ident[EI_CLASS] != (sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32))
    return fail("made for another word size than this program's " + std::to_string(sizeof(void*) * 8) + " bits");
  if (header.e_machine != machine_of_this_build())
    return fail("made for another machine (ELF machine " + std::to_string(header.e_machine) + ", this one is " +
                std::to_string(machine_of_this_build()) + ")");
  if (header.e_type != ET_DYN) return fail("an ELF file, but not a shared library");
  const auto truncated = [&](uint64_t end) { return end > size || end < sizeof(ElfW(Ehdr)); };
  const uint64_t table_end = uint64_t(header.e_phoff) + uint64_t(header.e_phnum) * sizeof(ElfW(Phdr));
  if (file.gcount() < static_cast<std::streamsize>(sizeof header) || header.e_phentsize != sizeof(ElfW(Phdr)) ||
      truncated(table_end) ||
      (header.e_shnum && truncated(uint64_t(header.e_shoff) + uint64_t(header.e_shnum) * header.e_shentsize)))
    return fail("truncated: " + std::to_string(size) + " bytes are present, its tables lie beyond");
  file.clear();
  file.seekg(static_cast<std::streamoff>(header.e_phoff));
  for (uint16_t i = 0; i < header.e_phnum; ++i) {
    ElfW(Phdr) segment{};
    file.read(reinterpret_cast<char*>(&segment), sizeof segment);
    if (!file || segment.p_offset > size || segment.p_filesz > size - segment.p_offset)
      return fail("truncated: " + std::to_string(size) + " bytes are present, a segment ends at " +
                  std::to_string(uint64_t(segment.p_offset) + segment.p_filesz));
  }
  return true;
}
#else
Result<bool> check_shared_library(const std::filesystem::path& path, const std::filesystem::path& name) {
  // dyld and the Windows loader validate the file themselves and return an error.
  if (!std::filesystem::exists(path)) return Failure{ODO_E_NOT_FOUND, name.string() + ": cannot be opened"};
  return true;
}
#endif

}  // namespace odograph
