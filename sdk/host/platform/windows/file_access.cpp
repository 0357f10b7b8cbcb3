// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/file_access.hpp"

#include <windows.h>

#include <aclapi.h>

namespace odograph {
namespace {

/// What the access list grants to a group that everybody is in.
ACCESS_MASK granted(ACL* list, WELL_KNOWN_SID_TYPE group) {
  alignas(SID) unsigned char sid[SECURITY_MAX_SID_SIZE];
  DWORD size = sizeof sid;
  if (!CreateWellKnownSid(group, nullptr, sid, &size)) return 0;
  TRUSTEE_W trustee{};
  trustee.TrusteeForm = TRUSTEE_IS_SID;
  trustee.ptstrName = reinterpret_cast<LPWSTR>(sid);
  ACCESS_MASK rights = 0;
  return GetEffectiveRightsFromAclW(list, &trustee, &rights) == ERROR_SUCCESS ? rights : 0;
}

}  // namespace

bool everybody_writes(const std::filesystem::path& path, bool owners_only_is_safe) {
  ACL* list = nullptr;
  PSECURITY_DESCRIPTOR descriptor = nullptr;
  if (GetNamedSecurityInfoW(path.c_str(), SE_FILE_OBJECT, DACL_SECURITY_INFORMATION, nullptr, nullptr, &list, nullptr,
                            &descriptor) != ERROR_SUCCESS)
    return false;
  ACCESS_MASK rights = ~ACCESS_MASK{0};  // no list at all: all may do all
  if (list)
    rights = granted(list, WinWorldSid) | granted(list, WinAuthenticatedUserSid) | granted(list, WinBuiltinUsersSid);
  LocalFree(descriptor);
  constexpr ACCESS_MASK replace = FILE_DELETE_CHILD | WRITE_DAC | WRITE_OWNER;
  constexpr ACCESS_MASK write = replace | FILE_WRITE_DATA;  // of a folder: to add a file
  return (rights & (owners_only_is_safe ? replace : write)) != 0;
}

}  // namespace odograph
