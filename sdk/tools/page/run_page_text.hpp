// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// page.html with its style and scripts; "@DATA@" is replaced by the data.
extern const char kRunPageText[];

}  // namespace odograph
