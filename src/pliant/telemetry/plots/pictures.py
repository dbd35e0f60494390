"""Pictures side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pliant.spatial import Array
from pliant.telemetry.plots import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def picture_row(pictures: Sequence[Array], titles: Sequence[str], heading: str, width: float, height: float) -> Figure:
    """Pictures (h, w, 3) in a row, each with a title. Args: width, height: inches of one of them."""
    made = style.figure(width * len(pictures), height, heading)
    axes = made.subplots(1, len(pictures), squeeze=False)[0]
    for ax, picture, title in zip(axes, pictures, titles, strict=True):
        ax.imshow(picture.astype(np.uint8))
        ax.set_axis_off()
        ax.set_title(title, fontsize=style.NORMAL, color=style.INK)
    return made
