/* SPDX-License-Identifier: Apache-2.0
 *
 * Position from distances to transmitters: the algorithm, without the ABI. Not thread-safe; does not allocate.
 *
 * Ranges of a short window are referred to its newest pose by the track's own displacement. Gauss-Newton then finds the
 * displacement delta of the antenna that minimises sum_i (r_i - |a_i + delta - s_i|)^2 / sigma_i^2, with a_i the
 * antenna and s_i the transmitter. The information matrix sum_i u_i u_i^T / sigma_i^2 is decomposed into eigenvectors:
 * a direction without ranges keeps the track's value and gets `unobserved_sigma_m`. The pose itself adds no
 * information, so that a host that fuses the result counts nothing twice.
 */
#ifndef RANGE_FIX_H
#define RANGE_FIX_H

#include <stdint.h>

typedef struct range_parameters {
  double interval_s;         /* length of a window, s */
  double max_gap_s;          /* between two poses that a range may lie between, s */
  double bias_sigma_m;       /* error of a transmitter's ranges that does not average out, m */
  double correlation_s;      /* correlation time of that error, s */
  double prior_sigma_m;      /* of a pose without covariance, and limit for a direction determined by ranges, m */
  double unobserved_sigma_m; /* of a direction without ranges, m */
  double gate;               /* normalised innovation above which a range is rejected */
  int64_t max_rejected;      /* consecutive windows against the track after which the ranges are trusted instead */
} range_parameters;

typedef struct range_pose {
  int64_t t_ns;
  double q_n_b[4];
  double p_n[3];          /* of b's origin, m */
  double covariance_n[9]; /* of p_n, m^2 */
  double yaw_variance;    /* rad^2 */
} range_pose;

typedef struct range_sample {
  int64_t t_ns;
  uint64_t transmitter;
  double range_m, sigma_m;
  double transmitter_n[3], transmitter_sigma_m;
  double lever_b[3];   /* antenna in b, m */
  double antenna_n[3]; /* at t_ns by the track, m; set by range_fix_add_range */
  double variance;     /* m^2; set likewise */
} range_sample;

#define RANGE_CAPACITY 128

typedef struct range_fix {
  range_parameters parameters;
  range_pose poses[2]; /* the last two */
  int pose_count;
  range_sample waiting[RANGE_CAPACITY]; /* waiting for a later pose */
  int waiting_count;
  range_sample window[RANGE_CAPACITY];
  int window_count;
  int64_t rejected; /* consecutive windows */
} range_fix;

typedef struct range_result {
  int64_t t_ns;
  double p_n[3];          /* of the point lever_b, m */
  double covariance_n[9]; /* m^2 */
  double lever_b[3];
  int used, given; /* ranges */
} range_result;

void range_fix_clear(range_fix* self);
void range_fix_add_pose(range_fix* self, const range_pose* pose);
/* A point x of the old n is at q * x + p in the new one. */
void range_fix_correct(range_fix* self, const double* q, const double* p);
/* 1: a window is complete and *result is set; 0: not yet, or the ranges do not determine a fix. */
int range_fix_add_range(range_fix* self, const range_sample* range, range_result* result);

/* Small algebra, also for plugin.c. */
void range_rotate(const double* q, const double* v, double* out);
void range_multiply(const double* a, const double* b, double* out); /* quaternions */
/* Eigenvalues and eigenvectors (rows of `vectors`) of a symmetric 3 x 3 matrix, by Jacobi rotations. */
void range_eigen(const double* matrix, double* values, double* vectors);

#endif
