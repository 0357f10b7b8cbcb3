/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: the values that cross the border. base.h has the rules that hold for all of them, samples.h what
 * goes in, events.h what comes out.
 */
#ifndef ODOGRAPH_TYPES_H
#define ODOGRAPH_TYPES_H

#include <odograph/base.h>
#include <odograph/events.h>
#include <odograph/samples.h>

#endif
