/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: all messages. base.h has the conventions and rules, samples.h the inputs, events.h the events.
 */
#ifndef ODOGRAPH_TYPES_H
#define ODOGRAPH_TYPES_H

#include <odograph/base.h>
#include <odograph/events.h>
#include <odograph/samples.h>

#endif
