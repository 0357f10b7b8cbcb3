/* SPDX-License-Identifier: Apache-2.0 */
#include <odograph/anchor.h>
#include <odograph/recording.h>
#include <odograph/map.h>
#include <odograph/scene.h>
