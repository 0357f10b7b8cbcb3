# SPDX-License-Identifier: Apache-2.0
"""Simulated phone pictures from panoramas: any lens, attitude, weather, tone curve and compression."""
import cv2
import numpy as np

ENCODED = 60.0  # linear light at the maximum of the 16-bit square-root encoding


def encode(linear):
    return np.clip(np.sqrt(np.clip(linear, 0, ENCODED) / ENCODED) * 65535, 0, 65535).astype(np.uint16)


class Panorama:
    """image: linear light; sky: 0 to 255; known: 255 where there is a label."""

    def __init__(self, image, sky, known=None, indoors=False, name=""):
        self.image, self.sky, self.indoors, self.name = encode(image), sky, indoors, name
        self.known = np.full(sky.shape, 255, np.uint8) if known is None else known

    def sky_alone(self):
        """The sky, extended downwards over objects in front of it, encoded; None where there is too little."""
        clear = (self.sky > 250) & (self.known > 250)
        if self.indoors or clear[: clear.shape[0] // 2].mean() < 0.5:
            return None
        out = self.image.copy()
        last = np.zeros((clear.shape[1], 3), np.uint16)
        last[:] = np.median(out[clear], 0)
        for y in range(clear.shape[0]):
            last[clear[y]] = out[y][clear[y]]
            out[y] = last
        low = clear.shape[0] // 2
        out[low:] = cv2.GaussianBlur(out, (0, 0), 9)[low:]
        return out


def lens(rng, width, height):
    """Unit rays (x right, y down, z ahead) of the pixels, and the mask of valid pixels."""
    longer = max(width, height)
    # Small pictures are sometimes crops of larger ones, so that objects have the same size as in the network's use.
    whole = longer * rng.uniform(1, max(1.0, 320 / longer)) if rng.random() < 0.7 else longer
    off = rng.uniform(-0.5, 0.5, 2) * (whole - longer) + rng.uniform(-0.03, 0.03, 2) * longer
    x = np.arange(width, dtype=np.float32) - (width - 1) / 2 + off[0]
    y = (np.arange(height, dtype=np.float32) - (height - 1) / 2 + off[1])[:, None]
    x, y = np.broadcast_arrays(x[None], y)
    if rng.random() < 0.6:
        focal = whole / 2 / np.tan(np.radians(rng.uniform(42, 104)) / 2)
        ray = np.stack([x / focal, y / focal, np.ones_like(x)], -1)
        ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
        return ray.astype(np.float32), np.ones((height, width), bool)
    focal = whole * rng.uniform(0.28, 0.5)
    if rng.random() < 0.35:
        focal = min(width, height) * whole / longer / np.pi * rng.uniform(0.95, 1.1)  # the whole image circle in the picture
    radius = np.hypot(x, y)
    angle = radius / focal
    bend = rng.uniform(-0.02, 0.03)
    angle = angle * (1 + bend * np.minimum(angle, 1.7) ** 2)
    scale = np.where(radius > 1e-3, np.sin(angle) / np.maximum(radius, 1e-3), 1 / focal)
    ray = np.stack([x * scale, y * scale, np.cos(angle)], -1).astype(np.float32)
    return ray, angle < rng.uniform(1.45, 1.57)


def turn(axis, angle):
    return cv2.Rodrigues(np.asarray(axis, float) * angle)[0]


def attitude(rng):
    """Rotation from the camera to the world (x east, y north, z up)."""
    kind = rng.random()
    if kind < 0.42:
        pitch = rng.normal(0.05, 0.16)
    elif kind < 0.62:
        pitch = rng.uniform(0.2, 1.1)
    elif kind < 0.93:
        pitch = np.pi / 2 - abs(rng.normal(0, 0.22))
    else:
        pitch = rng.uniform(-0.6, 1.57)
    roll = rng.normal(0, 0.08)
    if pitch > 1.0 or rng.random() < 0.2:
        roll += rng.integers(0, 4) * np.pi / 2 + (rng.uniform(-0.8, 0.8) if pitch > 1.0 else 0)
    upright = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)  # x right, y down, z ahead of a camera that faces north
    return turn([0, 0, 1], rng.uniform(0, 2 * np.pi)) @ turn([1, 0, 0], pitch) @ upright @ turn([0, 0, 1], roll)


