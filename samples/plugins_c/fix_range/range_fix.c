/* SPDX-License-Identifier: Apache-2.0 */
#include "range_fix.h"

#include <math.h>
#include <string.h>

#define ITERATIONS 50 /* Huber's weights converge linearly if the track is far off */
#define CONVERGED_M 1e-4
#define HUBER 1.5 /* residuals beyond this many sigma are down-weighted: Huber 1981, 95 % efficient with 1.345 */

/* Difference of any two times, without overflow. */
static double seconds(int64_t later_ns, int64_t earlier_ns) {
  return 1e-9 * (double)(int64_t)((uint64_t)later_ns - (uint64_t)earlier_ns);
}

static double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* v^T M v */
static double quadratic(const double* m, const double* v) {
  const double mv[3] = {dot(m, v), dot(m + 3, v), dot(m + 6, v)};
  return dot(v, mv);
}

static double trace(const double* m) { return m[0] + m[4] + m[8]; }

void range_fix_clear(range_fix* self) {
  self->pose_count = self->waiting_count = self->window_count = 0;
  self->rejected = 0;
}

static void move(const double* q, const double* p, double* point) {
  range_rotate(q, point, point);
  for (int i = 0; i < 3; ++i) point[i] += p[i];
}

void range_fix_correct(range_fix* self, const double* q, const double* p) {
  for (int i = 0; i < 2; ++i) {
    move(q, p, self->poses[i].p_n);
    range_multiply(q, self->poses[i].q_n_b, self->poses[i].q_n_b);
  }
  for (int i = 0; i < self->window_count; ++i) move(q, p, self->window[i].antenna_n);
}

/* Antenna position at the time of the range, interpolated between the last two poses. */
static void interpolate_antenna(const range_fix* self, range_sample* range) {
  const range_pose *from = &self->poses[0], *to = &self->poses[1];
  const double span = seconds(to->t_ns, from->t_ns);
  const double share = span > 0 ? seconds(range->t_ns, from->t_ns) / span : 1.0;
  double q[4], norm = 0, sign = 0, lever_n[3];
  for (int i = 0; i < 4; ++i) sign += from->q_n_b[i] * to->q_n_b[i];
  for (int i = 0; i < 4; ++i) q[i] = (sign < 0 ? -1 : 1) * (1 - share) * from->q_n_b[i] + share * to->q_n_b[i];
  for (int i = 0; i < 4; ++i) norm += q[i] * q[i];
  for (int i = 0; i < 4; ++i) q[i] /= sqrt(norm);
  range_rotate(q, range->lever_b, lever_n);
  for (int i = 0; i < 3; ++i) range->antenna_n[i] = (1 - share) * from->p_n[i] + share * to->p_n[i] + lever_n[i];
}

/* Moves waiting ranges between the last two poses to the window. */
static void place_waiting(range_fix* self) {
  const range_pose *from = &self->poses[0], *to = &self->poses[1];
  int left = 0;
  if (self->pose_count < 2) return;
  for (int i = 0; i < self->waiting_count; ++i) {
    range_sample* range = &self->waiting[i];
    if (range->t_ns > to->t_ns) {
      self->waiting[left++] = *range;
    } else if (range->t_ns >= from->t_ns && seconds(to->t_ns, from->t_ns) <= self->parameters.max_gap_s &&
               self->window_count < RANGE_CAPACITY) {
      self->window[self->window_count] = *range;
      interpolate_antenna(self, &self->window[self->window_count++]);
    }
  }
  self->waiting_count = left;
}

void range_fix_add_pose(range_fix* self, const range_pose* pose) {
  if (self->pose_count > 0 && pose->t_ns <= self->poses[1].t_ns) return;
  self->poses[0] = self->pose_count > 0 ? self->poses[1] : *pose;
  self->poses[1] = *pose;
  if (self->pose_count < 2) ++self->pose_count;
  place_waiting(self);
}

/* Unit vector from the transmitter to the antenna moved by delta; returns their distance. */
static double line_of_sight(const range_sample* range, const double* delta, double* u) {
  for (int i = 0; i < 3; ++i) u[i] = range->antenna_n[i] + delta[i] - range->transmitter_n[i];
  double distance = sqrt(dot(u, u));
  if (distance < 1e-9) distance = 1e-9;
  for (int i = 0; i < 3; ++i) u[i] /= distance;
  return distance;
}

/* Variances of the ranges. The error common to the ranges of a transmitter is multiplied by their number, so that
 * their
 * mean keeps it, and by the number of windows that it lasts. */
static void set_variances(range_fix* self) {
  const range_parameters* p = &self->parameters;
  const range_pose* pose = &self->poses[1];
  const double windows = p->correlation_s > p->interval_s ? p->correlation_s / p->interval_s : 1.0;
  const range_sample* newest = &self->window[self->window_count - 1];
  for (int i = 0; i < self->window_count; ++i) {
    range_sample* range = &self->window[i];
    double same = 0, moved2 = 0;
    for (int k = 0; k < self->window_count; ++k) same += self->window[k].transmitter == range->transmitter;
    for (int k = 0; k < 2; ++k) {
      const double d = range->antenna_n[k] - newest->antenna_n[k];
      moved2 += d * d;
    }
    range->variance =
        range->sigma_m * range->sigma_m + pose->yaw_variance * moved2 +
        same * windows * (p->bias_sigma_m * p->bias_sigma_m + range->transmitter_sigma_m * range->transmitter_sigma_m);
  }
}

