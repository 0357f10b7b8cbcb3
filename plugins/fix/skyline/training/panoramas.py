# SPDX-License-Identifier: Apache-2.0
"""Labels the training photographs of fix/skyline's network, and writes them and the generated scenes for train_sky.py.

    panoramas.py photographs SOURCES DATA    SOURCES: the files that docs/sky_network.md lists, NAME.hdr, NAME.exr or NAME/posx.jpg ...
    panoramas.py scenes DATA FIRST LAST       scenes of scenes.py with these seeds; every sixth is a room

Each photograph is a whole sphere. A rule of its brightness and colour, chosen by inspection, labels the sky; where no rule
does, GrabCut is initialised from the horizon. Polygons of azimuth and elevation, degrees, mark areas without sky and
unlabelled areas.
"""
import os
import sys

os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
import cv2
import numpy as np

import scenes

HEIGHT, WIDTH = 768, 1536
FACES = ("posx", "negx", "posy", "negy", "posz", "negz")


def read_cube(folder, height):
    """Converts six faces of a cube to one picture in linear light."""
    faces = {face: cv2.imread(f"{folder}/{face}.jpg") for face in FACES}
    elevation, azimuth = scenes.grid(height, 2 * height)
    azimuth = azimuth - np.pi
    x, y, z = np.broadcast_arrays(np.cos(elevation) * np.sin(azimuth), np.sin(elevation), -np.cos(elevation) * np.cos(azimuth))
    which = {"posx": (x, -z, -y), "negx": (-x, z, -y), "posy": (y, x, z), "negy": (-y, x, -z), "posz": (z, x, -y), "negz": (-z, -x, -y)}
    depth = np.maximum(np.maximum(abs(x), abs(y)), abs(z))
    out = np.zeros((height, 2 * height, 3), np.uint8)
    for face, (d, u, v) in which.items():
        here = d >= depth
        side = faces[face].shape[0]
        with np.errstate(all="ignore"):
            at = [((a / d + 1) / 2 * side - 0.5).astype(np.float32) for a in (u, v)]
        out[here] = cv2.remap(faces[face], *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)[here]
    return (out.astype(np.float32) / 255) ** 2.2


def read(sources, name):
    """(linear light, whether it is high dynamic range)"""
    for file in (f"{sources}/{name}.hdr", f"{sources}/{name}.exr"):
        if os.path.exists(file):
            return cv2.imread(file, cv2.IMREAD_ANYDEPTH | cv2.IMREAD_COLOR).clip(0), True
    return read_cube(f"{sources}/{name}", 1024), False


def shown(linear):
    """8-bit picture for GrabCut and for display."""
    light = np.log(linear.mean(-1) + 1e-4)
    x = linear / (np.exp(light[int(0.2 * len(light)): int(0.6 * len(light))].mean()) * 2.2)
    return (np.clip(x / (1 + 0.6 * x) * 1.3, 0, 1) ** (1 / 2.2) * 255).astype(np.uint8)


def grab_cut(picture, elevation):
    mask = np.full((HEIGHT, WIDTH), cv2.GC_PR_BGD, np.uint8)
    mask[elevation > 0] = cv2.GC_PR_FGD
    mask[elevation > 50] = cv2.GC_FGD
    mask[elevation < -3] = cv2.GC_BGD
    dark = cv2.cvtColor(picture, cv2.COLOR_BGR2HSV)[..., 2] < 70
    mask[dark & (elevation > 0)] = cv2.GC_PR_BGD
    cv2.grabCut(picture, mask, None, np.zeros((1, 65)), np.zeros((1, 65)), 3, cv2.GC_INIT_WITH_MASK)
    return (mask == cv2.GC_FGD) | (mask == cv2.GC_PR_FGD)


