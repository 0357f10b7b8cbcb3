# SPDX-License-Identifier: Apache-2.0
"""Random streets, rooms and skies as panoramas: training data of fix/skyline's network besides photographs.

A panorama is equirectangular, in linear light (blue, green, red), with the sky fraction of each pixel. Rows go from the
zenith down, columns clockwise. All random numbers come from a numpy Generator.
"""
import cv2
import numpy as np

from skies import HEIGHT, WIDTH, colour, grid, noise, sky, warm


class Canvas:
    """A panorama, painted from far to near."""

    def __init__(self, rng, background, eye):
        self.rng, self.eye = rng, eye
        self.image = background.astype(np.float32).copy()
        self.sky = np.ones((HEIGHT, WIDTH), np.float32)
        self.elevation, self.azimuth = grid()
        self.e1, self.a1 = self.elevation[:, 0], self.azimuth[0]
        self.sun = rng.uniform(0, 2 * np.pi)
        self.sunny = rng.random() < 0.5

    def put(self, rows, columns, paint, part):
        block = np.ix_(rows, columns)
        keep = part[..., None]
        self.image[block] = self.image[block] * (1 - keep) + paint * keep
        self.sky[block] *= 1 - part

    def wall(self, p, q, z0, z1, texture):
        """A vertical wall from p to q (x east, y north), between two heights above the ground."""
        p, q = np.asarray(p, float), np.asarray(q, float)
        along = q - p
        length = np.hypot(*along)
        direction = np.stack([np.sin(self.a1), np.cos(self.a1)], 1)
        # p + s along = d direction
        cross = direction[:, 0] * along[1] - direction[:, 1] * along[0]
        with np.errstate(all="ignore"):
            d = (p[0] * along[1] - p[1] * along[0]) / cross
            s = -(direction[:, 0] * p[1] - direction[:, 1] * p[0]) / cross
        s = np.where(np.isfinite(s), s, -1)
        columns = np.flatnonzero((d > 0.3) & (s >= 0) & (s <= 1) & np.isfinite(d))
        if len(columns) == 0:
            return
        d, s = d[columns], s[columns] * length
        low, high = np.arctan((z0 - self.eye) / d), np.arctan((z1 - self.eye) / d)
        top, bottom = high.max(), low.min()
        rows = np.flatnonzero((self.e1 <= top + 0.01) & (self.e1 >= bottom - 0.01))
        if len(rows) == 0:
            return
        z = self.eye + d[None] * np.tan(np.clip(self.e1[rows], -1.55, 1.55))[:, None]
        pixel = d[None] * (np.pi / HEIGHT) / np.maximum(np.cos(self.e1[rows]), 0.05)[:, None] ** 2
        part = np.clip((z1 - z) / pixel + 0.5, 0, 1) * np.clip((z - z0) / pixel + 0.5, 0, 1)
        normal = np.arctan2(along[1], -along[0])
        lit = 1.0
        if self.sunny:
            lit = 0.55 + rng_lit(self.sun, normal) * 1.6
        paint = texture(np.broadcast_to(s[None], z.shape), z - z0, z1 - z0, pixel) * lit
        self.put(rows, columns, paint, part.astype(np.float32))

    def box(self, centre, size, turn, z0, z1, texture):
        c, s = np.cos(turn), np.sin(turn)
        corner = [np.array([centre[0] + c * x * size[0] / 2 - s * y * size[1] / 2,
                            centre[1] + s * x * size[0] / 2 + c * y * size[1] / 2])
                  for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        walls = [(corner[i], corner[(i + 1) % 4]) for i in range(4)]
        walls.sort(key=lambda w: -np.hypot(*(w[0] + w[1])))
        for p, q in walls:
            self.wall(p, q, z0, z1, texture)

    def strokes(self, points, width_px, tone):
        """Draws a thin object, dark or bright, through directions (azimuth, elevation)."""
        xy = np.array([(a / (2 * np.pi) * WIDTH, (0.5 - e / np.pi) * HEIGHT) for a, e in points])
        for i in range(len(xy) - 1):
            low = np.floor(np.minimum(xy[i], xy[i + 1]) - width_px - 2).astype(int)
            high = np.ceil(np.maximum(xy[i], xy[i + 1]) + width_px + 3).astype(int)
            low, high = np.maximum(low, 0), np.minimum(high, (WIDTH, HEIGHT))
            if (high <= low).any() or high[0] - low[0] > WIDTH // 2:
                continue
            layer = np.zeros((high[1] - low[1], high[0] - low[0]), np.uint8)
            ends = [tuple(int(round(16 * v)) for v in p - low) for p in xy[i:i + 2]]
            cv2.line(layer, ends[0], ends[1], 255, max(1, int(width_px)), cv2.LINE_AA, 4)
            self.blend(low, high, tone, layer.astype(np.float32) / 255 * min(1.0, width_px))

    def blend(self, low, high, paint, part):
        """As put, for a rectangle of pixels."""
        block = (slice(low[1], high[1]), slice(low[0], high[0]))
        self.image[block] += (paint - self.image[block]) * part[..., None]
        self.sky[block] *= 1 - part


def rng_lit(sun, normal):
    return max(0.0, np.cos(sun - normal))


def facade(rng, mirrored):
    """Texture of a wall: windows in rows, of a random style; `mirrored`: the reflection in glass, a colour from bottom to top."""
    style = rng.choice(["punched", "glass", "bands", "plain", "brick"], p=[0.4, 0.17, 0.13, 0.12, 0.18])
    base = warm(rng) if rng.random() < 0.6 else colour(rng, 0.2, 0.06, 0.9)
    if rng.random() < 0.15:
        base = np.full(3, rng.uniform(0.7, 1.1), np.float32)  # white walls
    width, floor = rng.uniform(1.2, 4.5), rng.uniform(2.7, 4.0)
    w, h = rng.uniform(0.3, 0.75), rng.uniform(0.35, 0.75)
    pane = rng.uniform(0.0, 1.0) ** 2
    dark, lightness = rng.uniform(0.02, 0.15), rng.uniform(0.2, 1.0)
    grain = rng.uniform(0.02, 0.25)
    seed = int(rng.integers(1 << 30))
    frame = base * rng.uniform(0.3, 2.0)
    shop = rng.random() < 0.4

    def texture(s, z, top, pixel):
        local = np.random.default_rng(seed)
        rows, columns = s.shape
        sharp = np.clip(1.5 - pixel / 0.6, 0, 1)[..., None]
        spots = cv2.resize(local.standard_normal((max(2, rows // 3), max(2, columns // 3))).astype(np.float32), (columns, rows))
        fine = local.standard_normal((rows, columns)).astype(np.float32)
        out = base * (1 + grain * (0.6 * spots + 0.4 * fine))[..., None]
        out = out * (0.85 + 0.15 * np.clip(z / 6, 0, 1))[..., None]
        if style == "plain":
            return out
        if style == "brick":
            out = out * (1 - 0.25 * ((z % 0.5) < 0.1))[..., None] if pixel.min() < 0.2 else out
        u, v = (s / width) % 1, (z / floor) % 1
        cell = (np.floor(s / width) * 7.13 + np.floor(z / floor) * 3.77)
        each = (np.sin(cell * 12.9898 + seed % 97) * 43758.5453) % 1
        if style == "glass":
            inside = (np.abs(u - 0.5) < 0.46) & (np.abs(v - 0.5) < 0.44)
        elif style == "bands":
            inside = np.abs(v - 0.55) < h / 2
        else:
            inside = (np.abs(u - 0.5) < w / 2) & (np.abs(v - 0.55) < h / 2)
        inside = inside & (z < top - 0.6)
        if shop:
            inside = inside | ((z > 0.4) & (z < 2.6) & (np.abs(u - 0.5) < 0.45))
        glass = mirrored(z / max(top, 1)) * lightness
        shown = np.where((each < pane)[..., None], glass, dark * (0.5 + each)[..., None] * np.ones(3, np.float32))
        edge = (np.abs(np.abs(u - 0.5) - w / 2) < 0.05)[..., None] & inside[..., None]
        shown = np.where(edge, frame, shown)
        mean = inside.mean()
        blurred = out * (1 - mean) + shown.mean((0, 1)) * mean
        return np.where(inside[..., None], shown, out) * sharp + blurred * (1 - sharp)

    return texture


def leaves(rng, canvas, azimuth, distance, height):
    """A tree: a crown of many small blobs, with gaps, and its trunk and branches."""
    crown = height * rng.uniform(0.25, 0.5)
    bare = rng.random() < 0.22
    bark = colour(rng, 0.1, 0.02, 0.12)
    base_e = np.arctan2(-canvas.eye, distance)
    fork_e = np.arctan2(height * rng.uniform(0.25, 0.5) - canvas.eye, distance)
    px = WIDTH / (2 * np.pi)
    trunk = max(1.0, 0.35 * height / 10 / distance * px)
    canvas.strokes([(azimuth, base_e), (azimuth, fork_e)], trunk, bark)

    def branch(a, e, angle, length, width, depth):
        a2, e2 = a + np.sin(angle) * length / max(0.3, np.cos(e)), e + np.cos(angle) * length
        if e2 > 1.45:
            return
        canvas.strokes([(a, e), (a2, e2)], max(0.4, width), bark)
        if depth:
            for _ in range(2 if depth > 1 else 3):
                branch(a2, e2, angle + rng.uniform(-0.8, 0.8), length * rng.uniform(0.6, 0.85), width * 0.6, depth - 1)

    reach = crown / distance
    branch(azimuth, fork_e, rng.uniform(-0.2, 0.2), reach * 0.7, trunk * 0.7, 4 if bare else 2)
    if bare:
        return
    green = np.array([rng.uniform(0.02, 0.12), rng.uniform(0.1, 0.3), rng.uniform(0.04, 0.22)], np.float32)
    green *= np.exp(rng.uniform(-0.9, 0.7))
    if rng.random() < 0.15:
        green = green[[0, 2, 1]] * np.array([0.7, 0.8, 1.6], np.float32)  # autumn
    count = int(rng.integers(150, 900))
    layer = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    part = np.zeros((HEIGHT, WIDTH), np.uint8)
    size = rng.uniform(0.25, 0.9) * height / 10 / distance * px
    middle_e = np.arctan2(height - crown - canvas.eye, distance)
    for k in range(count):
        r = rng.standard_normal(3) * 0.45
        e = middle_e + r[0] * reach * rng.uniform(0.8, 1.3)
        if e > 1.4:
            continue
        a = azimuth + r[1] * reach / max(0.25, np.cos(e))
        x, y = (a / (2 * np.pi) * WIDTH) % WIDTH, (0.5 - e / np.pi) * HEIGHT
        tone = green * np.float32(np.exp(0.45 * r[0] + 0.4 * rng.standard_normal()))
        radius = (max(0.6, size * rng.uniform(0.4, 1.3) / max(0.3, np.cos(e))), max(0.6, size * rng.uniform(0.4, 1.3)))
        axes = tuple(int(round(16 * v)) for v in radius)
        at = (int(round(16 * x)), int(round(16 * y)))
        cv2.ellipse(layer, at, axes, 0, 0, 360, tone.tolist(), -1, cv2.LINE_8, 4)
        cv2.ellipse(part, at, axes, 0, 0, 360, 255, -1, cv2.LINE_AA, 4)
    x, y, w, h = cv2.boundingRect(part)
    if w == 0:
        return
    layer, part = layer[y:y + h, x:x + w], part[y:y + h, x:x + w].astype(np.float32) / 255
    layer *= (1 + 0.35 * rng.standard_normal((h, w)).astype(np.float32))[..., None].clip(0.3, 2)
    canvas.blend((x, y), (x + w, y + h), layer, part)


def roof(rng, canvas, centre, size, turn, z, texture_of_wall):
    """A pitched or stepped roof, chimneys, aerials, panels: smaller boxes and lines on top."""
    tile = warm(rng, 0.05, 0.35) if rng.random() < 0.6 else colour(rng, 0.1, 0.05, 0.5)
    if rng.random() < 0.12:
        tile = np.array([0.35, 0.25, 0.2], np.float32) * rng.uniform(0.3, 2.5)  # panels that reflect the sky

    def plain(s, zz, top, pixel):
        lines = 0.9 + 0.1 * ((zz % 0.6) < 0.3)
        return tile * (lines * (1 + 0.1 * np.random.default_rng(1).standard_normal(s.shape)))[..., None]

    if rng.random() < 0.6:
        steps = int(rng.integers(3, 7))
        rise = rng.uniform(1.5, 5)
        for k in range(steps):
            shrink = 1 - (k + 1) / (steps + 0.6)
            canvas.box(centre, (size[0], size[1] * shrink), turn, z + rise * k / steps, z + rise * (k + 1) / steps, plain)
        z += rise * 0.7
    for _ in range(int(rng.integers(0, 4))):
        offset = rng.uniform(-0.4, 0.4, 2) * np.asarray(size)
        at = np.asarray(centre) + np.array([np.cos(turn) * offset[0] - np.sin(turn) * offset[1], np.sin(turn) * offset[0] + np.cos(turn) * offset[1]])
        canvas.box(at, rng.uniform(0.5, 2.0, 2), turn, z, z + rng.uniform(0.6, 2.5), plain)
        if rng.random() < 0.4:
            d = np.hypot(*at)
            a = np.arctan2(at[0], at[1])
            e0 = np.arctan2(z - canvas.eye, d)
            canvas.strokes([(a, e0), (a, np.arctan2(z + rng.uniform(1, 6) - canvas.eye, d))], rng.uniform(0.4, 1.0), colour(rng, 0.1, 0.03, 0.4))


def ground(rng, canvas):
    e, a = canvas.elevation, canvas.azimuth
    rows = np.flatnonzero(canvas.e1 < 0)
    base = colour(rng, 0.08, 0.06, 0.5) if rng.random() < 0.75 else np.array([0.05, 0.18, 0.1], np.float32) * rng.uniform(0.5, 2)
    if rng.random() < 0.06:
        base = np.full(3, 0.9, np.float32)  # snow
    paint = base * (1 + 0.3 * noise(rng, HEIGHT, WIDTH, 16, 6, 0.7))[..., None].clip(0.3, 2)
    d = canvas.eye / np.maximum(np.tan(-np.minimum(e, -0.004)), 1e-3)
    x, y = d * np.sin(a), d * np.cos(a)
    turn = rng.uniform(0, np.pi)
    across = x * np.cos(turn) + y * np.sin(turn)
    ahead = -x * np.sin(turn) + y * np.cos(turn)
    line = (np.abs(across - rng.uniform(-4, 4)) < 0.12) & ((ahead % 6) < 3)
    paint[line] = rng.uniform(0.5, 1.0)
    if rng.random() < 0.5:
        walk = np.abs(across) > rng.uniform(3, 8)
        paint[walk] *= np.exp(rng.uniform(-0.6, 0.6))
    if rng.random() < 0.1:  # wet: it reflects
        paint = 0.6 * paint + rng.uniform(0.1, 0.5) * canvas.image[::-1]
    haze = np.clip(-e * 40, 0, 1)[..., None]
    paint = paint * haze + paint.mean((0, 1)) * (1 - haze)
    canvas.put(rows, np.arange(WIDTH), paint[rows], np.ones((len(rows), WIDTH), np.float32))


def street(rng):
    """(image, sky fraction) of a random outdoor place."""
    behind = sky(rng)
    canvas = Canvas(rng, behind, rng.choice([1.2, 1.6, 1.6, 2.0, rng.uniform(2, 12)]))
    up_mean = behind[: HEIGHT // 3].mean((0, 1))
    low_mean = behind[HEIGHT // 3: HEIGHT // 2].mean((0, 1))
    mirrored = lambda t: (low_mean * (1 - np.clip(t, 0, 1))[..., None] + up_mean * np.clip(t, 0, 1)[..., None])
    ground(rng, canvas)
    place = rng.choice(["street", "square", "suburb", "park", "towers"], p=[0.4, 0.15, 0.2, 0.1, 0.15])
    turn = rng.uniform(0, 2 * np.pi)
    things = []
    half = {"street": rng.uniform(4, 14), "square": rng.uniform(18, 60), "suburb": rng.uniform(8, 20), "park": rng.uniform(30, 90), "towers": rng.uniform(10, 30)}[place]
    tall = {"street": 14, "square": 14, "suburb": 7, "park": 12, "towers": 45}[place]
    for side in (-1, 1):
        at = -rng.uniform(80, 160)
        while at < 160:
            length = rng.uniform(6, 30) * (1.4 if place == "towers" else 1)
            height = max(3.0, tall * np.exp(0.4 * rng.standard_normal()))
            depth = rng.uniform(8, 18)
            if rng.random() < (0.9 if place == "street" else 0.6):
                set_back = half + depth / 2 + (rng.uniform(0, 4) if rng.random() < 0.3 else 0)
                things.append(("house", at + length / 2, side * set_back, (length, depth), height))
            at += length + (rng.uniform(2, 15) if rng.random() < 0.35 else 0)
    for _ in range(int(rng.integers(2, 14))):
        r, t = rng.uniform(60, 400), rng.uniform(0, 2 * np.pi)
        things.append(("house", r * np.cos(t), r * np.sin(t), (rng.uniform(10, 40), rng.uniform(10, 40)), rng.uniform(8, 60)))
    trees = int(rng.integers(0, 9)) if rng.random() < 0.6 else 0
    trees = trees + 8 if place == "park" else trees
    for _ in range(trees):
        side = rng.choice([-1, 1])
        things.append(("tree", rng.uniform(-50, 50), side * half * rng.uniform(0.4, 0.95), None, rng.uniform(4, 18)))
    for _ in range(int(rng.integers(0, 8))):
        things.append(("car", rng.uniform(-40, 40), rng.choice([-1, 1]) * max(2.5, half * rng.uniform(0.3, 0.8)), None, 1.5))
    for _ in range(int(rng.integers(0, 6))):
        things.append(("pole", rng.uniform(-50, 50), rng.choice([-1, 1]) * half * rng.uniform(0.5, 0.95), None, rng.uniform(3, 10)))
    things.sort(key=lambda t: -np.hypot(t[1], t[2]))
    for kind, x, y, size, height in things:
        at = np.array([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y])
        distance = max(2.0, np.hypot(*at))
        azimuth = np.arctan2(at[0], at[1]) % (2 * np.pi)
        if kind == "house":
            if distance < max(size) * 0.5 + 1.5:
                continue
            texture = facade(rng, mirrored)
            canvas.box(at, size, turn, -2, height, texture)
            roof(rng, canvas, at, size, turn, height, texture)
        elif kind == "tree":
            leaves(rng, canvas, azimuth, max(3.0, distance), height)
        elif kind == "car":
            body = colour(rng, 0.8, 0.03, 0.9)
            paint = lambda s, z, top, pixel: np.where(((z > 0.8) & (z < 1.3))[..., None], np.float32(0.08), body * (0.7 + 0.3 * np.clip(z, 0, 1))[..., None])
            canvas.box(at, (rng.uniform(3.5, 5), 1.8), turn, 0.2, height * rng.uniform(0.9, 1.6), paint)
        else:
            pole(rng, canvas, azimuth, distance, height)
    wires(rng, canvas)
    return canvas.image, canvas.sky


def pole(rng, canvas, azimuth, distance, height):
    px = WIDTH / (2 * np.pi) / distance
    tone = colour(rng, 0.1, 0.02, 0.5)
    top = np.arctan2(height - canvas.eye, distance)
    canvas.strokes([(azimuth, np.arctan2(-canvas.eye, distance)), (azimuth, top)], max(0.5, 0.15 * px), tone)
    if rng.random() < 0.5:  # a lamp or a sign
        reach = rng.uniform(-2, 2) / distance
        canvas.strokes([(azimuth, top), (azimuth + reach, top + rng.uniform(-0.01, 0.02))], max(0.5, 0.12 * px), tone)
        canvas.strokes([(azimuth + reach, top), (azimuth + reach * 1.2, top)], max(1, 0.3 * px), colour(rng, 0.8, 0.1, 1.0))


def wires(rng, canvas):
    for _ in range(int(rng.integers(0, 6)) if rng.random() < 0.4 else 0):
        a0, span = rng.uniform(0, 2 * np.pi), rng.uniform(0.5, 3.0)
        e0, e1, sag = rng.uniform(0.1, 1.2), rng.uniform(0.1, 1.2), rng.uniform(0, 0.2)
        t = np.linspace(0, 1, 24)
        points = [((a0 + span * k) % (2 * np.pi), e0 + (e1 - e0) * k - sag * 4 * k * (1 - k)) for k in t]
        canvas.strokes(points, rng.uniform(0.3, 1.2), colour(rng, 0.1, 0.01, 0.2))
    if rng.random() < 0.08:  # a crane
        a, e = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 0.8)
        tone = warm(rng, 0.1, 0.6)
        canvas.strokes([(a, 0), (a, e)], rng.uniform(1, 3), tone)
        canvas.strokes([((a - 0.15) % 6.28, e - 0.02), (a, e), ((a + rng.uniform(0.2, 0.6)) % 6.28, e + rng.uniform(-0.1, 0.1))], rng.uniform(0.8, 2), tone)


def room(rng):
    """(image, sky fraction 0) of a random room: walls, overexposed windows, a pale ceiling with lamps."""
    e, a = grid()
    eye, ceiling = rng.uniform(1.0, 1.7), rng.uniform(2.3, 4.5) if rng.random() < 0.8 else rng.uniform(5, 12)
    bright = np.float32(np.exp(rng.uniform(-0.8, 0.6)))
    tint = np.array([1, 1, 1], np.float32) * np.exp(0.12 * rng.standard_normal(3)).astype(np.float32)
    pale = np.full(3, rng.uniform(0.4, 0.95), np.float32) * tint
    canvas = Canvas(rng, np.ones((HEIGHT, WIDTH, 3), np.float32) * pale, eye)
    d = np.where(e > 0, ceiling - eye, eye) / np.maximum(np.tan(np.abs(e)), 1e-3)
    x, y = d * np.sin(a), d * np.cos(a)
    top = np.broadcast_to(e > 0, (HEIGHT, WIDTH))
    floor = (warm(rng, 0.08, 0.5) if rng.random() < 0.7 else colour(rng)) * (1 + 0.15 * noise(rng, HEIGHT, WIDTH, 16, 6, 0.7))[..., None]
    shade = (1 - rng.uniform(0, 0.5) * np.clip(np.hypot(x, y) / 8, 0, 1))[..., None]
    canvas.image = np.where(top[..., None], pale * shade, floor * shade).astype(np.float32)
    if rng.random() < 0.3:  # tiles or beams
        period = rng.uniform(0.5, 2.5)
        beam = top & (((x / period) % 1 < 0.06) | ((y / period) % 1 < rng.choice([0.0, 0.06])))
        canvas.image[beam] *= rng.uniform(0.4, 0.9)
    lamps = top & ((np.abs((x / rng.uniform(1.5, 4)) % 1 - 0.5) < rng.uniform(0.03, 0.15)) & (np.abs((y / rng.uniform(1.5, 4)) % 1 - 0.5) < rng.uniform(0.03, 0.25)))
    if rng.random() < 0.7:
        canvas.image[lamps] = rng.uniform(1.5, 12)
    size = rng.uniform(2, 8, 4)
    turn = rng.uniform(0, np.pi / 2)
    ring = [np.array([size[0], size[1]]), np.array([-size[2], size[1]]), np.array([-size[2], -size[3]]), np.array([size[0], -size[3]])]
    c, s = np.cos(turn), np.sin(turn)
    ring = [np.array([c * p[0] - s * p[1], s * p[0] + c * p[1]]) for p in ring]
    outside = np.array([1.1, 1.03, 1.0], np.float32) * rng.uniform(1.5, 8)
    view = sky(rng)[HEIGHT // 4].mean(0) * rng.uniform(0.5, 3)
    for k in range(4):
        tone = pale * rng.uniform(0.7, 1.0) if rng.random() < 0.6 else colour(rng, 0.5, 0.1, 0.9)
        windows = rng.random() < 0.45
        period, w, low, high = rng.uniform(1.2, 3.5), rng.uniform(0.3, 0.85), rng.uniform(0.0, 1.1), rng.uniform(1.8, 2.6)
        glass = outside if rng.random() < 0.6 else view
        art = rng.random() < 0.5
        hue = colour(rng, 0.8, 0.05, 0.7)

        def texture(u, z, height, pixel, tone=tone, windows=windows, period=period, w=w, low=low, high=high, glass=glass, art=art, hue=hue):
            out = tone * (0.8 + 0.2 * np.clip(z / 2.5, 0, 1))[..., None] * (1 + 0.03 * np.random.default_rng(3).standard_normal(u.shape))[..., None]
            v = (u / period) % 1
            if windows:
                inside = (np.abs(v - 0.5) < w / 2) & (z > low) & (z < high)
                bars = (np.abs(v - 0.5) < 0.015) | (np.abs(z - (low + high) / 2) < 0.03)
                out = np.where(inside[..., None], np.where(bars[..., None], tone * 0.6, glass), out)
                curtain = (np.abs(np.abs(v - 0.5) - w / 2) < 0.08) & (z < high + 0.2)
                out = np.where(curtain[..., None], hue, out)
            elif art:
                inside = (np.abs(v - 0.5) < 0.25) & (z > 1.1) & (z < 1.9)
                out = np.where(inside[..., None], hue, out)
            out = np.where((z < 0.1)[..., None], tone * 0.5, out)
            return out

        canvas.wall(ring[k], ring[(k + 1) % 4], 0, ceiling, texture)
    for _ in range(int(rng.integers(2, 9))):
        at = rng.uniform(-1, 1, 2) * size[:2] * 0.8
        if np.hypot(*at) < 0.9:
            continue
        tone = colour(rng, 0.6, 0.03, 0.8)
        paint = lambda u, z, height, pixel, tone=tone: tone * (0.75 + 0.25 * np.clip(z / max(height, 0.1), 0, 1))[..., None]
        canvas.box(at, rng.uniform(0.4, 1.8, 2), turn, 0, rng.uniform(0.4, 2.1), paint)
    return canvas.image * bright, np.zeros((HEIGHT, WIDTH), np.float32)
