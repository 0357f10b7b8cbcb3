# SPDX-License-Identifier: Apache-2.0
"""Skies as panoramas, and the noise and colours of skies and scenes."""
import cv2
import numpy as np

HEIGHT, WIDTH = 512, 1024


def grid(height=HEIGHT, width=WIDTH):
    elevation = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    azimuth = (np.arange(width) + 0.5) / width * 2 * np.pi
    return elevation[:, None].astype(np.float32), azimuth[None].astype(np.float32)


def noise(rng, height, width, coarsest=8, octaves=5, gain=0.55):
    """Sum of octaves with mean 0, about within -1 and 1; periodic in azimuth."""
    out = np.zeros((height, width), np.float32)
    size, weight = coarsest, 1.0
    for _ in range(octaves):
        rows = max(2, int(size * height / width) + 1)
        small = rng.standard_normal((rows, size)).astype(np.float32)
        small = np.hstack([small, small[:, :1]])
        big = cv2.resize(small, (width + width // size, height), interpolation=cv2.INTER_CUBIC)
        out += weight * big[:, :width]
        size, weight = size * 2, weight * gain
    return out / 2


def colour(rng, saturation=0.25, low=0.05, high=0.8):
    value = np.exp(rng.uniform(np.log(low), np.log(high)))
    return (value * np.exp(saturation * rng.standard_normal(3) * 0.5)).astype(np.float32)


def warm(rng, low=0.1, high=0.7):
    """Colour of brick, sandstone or plaster: less blue than red."""
    value = np.exp(rng.uniform(np.log(low), np.log(high)))
    tint = rng.uniform(0, 0.7)
    return (value * np.array([1 - 0.75 * tint, 1 - 0.4 * tint, 1], np.float32)).astype(np.float32)


def clouds(rng, elevation, azimuth, size):
    """Cloud cover from 0 to 1, on a flat layer far above, from a square of noise."""
    side = 1024
    texture = noise(rng, side, side, int(rng.integers(3, 9)), 7, rng.uniform(0.45, 0.62))
    up = np.maximum(np.sin(elevation), 0.0) + rng.uniform(0.05, 0.2)
    x = np.cos(elevation) * np.sin(azimuth) / up * size + 7.3
    y = np.cos(elevation) * np.cos(azimuth) / up * size + 5.1
    # Mirrored at the square's sides for continuity.
    fold = lambda a: np.abs((a % 2) - 1) * (side - 1)
    layer = cv2.remap(texture, fold(x).astype(np.float32), fold(y).astype(np.float32), cv2.INTER_LINEAR)
    level = rng.uniform(-0.5, 0.7)
    return np.clip((layer - level) / rng.uniform(0.15, 0.9), 0, 1)


def sky(rng, height=HEIGHT, width=WIDTH):
    e, a = grid(height, width)
    e = np.repeat(e, width, 1)
    a = np.repeat(a, height, 0)
    up = np.clip(np.sin(e), 0, 1)
    kind = rng.choice(["clear", "clouds", "overcast", "dusk", "haze"], p=[0.22, 0.33, 0.27, 0.08, 0.10])
    blue = np.array([1.0, rng.uniform(0.5, 0.72), rng.uniform(0.2, 0.5)], np.float32)
    pale = np.array([1.0, rng.uniform(0.88, 1.0), rng.uniform(0.72, 0.98)], np.float32)
    t = (up ** rng.uniform(0.3, 0.8))[..., None]
    zenith = blue * rng.uniform(0.35, 0.9)
    horizon = pale * rng.uniform(0.75, 1.3)
    out = horizon * (1 - t) + zenith * t
    sun_e, sun_a = rng.uniform(-0.1, 1.2), rng.uniform(0, 2 * np.pi)
    cosine = np.sin(e) * np.sin(sun_e) + np.cos(e) * np.cos(sun_e) * np.cos(a - sun_a)
    apart = np.arccos(np.clip(cosine, -1, 1))
    if kind == "overcast":
        base = np.array([1, 1, 1], np.float32) * (1 + 0.06 * rng.standard_normal(3).astype(np.float32))
        shade = 1 + rng.uniform(-0.4, 0.4) * (up - 0.5) + rng.uniform(0, 0.25) * noise(rng, height, width, 4, 5)
        shade += rng.uniform(0, 0.3) * (clouds(rng, e, a, rng.uniform(0.1, 0.6)) - 0.5)
        out = base * np.maximum(shade, 0.1)[..., None] * rng.uniform(0.7, 1.3)
        out = out + rng.uniform(0, 1.2) * np.exp(-apart / rng.uniform(0.2, 0.7))[..., None]
    elif kind == "dusk":
        orange = np.array([0.35, 0.6, 1.0], np.float32) * rng.uniform(0.5, 1.5)
        out = out * rng.uniform(0.3, 0.8) + orange * np.exp(-up * rng.uniform(3, 8) - apart)[..., None]
    elif kind == "haze":
        out = pale * rng.uniform(0.7, 1.2) * (1 + 0.15 * (0.5 - up))[..., None]
    if kind in ("clear", "clouds", "dusk", "haze"):
        glow = rng.uniform(0.2, 2.0) * np.exp(-apart / rng.uniform(0.08, 0.5))
        disk = rng.uniform(5, 40) * np.exp(-(apart / 0.035) ** 2)
        out = out + (glow + disk)[..., None] * np.array([0.9, 0.97, 1.0], np.float32)
    if kind in ("clouds", "dusk") or (kind == "clear" and rng.random() < 0.25):
        for _ in range(int(rng.integers(1, 3))):
            cover = clouds(rng, e, a, rng.uniform(0.08, 0.7))[..., None] * rng.uniform(0.4, 1.0)
            dark = clouds(rng, e, a, rng.uniform(0.2, 0.8))[..., None]
            white = rng.uniform(0.8, 1.6) * (1 - rng.uniform(0, 0.6) * dark)
            tone = np.array([1, 1, 1], np.float32) * (1 + 0.04 * rng.standard_normal(3).astype(np.float32))
            out = out * (1 - cover) + white * tone * cover
    return np.clip(out, 0.002, 60).astype(np.float32)
