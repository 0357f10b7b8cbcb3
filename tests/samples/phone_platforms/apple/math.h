/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
double sqrt(double x);