# For each: a rule of L (logarithm of the brightness), B (logarithm of blue over red) and E (elevation, degrees), or None
# for GrabCut; the lowest elevation; polygons without sky; the largest hole that is filled, pixels; unlabelled polygons.
OUTDOORS = {
    "city": (lambda L, B, E: L > -0.7, 0, [], 3, []),
    "forest": (lambda L, B, E: (L > -0.3) & (B > 0.1) & (E > 22), -2, [], 0, []),
    "urban_street_01": (lambda L, B, E: (L > 0.1) & (E > 8), -2, [], 0, []),
    "venetian_crossroads": (lambda L, B, E: (((B > 0.3) & (L > -2.3)) | (L > -0.2)) & (E > 6), -2, [], 60, []),
    "sunset": (lambda L, B, E: (((B > 0.25) & (L > -1.0)) | (L > -0.3)) & (E > 3), 1.5, [], 4, []),
    "Park2": (lambda L, B, E: (((B > 0.45) & (L > -1.5)) | ((L > -0.45) & (B > 0.12) & (E > 5))) & (E > 3), -2, [], 0, []),
    "VancouverConventionCentre": (None, 0, [
        [(135, 0), (135, 44), (154, 45.5), (154, 0)], [(123, 0), (123, 28), (136, 28), (136, 0)],
        [(184.5, 0), (184.5, 51), (192, 52.5), (200.5, 50), (200.5, 27), (208, 27), (208, 0)],
        [(219, 0), (219, 38.5), (238.5, 38.5), (238.5, 0)]], 30, []),
    "dawn": (None, 2, [], 30, []),
    "park": (None, 0, [], 300, [[(0, 0), (0, 6), (85, 7), (150, 7), (360, 7), (360, 0)]]),
    "sunrise": (None, 3.2, [], 300, [[(0, 0), (0, 5), (100, 7), (180, 7), (250, 5), (260, 18), (345, 18), (350, 5), (360, 5), (360, 0)]]),
    "venice": (None, 0, [], 100, [
        [(0, 0), (0, 14), (35, 15), (40, 19), (110, 19), (112, 17), (152, 17), (155, 7), (180, 6), (360, 4), (360, 0)],
        [(340, 0), (340, 14), (350, 14), (350, 0)]]),
    "Citadella": (None, 0, [], 4, []),
    "HeroesSquare": (None, 0, [], 4, []),
    "IceRiver": (None, 0, [], 4, []),
    "Maskonaive": (None, 0, [], 30, []),
    "Ryfjallet": (None, 0, [], 30, [[(0, 0), (0, 24), (22, 14), (27, 4), (340, 4), (345, 23), (360, 26), (360, 0)]]),
    "Bridge2": (None, 0, [], 4, []),
    "rooftop_night": (None, 0, [], 300, [
        [(0, 0), (0, 10), (35, 14), (140, 9), (200, 9), (205, 20), (220, 20), (235, 10), (238, 15), (262, 15), (300, 22), (340, 20), (360, 10), (360, 0)]]),
    "canary_wharf": (lambda L, B, E: L > 0.1, 0, [], 30, []),
    "portland_landing_pad": (lambda L, B, E: ((L > -0.4) & (B > 0.15)) | ((L > 0.4) & (B > -0.3)), 0, [], 30, [
        [(134, 0), (134, 24), (170, 24), (170, 0)]]),
    "modern_buildings_2": (lambda L, B, E: (((L > -0.65) & (B > 0.5)) | ((L > -0.3) & (B > 0.2))) & (E > 3), 0, [], 3000, [
        [(0, 0), (0, 70), (118, 70), (118, 0)], [(300, 0), (300, 70), (360, 70), (360, 0)]]),
    "future_parking": (lambda L, B, E: (B > 0.4) | ((L > -0.6) & (B > -0.05)), 0, [[(140, 0), (140, 58), (184, 58), (190, 50), (192, 0)]], 3000, []),
    "spree_bank": (lambda L, B, E: ((B > 0.5) & (L > -0.6)) | ((L > 0.2) & (B > -0.2) & (E > 8)), 1, [], 4, []),
    "outdoor_umbrellas": (lambda L, B, E: ((B > 0.3) & (L > -0.5)) | (L > 1.0), 2, [], 0, [
        [(0, 0), (0, 32), (360, 32), (360, 0)], [(0, 60), (0, 90), (360, 90), (360, 60)]]),
    "chinese_garden": (lambda L, B, E: (B > 0.8) | (L > 0), 4, [], 4, []),
    "courtyard": (lambda L, B, E: (L > -0.3) & (B > 0.3), 5, [], 0, []),
    "narrow_moonlit_road": (lambda L, B, E: L > -2.4, 3, [], 4, []),
    "noon_grass": (lambda L, B, E: (L > -2) & (B > 0.3), 1, [], 3000, []),
    "snowy_field": (lambda L, B, E: ((B > 0.45) & (L > -3.6)) | ((L > -1.5) & (E > 6)), 3, [], 0, []),
    "st_peters_square_night": (lambda L, B, E: L < -2.4, 8, [], 30, [
        [(198, 0), (198, 42), (242, 42), (242, 0)], [(135, 0), (135, 22), (185, 22), (185, 0)]]),
    "hilly_terrain_01": (None, 0, [], 30, []),
    "immenstadter_horn": (None, 0, [], 4, []),
    "kloppenheim_05": (None, 0, [], 300, []),
    "quarry_02": (None, 0, [], 300, []),
    "FishermansBastion": (None, 0, [[(96, 10), (96, 34), (98, 36), (100, 34), (100, 10)]], 4, []),
    "night": (lambda L, B, E: E > 30, -2, [], 0, [[(0, 0), (0, 32), (360, 32), (360, 0)]]),
    "shanghai_bund": (lambda L, B, E: E > 30, -2, [], 0, [[(0, 0), (0, 32), (360, 32), (360, 0)]]),
}
INDOORS = {name: [] for name in ("apartment", "autoshop_01", "hall", "lab", "lobby", "warehouse", "workshop", "studio",
                                  "abandoned_games_room_02", "aerodynamics_workshop", "circus_arena", "dancing_hall", "hotel_room",
                                  "pine_attic", "poly_haven_studio", "vestibule", "thatch_chapel", "vintage_measuring_lab",
                                  "sepulchral_chapel_rotunda", "drachenfels_cellar", "Church", "SantaMariaDeiMiracoli")}
