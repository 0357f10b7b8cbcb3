# SPDX-License-Identifier: Apache-2.0
"""Writes the plugin's weights: one byte per weight, one factor and one bias per output.

    export.py NETWORK FOLDER [--scale 1.0]      FOLDER: plugins/fix/skyline; --scale: of the log-odds, by calibrate.py
"""
import argparse

import torch
from torch import nn

from network import SkyNet


def layers(net):
    """Convolution and batch normalisation of each layer, in the plugin's order."""
    def separable(block):
        yield from (block.deep, block.flat)

    yield from (net.fine, net.stem)
    yield from separable(net.second)
    for blocks in (net.fourth, net.eighth, net.deepest):
        for block in blocks:
            yield from separable(block)
    for up, join in zip(net.up, net.join):
        yield up
        yield from separable(join)
    yield net.last


def folded(layer, scale=1.0):
    if isinstance(layer, nn.Conv2d):
        return layer.weight.detach() * scale, layer.bias.detach() * scale
    convolution, norm = layer
    factor = norm.weight / torch.sqrt(norm.running_var + norm.eps)
    return (convolution.weight * factor[:, None, None, None]).detach(), (norm.bias - norm.running_mean * factor).detach()


def quantised(net, scale):
    """(bytes, factor, bias) of each output of each layer."""
    out = []
    for layer in layers(net):
        weight, bias = folded(layer, scale if layer is net.last else 1.0)
        for w, b in zip(weight.flatten(1), bias):
            factor = max(w.abs().max().item() / 127, 1e-12)
            out.append(([int(round(v)) for v in (w / factor).tolist()], factor, b.item()))
    return out


def as_kept(net, scale):
    """The network with the plugin's quantised weights, for evaluation of the quantisation."""
    copy = SkyNet()
    copy.load_state_dict(net.state_dict())
    rows = iter(quantised(net, scale))
    with torch.no_grad():
        for layer in layers(copy):
            convolution = layer if isinstance(layer, nn.Conv2d) else layer[0]
            kept = [next(rows) for _ in range(convolution.out_channels)]
            weight = torch.tensor([[b * f for b in w] for w, f, _ in kept]).reshape(convolution.weight.shape)
            convolution.weight.copy_(weight)
            bias = torch.tensor([b for _, _, b in kept])
            if layer is copy.last:
                convolution.bias.copy_(bias)
            else:
                norm = layer[1]
                norm.weight.fill_(1), norm.running_mean.fill_(0), norm.running_var.fill_(1 - norm.eps), norm.bias.copy_(bias)
    return copy.eval()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("network"), parser.add_argument("folder")
    parser.add_argument("--scale", type=float, default=1.0)
    a = parser.parse_args()
    net = SkyNet()
    net.load_state_dict(torch.load(a.network))
    net.eval()
    rows = quantised(net, a.scale)
    licence = "// SPDX-License-" "Identifier: Apache-2.0\n// By plugins/fix/skyline/training/export.py: docs/sky_network.md.\n"
    numbers = [n for w, _, _ in rows for n in w]
    with open(a.folder + "/sky_network_weights.inc", "w") as f:
        f.write(licence)
        for k in range(0, len(numbers), 240):
            f.write(",".join(map(str, numbers[k:k + 240])) + ",\n")
    with open(a.folder + "/sky_network_outputs.inc", "w") as f:
        f.write(licence)
        for k in range(0, len(rows), 8):
            f.write("".join("{%.7eF,%.7eF}," % (factor, bias) for _, factor, bias in rows[k:k + 8]) + "\n")
    print(len(numbers), "weights,", len(rows), "outputs")


if __name__ == "__main__":
    main()
