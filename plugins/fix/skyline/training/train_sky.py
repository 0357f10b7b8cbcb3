# SPDX-License-Identifier: Apache-2.0
"""Trains the network of fix/skyline. Data, settings and results: docs/sky_network.md.

    train_sky.py DATA OUT --steps 4000      DATA: panoramas by panoramas.py, renderings in DATA/rendered
"""
import argparse
import glob
import copy
import os
import pickle
import time

import cv2
import numpy as np
import torch
from torch.nn import functional as F

import views
from network import SkyNet, log_odds

HELD_BACK = ("venetian_crossroads", "park", "lobby", "IceRiver", "spree_bank", "aerodynamics_workshop")  # and every tenth generated scene: validation data
SIZES = (((96, 64), 0.55), ((64, 96), 0.15), ((80, 80), 0.2), ((160, 128), 0.1))


def read_panoramas(folder):
    """Reads the cache where there is one, since reading and encoding are slow."""
    cache = folder.rstrip("/") + ".cache"
    if not os.path.exists(cache):
        with open(cache, "wb") as f:
            pickle.dump(encode_panoramas(folder), f, 4)
    with open(cache, "rb") as f:
        return pickle.load(f)


def encode_panoramas(folder):
    photographs, generated, skies, held = {True: [], False: []}, {True: [], False: []}, [], []
    for file in sorted(glob.glob(f"{folder}/*.npz")):
        data = np.load(file)
        name = os.path.basename(file)[:-4]
        indoors = not (data["sky"] > 128).any()
        panorama = views.Panorama(data["image"].astype(np.float32), data["sky"], data["known"] if "known" in data else None, indoors, name)
        made = name.startswith(("street_", "room_"))
        alone = panorama.sky_alone()
        if name in HELD_BACK or (made and name.endswith("9")):
            held.append(panorama)
            continue
        if alone is not None:
            skies.append(alone)
        (generated if made else photographs)[indoors].append(panorama)
    return photographs, generated, skies, held


def read_rendered(folder):
    out = []
    for recording in sorted(glob.glob(f"{folder}/*_L")):
        tag = os.path.basename(recording)[:-2]
        city, kind, seed = tag.rsplit("_", 2)
        seed = int(seed)
        fisheye, focal, pitch = {"wide": (True, 200, np.pi / 2), "fwd": (False, 520, seed % 5 / 10 if city == "delft" else 0.2), "tilt": (False, 400, 0.7),
                                 "kbt": (True, 240, seed * 3 % 10 / 10)}[kind]
        for file in sorted(glob.glob(f"{recording}/mav0/cam0/data/*.png")):
            grey = cv2.imread(file.replace(tag + "_L", tag), cv2.IMREAD_GRAYSCALE)
            if grey is None:
                continue
            out.append((city, grey, cv2.imread(file, cv2.IMREAD_GRAYSCALE), fisheye, focal, pitch))
    return out


class Source:
    def __init__(self, data, rng):
        self.rng = rng
        self.photographs, self.generated, self.skies, self.held = read_panoramas(data + "/panoramas")
        self.rendered = read_rendered(data + "/rendered")
        straight_up = lambda r: r[3] and r[5] > 1.5
        self.delft = {up: [r for r in self.rendered if r[0] == "delft" and straight_up(r) == up] for up in (False, True)}

    def sample(self, size):
        rng, kind = self.rng, self.rng.random()
        if kind > 0.8 and self.delft[True]:
            rows = self.delft[bool(kind > 0.9)]
            return views.rendered(rng, *rows[rng.integers(len(rows))][1:], size)
        if kind < 0.16:
            group = (self.photographs if rng.random() < 0.7 else self.generated)[True]
        else:
            group = (self.photographs if rng.random() < 0.7 else self.generated)[False]
        return views.view(rng, group[rng.integers(len(group))], self.skies, size)


class Buffer:
    """Samples of one size, each used a few times."""

    def __init__(self, size, source, capacity):
        self.size, self.source, self.items, self.capacity = size, source, [], capacity

    def batch(self, count, fresh):
        rng = self.source.rng
        for _ in range(fresh if len(self.items) >= 3 * count else count):
            item = [a.astype(np.float16) for a in self.source.sample(self.size)]
            if len(self.items) < self.capacity:
                self.items.append(item)
            else:
                self.items[rng.integers(self.capacity)] = item
        chosen = [self.items[i] for i in rng.integers(0, len(self.items), count)]
        flip = rng.random(count) < 0.5
        parts = (np.stack([c[k][..., ::-1] if f else c[k] for c, f in zip(chosen, flip)]) for k in range(4))
        return [torch.from_numpy(part.astype(np.float32)) for part in parts]