INDOORS["esplanade"] = [[(0, 35), (0, 90), (360, 90), (360, 35)]]  # a glass roof
INDOORS["adams_place_bridge"] = [[(0, -30), (0, 30), (360, 30), (360, -30)]]  # walls of glass
INDOORS["small_hangar_01"] = [[(225, -5), (225, 15), (290, 15), (290, -5)]]  # an open gate
INDOORS["peppermint_powerplant"] = [[(150, 0), (150, 70), (245, 70), (245, 0)]]  # a wall of glass
INDOORS["parking_garage"] = [[(0, -5), (0, 25), (360, 25), (360, -5)]]  # open sides


def fill(mask, polygons, value):
    for polygon in polygons:
        points = [(a / 360 * WIDTH, (90 - e) / 180 * HEIGHT) for a, e in polygon]
        cv2.fillPoly(mask, [np.array(points).round().astype(np.int32)], value)


def label(linear, rule, lowest, not_sky, hole):
    large = cv2.resize(linear, (WIDTH, HEIGHT), interpolation=cv2.INTER_CUBIC).clip(0)
    elevation = np.repeat((90 - (np.arange(HEIGHT) + 0.5) / HEIGHT * 180)[:, None], WIDTH, 1)
    if rule:
        x = cv2.GaussianBlur(large + 1e-5, (0, 0), 0.6)
        sky = rule(np.log(x.mean(-1)), np.log(x[..., 0] / x[..., 2]), elevation)
    else:
        sky = grab_cut(shown(large), elevation)
    mask = ((sky & (elevation > lowest)) * 255).astype(np.uint8)
    fill(mask, not_sky, 0)
    # Small, low components are windows or pale walls; small holes are lights and stars.
    count, parts, stats, _ = cv2.connectedComponentsWithStats(mask)
    keep = [False] + [s[4] > 400 or (s[1] + s[3] < HEIGHT * 0.5 and s[4] > 6) for s in stats[1:count]]
    mask = (np.array(keep)[parts] * 255).astype(np.uint8)
    count, parts, stats, _ = cv2.connectedComponentsWithStats(255 - mask)
    for k in range(1, count):
        if stats[k][4] < hole:
            mask[parts == k] = 255
    return mask


def write(file, image, sky, known=None):
    known = np.full(sky.shape, 255, np.uint8) if known is None else known
    np.savez(file, image=np.clip(image, 0, 6e4).astype(np.float16), sky=sky, known=known)


def photographs(sources, data):
    for name in list(OUTDOORS) + list(INDOORS):
        light, measured = read(sources, name)
        linear = light
        if measured:
            linear = linear / np.exp(np.log(linear.mean(-1) + 1e-4).mean()) * 0.3
        size = linear.shape[1::-1]
        known = np.full((HEIGHT, WIDTH), 255, np.uint8)
        if name in INDOORS:
            sky = np.zeros(linear.shape[:2], np.uint8)
            fill(known, INDOORS[name], 0)
        else:
            rule, lowest, not_sky, hole, unknown = OUTDOORS[name]
            fill(known, unknown, 0)
            sky = cv2.resize(label(light, rule, lowest, not_sky, hole), size, interpolation=cv2.INTER_AREA)
        write(f"{data}/panoramas/{name}.npz", linear, sky, cv2.resize(known, size, interpolation=cv2.INTER_NEAREST))


def generated(data, first, last):
    for seed in range(first, last + 1):
        kind = "room" if seed % 6 == 5 else "street"
        image, sky = getattr(scenes, kind)(np.random.default_rng(seed))
        write(f"{data}/panoramas/{kind}_{seed}.npz", image, (sky * 255).astype(np.uint8))


if __name__ == "__main__":
    if sys.argv[1] == "photographs":
        photographs(sys.argv[2], sys.argv[3])
    else:
        generated(sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
