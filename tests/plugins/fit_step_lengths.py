#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fits step/odograph's lengths, and selects the law on held-out data sets and people.

    python3 tests/plugins/fit_step_lengths.py DATA [--whole-steps]      # DATA/ridi, DATA/ipin2023_t3, DATA/trundle_wheel, DATA/phone_walks

Needs numpy and scipy, which nothing else of the project does. Steps are peaks of the smoothed vertical acceleration, as the plugin's
(plugins/step/odograph); inclination by a complementary filter of 3 s. What steps fill between true places is joined to
stretches of 20 m. Printed for each law: its numbers by all sets; the error of each walk's distance (median and 90 % of the size, mean)
fitted on all sets and on the others; of RIDI fitted without the person too. --whole-steps: the first steps after a stop as
long as the others."""
import csv
import glob
import os
import sys

import numpy as np
from scipy.optimize import least_squares

HZ = 50.0
RAD = np.pi / 180


def resampled(t, x):
    """Means of the linear interpolation over cells of 20 ms."""
    keep = np.concatenate([[True], np.diff(t) > 0])
    t, x = t[keep], x[keep]
    total = np.vstack([np.zeros(x.shape[1]), np.cumsum(0.5 * (x[1:] + x[:-1]) * np.diff(t)[:, None], axis=0)])
    grid = np.arange(t[0], t[-1], 1 / HZ)
    at = np.stack([np.interp(grid, t, total[:, i]) for i in range(x.shape[1])], 1)
    return 0.5 * (grid[1:] + grid[:-1]), np.diff(at, axis=0) * HZ


def cross(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def onto_up(u):
    v = cross(np.cross(u, [0, 0, 1.0]))
    return np.eye(3) + v + v @ v / (1 + u[2]) if u[2] > -0.999 else np.diag([1, -1, -1.0])


def upright(gyro, force):
    """Forces in a frame whose z is up."""
    mean = force[:25].mean(0)
    R = onto_up(mean / np.linalg.norm(mean))
    slow, out = np.array([0, 0, 9.8]), np.zeros_like(force)
    for i, (w, f) in enumerate(zip(gyro / HZ, force)):
        angle = np.linalg.norm(w)
        if angle > 1e-12:
            K = cross(w / angle)
            R = R @ (np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K)
        slow = slow + (R @ f - slow) / HZ / 3.0
        C = onto_up(slow / np.linalg.norm(slow))
        R, slow = C @ R, C @ slow
        if i % 100 == 0:
            u, _, v = np.linalg.svd(R)
            R = u @ v
        out[i] = R @ f
    return out


def walk(data_set, name, force, gyro, stretches):
    force, gyro = np.array(force), np.array(gyro)
    t, f = resampled(force[:, 0], force[:, 1:4])
    tg, g = resampled(gyro[:, 0], gyro[:, 1:4])
    g = np.stack([np.interp(t, tg, g[:, i]) for i in range(3)], 1)
    return data_set, name, steps_of(t, upright(g, f), np.linalg.norm(g, axis=1)), stretches


def between(places):
    return [(a[0], b[0], np.hypot(b[1] - a[1], b[2] - a[2])) for a, b in zip(places, places[1:])]


def walks(data):
    for file in sorted(glob.glob(data + '/ridi/*.csv')):
        a = np.loadtxt(file, delimiter=',', skiprows=1)
        p = np.stack([np.convolve(a[:, i], np.ones(202) / 202, 'same') for i in (10, 11)], 1)[101:-101:50]
        t = a[101:-101:50, 0]
        done = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
        edges = range(0, len(t) - 24, 24)  # six seconds
        yield walk('ridi', os.path.basename(file), a[:, [0, 4, 5, 6]], a[:, [0, 1, 2, 3]],
                   [(t[k], t[k + 24], done[k + 24] - done[k]) for k in edges])
    for file in sorted(glob.glob(data + '/ipin2023_t3/trials/*.txt')):
        rows, places, offset = {'ACCE': [], 'GYRO': []}, [], {}
        for f in (line.strip().split(';') for line in open(file, errors='ignore')):
            if f[0] in rows:
                o = offset.setdefault(f[0], float(f[1]) - float(f[2]))
                rows[f[0]].append([float(f[2]) + o] + [float(x) for x in f[3:6]])
            elif f[0] == 'POSI':
                places.append([float(f[1]), float(f[3]) * RAD * 6371008.8, float(f[4]) * RAD * 6371008.8, float(f[5])])
        if len({p[3] for p in places}) > 1:  # over stairs
            continue
        north = np.cos(places[0][1] / 6371008.8)
        yield walk('ipin', os.path.basename(file), rows['ACCE'], rows['GYRO'],
                   between([(p[0], p[1], north * p[2]) for p in places]))
    for file in sorted(glob.glob(data + '/trundle_wheel/*.csv')):
        rows, wheel = [], []
        for r in csv.DictReader(open(file), delimiter=';'):
            t = 1e-3 * float(r['time'])
            if r['m_accG_x'] and r['m_rotTate_alpha']:
                rows.append([t] + [float(r['m_accG_' + c]) for c in 'xyz'] +
                            [RAD * float(r['m_rotTate_' + c]) for c in ('alpha', 'beta', 'gamma')])
            if r['distance'] and (not wheel or float(r['distance']) >= wheel[-1][1] + 8):
                wheel.append((t, float(r['distance']), 0))
        rows = np.array(rows)
        yield walk('trundle', os.path.basename(file), rows[:, :4], rows[:, [0, 4, 5, 6]], between(wheel))
    for file in sorted(glob.glob(data + '/phone_walks/*.txt')):
        rows = {'TYPE_ACCELEROMETER': [], 'TYPE_GYROSCOPE': [], 'TYPE_WAYPOINT': []}
        for f in (line.split() for line in open(file, errors='ignore')):
            if len(f) > 3 and f[1] in rows:
                rows[f[1]].append([1e-3 * float(f[0])] + [float(x) for x in f[2:5 if 'WAY' not in f[1] else 4]])
        yield walk('phone_walks', os.path.basename(file), rows['TYPE_ACCELEROMETER'], rows['TYPE_GYROSCOPE'],
                   between(rows['TYPE_WAYPOINT']))


def rise(v):
    u = np.cumsum(v - v.mean()) / HZ
    p = np.cumsum(u - u.mean()) / HZ
    return max(p.max(), 0) - min(p.min(), 0)


def repetition(x, end, lag):
    best = 0
    for k in range(lag - 2, lag + 3):
        if end < lag + k:
            continue
        a, b = x[end - lag:end], x[end - lag - k:end - k]
        a, b = a - a.mean(0), b - b.mean(0)
        best = max(best, (a * b).sum() / np.sqrt((a * a).sum() * (b * b).sum() + 1e-9))
    return best


def steps_of(t, force, rate):
    """For each step: start, end, frequency, rise, mean rate, repetition of its stride, vertical part."""
    gauss = np.exp(-0.5 * (np.arange(-10, 11) / HZ / 0.06) ** 2)
    x = np.stack([np.convolve(force[:, i], gauss / gauss.sum(), 'same') for i in range(3)], 1)
    total = np.concatenate([[0], np.cumsum(force[:, 2])])
    at = np.minimum(np.arange(len(x)) + 10, len(x) - 1)
    start = np.maximum(at - 124, 0)
    v = x[:, 2] - (total[at + 1] - total[start]) / (at + 1 - start)
    x[:, 2] = v
    peaks, candidate, low = [], None, 1e9
    for n in range(2, len(v)):
        if v[n - 1] > v[n - 2] and v[n - 1] >= v[n] and v[n - 1] > 0:
            free = not peaks or (n - 1 - peaks[-1]) / HZ > 0.27
            if v[n - 1] - min(low, v[n - 1]) > 0.5 and free and (candidate is None or v[n - 1] > v[candidate]):
                candidate = n - 1
        low = min(low, v[n])
        if candidate is not None and (n - candidate) / HZ > 0.12:
            peaks.append(candidate)
            low, candidate = v[candidate:n + 1].min(), None
    steps = []
    for j in range(1, len(peaks)):
        a, b = peaks[j - 1], peaks[j]
        around = np.diff(peaks[max(0, j - 4):j + 4]) / HZ
        if (b - a) / HZ > 1.1:
            continue
        f = 1 / around[around < 1.1].mean()
        power = x[a:b].var(0)
        steps.append((t[a], t[b], f, rise(v[a:b]), rate[a:b].mean(), repetition(x, b, int(round(2 * HZ / f))),
                      power[2] / power.sum()))
    return np.array(steps)


# The first step after standing is half as long (RIDI's walkers), as in the plugin's LengthModel.
SETTING_OUT = lambda since_stood: 1 - 0.5 * np.exp(-since_stood / 1.3)

# x: frequency, rise, rotation rate, repetition, vertical part
LAWS = {
    'a': (lambda q, f, h, w, r, v: q[0] + 0 * f, [0.6]),
    'a + b f': (lambda q, f, h, w, r, v: q[0] + q[1] * f, [0.3, 0.2]),
    'a + b h': (lambda q, f, h, w, r, v: q[0] + q[1] * h, [0.5, 4]),
    'a + b sqrt(h)': (lambda q, f, h, w, r, v: q[0] + q[1] * np.sqrt(h), [0.3, 1.8]),
    'a + (b + c w) sqrt(h)': (lambda q, f, h, w, r, v: q[0] + (q[1] + q[2] * w) * np.sqrt(h), [0.1, 3.3, -0.8]),
    'a f^b h^c': (lambda q, f, h, w, r, v: q[0] * (f / 1.8) ** q[1] * (h / 0.03) ** q[2], [0.6, 0.5, 0.2]),
    'a + b r': (lambda q, f, h, w, r, v: q[0] + q[1] * r, [0.5, 0.2]),
    'a + b h + c r': (lambda q, f, h, w, r, v: q[0] + q[1] * h + q[2] * r, [0.6, 4, 0.2]),
    'a + b h + c r + d f': (lambda q, f, h, w, r, v: q[0] + q[1] * h + q[2] * r + q[3] * f, [0.6, 4, 0.2, 0]),
    'a + b h + c r + d v': (lambda q, f, h, w, r, v: q[0] + q[1] * h + q[2] * r + q[3] * v, [0.6, 4, 0.2, 0]),
    'a + b h + c r + d w': (lambda q, f, h, w, r, v: q[0] + q[1] * h + q[2] * r + q[3] * w, [0.6, 4, 0.2, 0]),
    'a + b (h - 0.03) + c (f - 1.8) (h - 0.03) + d (r - 0.85)':
        (lambda q, f, h, w, r, v: q[0] + (q[1] + q[2] * (f - 1.8)) * (h - 0.03) + q[3] * (r - 0.85), [0.6, 4, -5, 0.2]),
    'the same + e (w - 0.5) (v - 0.6) h':
        (lambda q, f, h, w, r, v: q[0] + (q[1] + q[2] * (f - 1.8)) * (h - 0.03) + q[3] * (r - 0.85) +
         q[4] * (w - 0.5) * (v - 0.6) * h, [0.6, 4, -5, 0.2, 0]),
}


def distance(law, q, row):
    x, part = row[2], row[3]
    if SETTING_OUT:
        part = part * SETTING_OUT(x[:, 7])
    return (law(q, x[:, 2], np.clip(x[:, 3], 1e-3, 0.1), np.clip(x[:, 4], 0.2, 1.4), x[:, 5], x[:, 6]) * part).sum()


def fitted(law, start, rows):
    metres = {s: sum(r[4] for r in rows if r[0] == s) for s in {r[0] for r in rows}}
    weight = np.array([np.sqrt(r[4] / metres[r[0]] * (0.3 if r[0] == 'trundle' else 1)) for r in rows])
    residual = lambda q: weight * [np.log(max(distance(law, q, r), 0.1) / r[4]) for r in rows]
    return least_squares(residual, start, loss='soft_l1', f_scale=0.02).x


def sizes(sums):
    e = np.array([100 * (a / b - 1) for a, b in sums.values()])
    return '%5.1f %5.1f %+6.1f' % (np.median(abs(e)), np.quantile(abs(e), 0.9), e.mean())


def sums_of(law, q, rows):
    sums = {}
    for r in rows:
        total = sums.setdefault(r[1], [0, 0])
        total[0] += distance(law, q, r)
        total[1] += r[4]
    return sums


def without_the_person(law, start, rows):
    sums = {}
    person = lambda r: r[1].split('_')[0] if r[0] == 'ridi' else ''
    for one in {person(r) for r in rows} - {''}:
        q = fitted(law, start, [r for r in rows if person(r) != one])
        sums.update(sums_of(law, q, [r for r in rows if person(r) == one]))
    return sizes(sums)


def joined(rows):
    """Stretches of one walk until they have 20 m."""
    for r in rows:
        if out := getattr(joined, 'open', None):
            if out[1] == r[1]:
                r = (r[0], r[1], np.vstack([out[2], r[2]]), np.concatenate([out[3], r[3]]), out[4] + r[4])
            else:
                yield out
        joined.open = r if r[4] < 20 else None
        if r[4] >= 20:
            yield r
    if joined.open:
        yield joined.open


def since_stood(steps):
    """Steps since the last pause of 0.8 s and more."""
    count, out = -1, []
    for i, step in enumerate(steps):
        count = 0 if i == 0 or step[0] - steps[i - 1, 1] > 0.8 else count + 1
        out.append(count)
    return np.array(out)


def main():
    global SETTING_OUT
    if '--whole-steps' in sys.argv:
        SETTING_OUT = None
    rows = []
    for data_set, name, steps, stretches in walks(sys.argv[1]):
        for i in range(1, len(steps)):  # mean repetition over the last steps, as in the plugin
            if steps[i, 0] - steps[i - 1, 1] < 1:
                steps[i, 5] = steps[i - 1, 5] + 0.25 * (steps[i, 5] - steps[i - 1, 5])
        steps = np.column_stack([steps, since_stood(steps)]) if len(steps) else steps
        for a, b, d in stretches:
            x = steps[(steps[:, 1] > a) & (steps[:, 0] < b)] if len(steps) else steps
            if len(x) < 3 or d < 2:
                continue
            inside = np.minimum(b, x[:, 1]) - np.maximum(a, x[:, 0])
            if inside.sum() > 0.9 * (b - a) and np.median(x[:, 5]) > 0.5:
                rows.append((data_set, name, x, inside / (x[:, 1] - x[:, 0]), d))
    rows = list(joined(rows))
    sets = ['ridi', 'ipin', 'trundle', 'phone_walks']
    print('walks: ' + str({s: len({r[1] for r in rows if r[0] == s}) for s in sets}))
    for name, (law, start) in LAWS.items():
        q = fitted(law, start, rows)
        print(name, np.round(q, 4))
        for s in sets:
            own, others = [r for r in rows if r[0] == s], [r for r in rows if r[0] != s]
            print('  %-12s all %s   left out %s%s' % (s, sizes(sums_of(law, q, own)), sizes(sums_of(law, fitted(law, start, others), own)),
                  '   person left out ' + without_the_person(law, start, rows) if s == 'ridi' else ''))


if __name__ == '__main__':
    main()
