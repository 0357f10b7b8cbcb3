# SPDX-License-Identifier: Apache-2.0
"""The network of fix/skyline: from planes of a reduced picture to four coefficients per pixel (docs/sky_network.md)."""
import torch
from torch import nn
from torch.nn import functional as F

PLANES = ("Y", "Cb", "Cr", "valid", "sine of the elevation")
TERMS = 4  # log-odds, and its derivatives by the difference of a pixel's Y, Cb, Cr from its surroundings


def conv(inputs, outputs, side=3, stride=1, groups=1):
    return nn.Sequential(nn.Conv2d(inputs, outputs, side, stride, side // 2, groups=groups, bias=False), nn.BatchNorm2d(outputs))


class Separable(nn.Module):
    def __init__(self, inputs, outputs, stride=1):
        super().__init__()
        self.deep, self.flat = conv(inputs, inputs, 3, stride, inputs), conv(inputs, outputs, 1)
        self.same = stride == 1 and inputs == outputs

    def forward(self, x):
        y = self.flat(F.relu(self.deep(x)))
        return F.relu(x + y) if self.same else F.relu(y)


class SkyNet(nn.Module):
    """Encoder to a sixteenth of the grid and decoder, with a skip connection at each level."""

    def __init__(self, widths=(16, 32, 64, 88), fine=8):
        super().__init__()
        a, b, c, d = widths
        self.fine = conv(len(PLANES), fine)
        self.stem = conv(len(PLANES), a, 3, 2)
        self.second = Separable(a, a)
        self.fourth = nn.Sequential(Separable(a, b, 2), Separable(b, b))
        self.eighth = nn.Sequential(Separable(b, c, 2), Separable(c, c), Separable(c, c), Separable(c, c))
        self.deepest = nn.Sequential(Separable(c, d, 2), Separable(d, d), Separable(d, d), Separable(d, d))
        self.up = nn.ModuleList([conv(d, c, 1), conv(c, b, 1), conv(b, a, 1), conv(a, fine, 1)])
        self.join = nn.ModuleList([Separable(c, c), Separable(b, b), Separable(a, a), Separable(fine, fine)])
        self.last = nn.Conv2d(fine, TERMS, 1)

    def forward(self, x):
        fine = F.relu(self.fine(x))
        second = self.second(F.relu(self.stem(x)))
        fourth = self.fourth(second)
        eighth = self.eighth(fourth)
        y = self.deepest(eighth)
        for up, join, side in zip(self.up, self.join, (eighth, fourth, second, fine)):
            y = join(F.relu(F.interpolate(up(y), scale_factor=2, mode="nearest") + side))
        return self.last(y)


def log_odds(coefficients, small, large):
    """Log-odds at the full picture's size; `small` and `large` are Y, Cb, Cr at both sizes."""
    size = large.shape[-2:]
    wide = F.interpolate(coefficients, size, mode="bilinear", align_corners=False)
    detail = large - F.interpolate(small, size, mode="bilinear", align_corners=False)
    return wide[:, :1] + (wide[:, 1:] * detail).sum(1, keepdim=True)
