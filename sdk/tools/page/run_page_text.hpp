// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// page.html with its style and scripts; "@DATA@" stands where the data goes.
extern const char kRunPageText[];

}  // namespace odograph
