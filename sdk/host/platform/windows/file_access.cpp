// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/file_access.hpp"

#include <windows.h>

#include <aclapi.h>

namespace odograph {
namespace {

/// Rights that the access list grants to a group that contains everybody: entries in order, without those that only
/// apply to the contents of a folder.
ACCESS_MASK granted(ACL* list, WELL_KNOWN_SID_TYPE group) {
  alignas(SID) unsigned char sid[SECURITY_MAX_SID_SIZE];
  DWORD size = sizeof sid;
  if (!CreateWellKnownSid(group, nullptr, sid, &size)) return 0;
  ACCESS_MASK allowed = 0, denied = 0;
  for (DWORD i = 0; i < list->AceCount; ++i) {
    void* entry = nullptr;
    if (!GetAce(list, i, &entry)) return allowed;
    const auto& head = *static_cast<const ACE_HEADER*>(entry);
    if ((head.AceFlags & INHERIT_ONLY_ACE) != 0) continue;
    if (head.AceType != ACCESS_ALLOWED_ACE_TYPE && head.AceType != ACCESS_DENIED_ACE_TYPE) continue;
    auto* of_group = static_cast<ACCESS_ALLOWED_ACE*>(entry);  // ACCESS_DENIED_ACE has the same layout
    if (!EqualSid(&of_group->SidStart, sid)) continue;
    if (head.AceType == ACCESS_DENIED_ACE_TYPE)
      denied |= of_group->Mask;
    else
      allowed |= of_group->Mask & ~denied;
  }
  GENERIC_MAPPING files{FILE_GENERIC_READ, FILE_GENERIC_WRITE, FILE_GENERIC_EXECUTE, FILE_ALL_ACCESS};
  MapGenericMask(&allowed, &files);
  return allowed;
}

}  // namespace

bool is_world_writable(const std::filesystem::path& path, bool owners_only_is_safe) {
  ACL* list = nullptr;
  PSECURITY_DESCRIPTOR descriptor = nullptr;
  if (GetNamedSecurityInfoW(path.c_str(), SE_FILE_OBJECT, DACL_SECURITY_INFORMATION, nullptr, nullptr, &list, nullptr,
                            &descriptor) != ERROR_SUCCESS)
    return false;
  ACCESS_MASK rights = ~ACCESS_MASK{0};  // without a list, everything is allowed
  if (list)
    rights = granted(list, WinWorldSid) | granted(list, WinAuthenticatedUserSid) | granted(list, WinBuiltinUsersSid);
  LocalFree(descriptor);
  constexpr ACCESS_MASK replace = FILE_DELETE_CHILD | WRITE_DAC | WRITE_OWNER;
  constexpr ACCESS_MASK write = replace | FILE_WRITE_DATA;  // for a folder: to add a file
  return (rights & (owners_only_is_safe ? replace : write)) != 0;
}

FileSizeLimit::FileSizeLimit() = default;
FileSizeLimit::~FileSizeLimit() = default;

}  // namespace odograph
