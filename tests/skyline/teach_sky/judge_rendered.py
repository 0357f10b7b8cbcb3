# SPDX-License-Identifier: Apache-2.0
"""Correct pixels on grey renderings by the simulator, by city and lens, with the network quantised as in the plugin.

    judge_rendered.py RENDERED NETWORK [--scale 1.0]    RENDERED: as train.py's DATA/rendered, of routes outside the training data
"""
import argparse
import collections

import cv2
import numpy as np
import torch

import export
import train
import views
from network import SkyNet, log_odds

GRID = (160, 128)  # of 640 x 480


def told(grey, fisheye, focal, pitch):
    """Planes of the grid, and Y, Cb, Cr of the picture, as in fix/skyline."""
    ray, angle = views.rays_of_rendered(fisheye, focal)
    up = (views.upright(pitch).T @ np.array([0, 0, 1.0])).astype(np.float32)
    valid = (angle < 1.52).astype(np.float32)
    y = (grey.astype(np.float32) - 128) / 64
    shrink = lambda plane: cv2.resize(plane, GRID, interpolation=cv2.INTER_AREA)
    sees = shrink(valid)
    nothing = np.zeros_like(sees)
    return np.stack([shrink(y), nothing, nothing, sees, shrink(ray @ up) * sees]), np.stack([y, 0 * y, 0 * y]), valid


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("rendered"), parser.add_argument("network")
    parser.add_argument("--scale", type=float, default=1.0)
    a = parser.parse_args()
    torch.set_num_threads(1)
    net = SkyNet()
    net.load_state_dict(torch.load(a.network))
    net = export.as_kept(net.eval(), a.scale)
    scores = collections.defaultdict(lambda: [0, 0, 0])  # pictures, pixels, correct
    for city, grey, label, fisheye, focal, pitch in train.read_rendered(a.rendered):
        planes, large, valid = told(grey, fisheye, focal, pitch)
        planes, large = torch.from_numpy(planes)[None].float(), torch.from_numpy(large)[None].float()
        with torch.no_grad():
            odds = log_odds(net(planes), planes[:, :3], large)[0, 0].numpy()
        for lens in (("upward fisheye" if pitch > 1.5 else "fisheye") if fisheye else "ahead" if pitch < 0.5 else "tilted", "all"):
            score = scores[city, lens]
            score[0] += 1
            score[1] += (valid > 0).sum()
            score[2] += (((odds > 0) == (label > 120)) & (valid > 0)).sum()
    for (city, lens), (pictures, pixels, right) in sorted(scores.items()):
        print("| %s | %s | %d | %.2f %% |" % (city, lens, pictures, 100 * right / pixels))


if __name__ == "__main__":
    main()