def look_up(plane, ray):
    height, width = plane.shape[:2]
    azimuth = np.arctan2(ray[..., 0], ray[..., 1]) % (2 * np.pi)
    elevation = np.arcsin(np.clip(ray[..., 2], -1, 1))
    u = azimuth / (2 * np.pi) * width - 0.5
    v = (0.5 - elevation / np.pi) * height - 0.5
    return cv2.remap(plane, u.astype(np.float32), np.clip(v, 0, height - 1).astype(np.float32), cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)


def linear(encoded):
    return (encoded.astype(np.float32) / 65535) ** 2 * ENCODED


def weather(rng, image, sky, behind):
    """Replaces the sky by another, lit independently."""
    front = (image * (1 - sky)[..., None]).sum((0, 1)).mean() / max(1.0, (1 - sky).sum())
    back = behind.mean() + 1e-4
    behind = behind * (front + 0.02) / back * np.exp(rng.normal(np.log(3.0), 0.8))
    return image * (1 - sky)[..., None] + behind * sky[..., None]


def develop(rng, image):
    """8-bit blue, green, red from linear light, with a phone's image processing."""
    mean = np.exp(np.log(image.mean(-1) + 1e-4).mean()) if rng.random() < 0.5 else image.mean()
    image = image * (np.exp(rng.normal(np.log(0.22), 0.55)) / max(mean, 1e-5))
    image = image * np.exp(rng.normal(0, 0.09, 3)).astype(np.float32)
    if rng.random() < 0.35:  # stray light
        bright = cv2.resize(cv2.GaussianBlur(np.minimum(cv2.resize(image, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA), 6), (0, 0), rng.uniform(2, 9)), image.shape[1::-1])
        image = image + rng.uniform(0, 0.25) * bright
    if rng.random() < 0.15:
        image = image * (1 - rng.uniform(0, 0.3)) + rng.uniform(0, 0.4)  # haze
    shoulder = rng.uniform(0, 1.2)
    image = image * (1 + shoulder) / (1 + shoulder * image)
    image = np.clip(image, 0, 1) ** (1 / rng.uniform(1.7, 2.6))
    if rng.random() < 0.5:
        s = rng.uniform(-0.3, 0.6)
        image = image + s * image * (1 - image) * (2 * image - 1)
    grey = image.mean(-1, keepdims=True)
    image = grey + (image - grey) * rng.uniform(0.5, 1.5)
    image = image * 255
    if rng.random() < 0.5:
        image = cv2.GaussianBlur(image, (0, 0), rng.uniform(0.3, 1.3))
    if rng.random() < 0.15:
        image = cv2.addWeighted(image, 1.6, cv2.GaussianBlur(image, (0, 0), 1.0), -0.6, 0)
    image = image + rng.uniform(0, 6) * rng.standard_normal(image.shape, np.float32)
    image = np.clip(image, 0, 255).astype(np.uint8)
    if rng.random() < 0.6:
        image = cv2.imdecode(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, int(rng.uniform(25, 95))])[1], cv2.IMREAD_COLOR)
    return image


def planes_of(rng, picture, elevation, valid, small):
    """Input planes of the network (docs/sky_network.md), and Y, Cb, Cr in full; 1 is 64 steps of Y, 32 of Cb and Cr."""
    y, cr, cb = cv2.split(cv2.cvtColor(picture, cv2.COLOR_BGR2YCrCb))
    large = np.stack([(y.astype(np.float32) - 128) / 64, (cb.astype(np.float32) - 128) / 32, (cr.astype(np.float32) - 128) / 32])
    if rng.random() < 0.35:
        large[1:] = 0
    shrink = lambda plane: cv2.resize(plane, small, interpolation=cv2.INTER_AREA)
    planes = [shrink(p) for p in large] + [shrink(valid.astype(np.float32)), shrink(elevation.astype(np.float32))]
    return np.stack(planes), large


