/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "range_fix.h"

void range_multiply(const double* a, const double* b, double* out) {
  double q[4];
  q[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
  q[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
  q[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
  q[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
  for (int i = 0; i < 4; ++i) out[i] = q[i];
}

void range_rotate(const double* q, const double* v, double* out) {
  const double pure[4] = {0, v[0], v[1], v[2]}, conjugate[4] = {q[0], -q[1], -q[2], -q[3]};
  double r[4];
  range_multiply(q, pure, r);
  range_multiply(r, conjugate, r);
  for (int i = 0; i < 3; ++i) out[i] = r[i + 1];
}

/* One Jacobi rotation; zeroes element (p, q) of `a`. */
static void annihilate(double* a, double* vectors, int p, int q) {
  double theta, t, c, s;
  if (a[3 * p + q] == 0) return;
  theta = (a[4 * q] - a[4 * p]) / (2 * a[3 * p + q]);
  t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
  c = 1 / sqrt(t * t + 1), s = t * c;
  for (int k = 0; k < 3; ++k) {
    const double kp = a[3 * k + p], kq = a[3 * k + q];
    a[3 * k + p] = c * kp - s * kq, a[3 * k + q] = s * kp + c * kq;
  }
  for (int k = 0; k < 3; ++k) {
    const double pk = a[3 * p + k], qk = a[3 * q + k], vp = vectors[3 * p + k], vq = vectors[3 * q + k];
    a[3 * p + k] = c * pk - s * qk, a[3 * q + k] = s * pk + c * qk;
    vectors[3 * p + k] = c * vp - s * vq, vectors[3 * q + k] = s * vp + c * vq;
  }
}

void range_eigen(const double* matrix, double* values, double* vectors) {
  double a[9];
  int sweep;
  for (int i = 0; i < 9; ++i) a[i] = matrix[i], vectors[i] = i % 4 == 0;
  for (sweep = 0; sweep < 8; ++sweep) { /* quadratic convergence: 4 or 5 suffice */
    annihilate(a, vectors, 0, 1);
    annihilate(a, vectors, 0, 2);
    annihilate(a, vectors, 1, 2);
  }
  for (int i = 0; i < 3; ++i) values[i] = a[4 * i];
}
