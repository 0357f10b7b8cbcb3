# SPDX-License-Identifier: Apache-2.0
"""Estimates the scale that calibrates a network's log-odds on held-out views.

    calibrate.py DATA NETWORK
"""
import sys

import numpy as np
import torch

import export
import train_sky
import views
from network import SkyNet, log_odds

VIEWS = 8  # of each held-out sphere


def predictions(net, source):
    """Log-odds and truth of pixels of held-out views other than those of the validation in training."""
    rng = np.random.default_rng(77)
    odds, truth = [], []
    with torch.no_grad():
        for panorama in source.held:
            for _ in range(VIEWS):
                planes, large, sky, weight = views.view(rng, panorama, source.skies, (160, 128))
                planes, large = torch.from_numpy(planes)[None].float(), torch.from_numpy(large)[None].float()
                got = log_odds(net(planes), planes[:, :3], large)[0, 0].numpy()
                counts = (weight > 0.5) & (np.abs(sky - 0.5) > 0.3)
                chosen = np.flatnonzero(counts.ravel())[::7]
                odds.append(got.ravel()[chosen]), truth.append(sky.ravel()[chosen] > 0.5)
    return np.concatenate(odds), np.concatenate(truth)


def loss(odds, truth):
    return np.logaddexp(0, np.where(truth, -odds, odds)).mean()


def main():
    source = train_sky.Source(sys.argv[1], np.random.default_rng(0))
    net = SkyNet()
    net.load_state_dict(torch.load(sys.argv[2]))
    odds, truth = predictions(export.as_kept(net.eval(), 1.0), source)
    scales = np.linspace(0.3, 1.5, 61)
    scale = scales[np.argmin([loss(s * odds, truth) for s in scales])]
    print("scale %.2f, loss %.4f (%.4f before), right %.2f %%" % (scale, loss(scale * odds, truth), loss(odds, truth), 100 * ((odds > 0) == truth).mean()))


if __name__ == "__main__":
    main()