def view(rng, panorama, skies, small, factor=2):
    """(planes, Y Cb Cr, sky, weight) of a random picture; `small`: columns and rows of the network's grid."""
    width, height = small[0] * factor, small[1] * factor
    ray, valid = lens(rng, width, height)
    R = attitude(rng)
    world = ray @ R.T.astype(np.float32)
    if rng.random() < 0.5:
        world = world * np.array([-1, 1, 1], np.float32)
    image = linear(look_up(panorama.image, world))
    sky = look_up(panorama.sky, world).astype(np.float32) / 255
    weight = (look_up(panorama.known, world) > 200).astype(np.float32)
    if not panorama.indoors and rng.random() < 0.55:
        spin = turn([0, 0, 1], rng.uniform(0, 2 * np.pi)).astype(np.float32)
        behind = linear(look_up(skies[rng.integers(len(skies))], world @ spin))
        image = weather(rng, image, sky, behind)
    if rng.random() < 0.3:  # objects are darker or brighter than in the panorama
        image = image * (sky + (1 - sky) * np.float32(np.exp(rng.normal(0, 0.6))))[..., None]
    picture = develop(rng, image)
    if not valid.all():
        picture[~valid] = rng.choice([0, 0, 16, 128]) + rng.integers(0, 8, ((~valid).sum(), 3)).astype(np.uint8)
    return finish(rng, picture, ray, R, valid, sky, weight, small)


def finish(rng, picture, ray, R, valid, sky, weight, small):
    up = R.T @ np.array([0, 0, 1.0])
    error = 0.05 if rng.random() < 0.9 else 0.2
    up = turn(np.append(rng.standard_normal(3), 0)[:3] / 1.7, rng.normal(0, error)) @ up
    elevation = (ray @ up.astype(np.float32)).astype(np.float32)
    if rng.random() < 0.05:
        elevation = np.zeros_like(elevation)  # no attitude
    planes, large = planes_of(rng, picture, elevation, valid, small)
    planes[4] *= planes[3]
    return planes, large, sky, weight * valid


def rays_of_rendered(fisheye, focal):
    """Unit rays and angles from the optical axis of the simulator's pictures, 640 x 480."""
    x = (np.arange(640, dtype=np.float32) - 319.5)[None].repeat(480, 0)
    y = (np.arange(480, dtype=np.float32) - 239.5)[:, None].repeat(640, 1)
    r = np.hypot(x, y)
    angle = r / focal if fisheye else np.arctan(r / focal)
    scale = np.sin(angle) / np.maximum(r, 1e-3)
    return np.stack([x * scale, y * scale, np.cos(angle)], -1), angle


def upright(pitch):
    """Rotation to the world from a camera that faces north with this pitch."""
    return turn([1, 0, 0], pitch) @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)


def sunlight(rng, ray):
    """Brightness factor of walls over the simulator's: up to that of the sky, in half of the pictures on one side."""
    walls = rng.uniform(np.log(0.6), np.log(2.6))
    if rng.random() < 0.5:
        to = rng.uniform(0, 2 * np.pi)
        side = (ray[..., 0] * np.cos(to) + ray[..., 1] * np.sin(to) - rng.uniform(-0.3, 0.5)) * rng.uniform(4, 30)
        walls = rng.uniform(np.log(0.5), np.log(1.3)) + rng.uniform(0.2, 1.4) / (1 + np.exp(-np.clip(side, -30, 30)))
    return np.exp(walls, dtype=np.float32)


def rendered(rng, grey, label, fisheye, focal, pitch, small, factor=2):
    """A view from a picture of the simulator, 640 x 480, with its label."""
    size = (small[0] * factor, small[1] * factor)
    ray, angle = rays_of_rendered(fisheye, focal)
    if rng.random() < 0.5:
        grey, label, ray = grey[:, ::-1], label[:, ::-1], ray[:, ::-1]
    ray, valid = cv2.resize(np.ascontiguousarray(ray), size), cv2.resize(angle, size) < 1.52
    sky = cv2.resize(np.ascontiguousarray(label), size, interpolation=cv2.INTER_AREA).astype(np.float32) / 240
    image = cv2.resize(np.ascontiguousarray(grey), size, interpolation=cv2.INTER_AREA).astype(np.float32) / 255
    image = image * (sky + (1 - sky) * sunlight(rng, ray))
    image = image * np.exp(rng.normal(0, 0.12))
    picture = np.clip(255 * np.clip(image, 0, 1) ** rng.uniform(0.75, 1.3) + rng.uniform(0, 4) * rng.standard_normal(image.shape), 0, 255).astype(np.uint8)
    picture = cv2.merge([picture] * 3)
    sky = np.clip(sky, 0, 1)
    return finish(rng, picture, ray, upright(pitch), valid, sky, np.ones_like(sky), small)