/* Moves those of the first `count` ranges to the front that agree within the gate with the antenna moved by delta,
 * whose
 * position has the covariance P (null: none). Returns their number. */
static int gate(range_fix* self, int count, const double* delta, const double* P) {
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    const range_sample range = self->window[i];
    double u[3];
    const double innovation = range.range_m - line_of_sight(&range, delta, u);
    const double variance = range.variance + (P ? quadratic(P, u) : 0);
    if (!(innovation * innovation <= self->parameters.gate * self->parameters.gate * variance)) continue;
    self->window[i] = self->window[kept]; /* swaps */
    self->window[kept++] = range;
  }
  return kept;
}

/* One Gauss-Newton step on the first `count` ranges with Huber's weights: updates delta and the covariance. Returns
 * the
 * length of the step. */
static double step(const range_fix* self, int count, double* delta, double* covariance) {
  const double unobserved2 = self->parameters.unobserved_sigma_m * self->parameters.unobserved_sigma_m;
  const double worst2 = self->parameters.prior_sigma_m * self->parameters.prior_sigma_m;
  double information[9] = {0}, gradient[3] = {0}, values[3], vectors[9], moved2 = 0;
  for (int i = 0; i < count; ++i) {
    const range_sample* range = &self->window[i];
    double u[3];
    const double residual = range->range_m - line_of_sight(range, delta, u);
    const double sigmas = fabs(residual) / sqrt(range->variance);
    const double weight = (sigmas > HUBER ? HUBER / sigmas : 1.0) / range->variance;
    for (int k = 0; k < 3; ++k) {
      gradient[k] += weight * residual * u[k];
      for (int m = 0; m < 3; ++m) information[3 * k + m] += weight * u[k] * u[m];
    }
  }
  range_eigen(information, values, vectors);
  memset(covariance, 0, 9 * sizeof *covariance);
  for (int i = 0; i < 3; ++i) {
    const double* v = vectors + 3 * i;
    const int observed = values[i] * worst2 > 1;
    const double variance = observed ? 1 / values[i] : unobserved2, length = observed ? variance * dot(v, gradient) : 0;
    moved2 += length * length;
    for (int k = 0; k < 3; ++k) {
      delta[k] += length * v[k];
      for (int m = 0; m < 3; ++m) covariance[3 * k + m] += variance * v[k] * v[m];
    }
  }
  return sqrt(moved2);
}

/* Returns whether it converged. */
static int solve(const range_fix* self, int count, double* delta, double* covariance) {
  memset(delta, 0, 3 * sizeof *delta);
  for (int i = 0; i < ITERATIONS; ++i) {
    const double moved = step(self, count, delta, covariance);
    if (!(moved < 1e6)) return 0;
    if (moved < CONVERGED_M) return 1;
  }
  return 0;
}

/* A range is linear only near the line of sight: d across it is d^2 / (2 r) along it. The track or the other ranges,
 * whichever is better, bound the true position across it. */
static void add_curvature(range_fix* self, int count, const double* delta, const double* covariance) {
  for (int i = 0; i < count; ++i) {
    double u[3], by_track, by_ranges, across2, along;
    const double distance = line_of_sight(&self->window[i], delta, u);
    by_track = trace(self->poses[1].covariance_n) - quadratic(self->poses[1].covariance_n, u);
    by_ranges = trace(covariance) - quadratic(covariance, u);
    across2 = by_track < by_ranges ? by_track : by_ranges;
    along = across2 / (2 * distance);
    self->window[i].variance += along * along;
  }
}

static int finish(range_fix* self, range_result* result) {
  const range_pose* pose = &self->poses[1];
  const range_parameters* p = &self->parameters;
  const range_sample newest = self->window[self->window_count - 1];
  double delta[3] = {0, 0, 0}, lever_n[3];
  int count, against;
  set_variances(self);
  count = gate(self, self->window_count, delta, pose->covariance_n);
  against = 2 * count < self->window_count; /* the few that agree may do so by chance */
  self->rejected = against ? self->rejected + 1 : 0;
  if (against && self->rejected <= p->max_rejected) return 0;
  if (against) count = self->window_count; /* then the track is wrong */
  if (!solve(self, count, delta, result->covariance_n)) return 0;
  add_curvature(self, count, delta, result->covariance_n);
  count = gate(self, count, delta, NULL);
  if (2 * count < self->window_count || !solve(self, count, delta, result->covariance_n)) return 0;
  /* Against the track the ranges must determine the position by themselves. */
  if (against && result->covariance_n[0] + result->covariance_n[4] > p->prior_sigma_m * p->prior_sigma_m) return 0;
  result->used = count, result->given = self->window_count;
  result->t_ns = pose->t_ns;
  range_rotate(pose->q_n_b, newest.lever_b, lever_n);
  for (int i = 0; i < 3; ++i) {
    result->p_n[i] = pose->p_n[i] + lever_n[i] + delta[i];
    result->lever_b[i] = newest.lever_b[i];
  }
  return 1;
}

int range_fix_add_range(range_fix* self, const range_sample* range, range_result* result) {
  if (self->waiting_count == RANGE_CAPACITY)
    memmove(self->waiting, self->waiting + 1, (size_t)--self->waiting_count * sizeof *self->waiting);
  self->waiting[self->waiting_count++] = *range;
  place_waiting(self);
  if (self->window_count == 0) return 0;
  if (seconds(self->poses[1].t_ns, self->window[0].t_ns) < self->parameters.interval_s &&
      self->window_count < RANGE_CAPACITY)
    return 0;
  const int done = finish(self, result);
  self->window_count = 0;
  return done;
}
