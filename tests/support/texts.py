"""Texts of a picture, as a renderer places them: which cover each other, which stand outside the frame."""

import itertools

import numpy as np

#: Of letters in points: the margin that a renderer puts around them; how far one may stand beyond the frame in pixels.
MARGIN, BEYOND = 0.8, 1.0


def texts_of(figure):
    """Return the texts that are drawn: tick labels outside a range are there, and are not."""
    found = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts())]
    for axes in filter(lambda axes: axes.get_visible(), figure.axes):
        found += [*axes.texts, axes.title, *(axes.get_legend().get_texts() if axes.get_legend() else ())]
        for axis in (axes.xaxis, axes.yaxis) if axes.axison else ():
            found += [axis.label, axis.offsetText]
            found += [label for tick in axis._update_ticks() for label in (tick.label1, tick.label2)]
    return [text for text in found if text.get_visible() and text.get_text().strip()]


def corners_of(text, renderer):
    """Return the corners of the box around a text, along its letters."""
    box, turn = text.get_window_extent(renderer), text.get_rotation()
    text.set_rotation(0.0)
    wide, high = text.get_window_extent(renderer).size
    text.set_rotation(turn)
    margin = MARGIN * text.figure.get_figure(root=True).dpi / 72.0
    half = 0.5 * np.maximum([wide - margin, high - 2.0 * margin], 1.0)
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    around = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]) * half
    return 0.5 * (box.p0 + box.p1) + around @ np.array([[c, s], [-s, c]])


def overlap(one, other):
    """Tell whether two boxes overlap: no side of either has all of one on this and all of the other on that side."""
    for across in (*np.diff(one[:3], axis=0), *np.diff(other[:3], axis=0)):
        first, second = one @ across, other @ across
        if first.max() <= second.min() or second.max() <= first.min():
            return False
    return True


def flaws_of(figure):
    """Return the pairs of texts that overlap, and the texts that are not inside the picture."""
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    boxes = [(text.get_text(), corners_of(text, renderer)) for text in texts_of(figure)]
    size = figure.bbox.size + BEYOND
    outside = [words for words, box in boxes if (box < -BEYOND).any() or (box > size).any()]
    pairs = [
        (one, other)
        for (one, box), (other, further) in itertools.combinations(boxes, 2)
        if overlap(box, further)
    ]
    return pairs, outside