def loss_of(net, batch, fine):
    planes, large, sky, weight = batch
    terms = net(planes)
    small_sky = F.interpolate(sky[:, None], planes.shape[-2:], mode="area")
    small_weight = F.interpolate(weight[:, None], planes.shape[-2:], mode="area")
    mean = lambda logits, target, w: (F.binary_cross_entropy_with_logits(logits, target, reduction="none") * w).sum() / (w.sum() + 1)
    loss = mean(terms[:, 0], small_sky[:, 0], small_weight[:, 0])
    if not fine:
        return loss
    return loss + 2 * mean(log_odds(terms, planes[:, :3], large)[:, 0], sky, weight)


def validation(source):
    rng = np.random.default_rng(7)
    sets = {}
    for panorama in source.held:
        kind = "generated" if panorama.name.startswith(("street_", "room_")) else panorama.name
        sets.setdefault(kind, []).extend(views.view(rng, panorama, source.skies, (160, 128)) for _ in range(5 if kind != "generated" else 2))
    return sets


def judge(net, sets):
    net.eval()
    out = {}
    with torch.no_grad():
        for name, items in sets.items():
            right = [0, 0, 0.0]
            for planes, large, sky, weight in items:
                planes, large = torch.from_numpy(planes)[None].float(), torch.from_numpy(large)[None].float()
                odds = log_odds(net(planes), planes[:, :3], large)[0, 0].numpy()
                w = weight * (np.abs(sky - 0.5) > 0.3)
                right[0] += (((odds > 0) == (sky > 0.5)) * w).sum()
                right[1] += w.sum()
            out[name] = round(100 * right[0] / max(right[1], 1), 2)
    net.train()
    return out


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("data"), parser.add_argument("out")
    parser.add_argument("--steps", type=int, default=4000)
    parser.add_argument("--rate", type=float, default=4e-3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--start")
    a = parser.parse_args()
    torch.set_num_threads(1), cv2.setNumThreads(1)
    torch.manual_seed(a.seed)
    source = Source(a.data, np.random.default_rng(a.seed))
    net = SkyNet().to(memory_format=torch.channels_last)
    if a.start:
        net.load_state_dict(torch.load(a.start))
    mean_net = copy.deepcopy(net)  # exponential mean over 200 steps: evaluated and saved
    optimiser = torch.optim.AdamW(net.parameters(), a.rate, weight_decay=1e-3)
    buffers = [Buffer(size, source, 1500 if size[0] < 160 else 300) for size, _ in SIZES]
    sets = validation(source)
    print({k: len(v) for k, v in sets.items()}, len(source.skies), len(source.rendered), flush=True)
    begin, mean_loss = time.time(), 0.7
    for step in range(a.steps):
        done = step / a.steps
        for group in optimiser.param_groups:
            group["lr"] = a.rate * min(1, (step + 1) / 40) * min(1, 3 * (1 - done)) + 1e-5
        which = source.rng.choice(len(SIZES), p=[p for _, p in SIZES])
        batch = buffers[which].batch(10 if which < 3 else 5, 3 if which < 3 else 1)
        batch[0] = batch[0].contiguous(memory_format=torch.channels_last)
        loss = loss_of(net, batch, step % 3 == 0)
        optimiser.zero_grad(), loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 2.0)
        optimiser.step()
        keep = min(0.995, (step + 1) / (step + 20))
        with torch.no_grad():
            for slow, now in zip(mean_net.state_dict().values(), net.state_dict().values()):
                slow.lerp_(now, 1 - keep) if slow.is_floating_point() else slow.copy_(now)
        mean_loss += 0.02 * (loss.item() - mean_loss)
        if step % 50 == 49:
            print(step + 1, round(mean_loss, 4), round(time.time() - begin), flush=True)
        if step % 300 == 299 or step + 1 == a.steps:
            torch.save(mean_net.state_dict(), a.out)
            print(judge(mean_net, sets), flush=True)


if __name__ == "__main__":
    main()
