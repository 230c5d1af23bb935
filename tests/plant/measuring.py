"""An arm's lengths as somebody with a caliper would write them down."""

import numpy as np

from spirob.unit_table import COLUMNS


def rows_of(arm):
    """Rows of the table, in millimetres, in the order of its columns; unit 0 is the mount."""
    slant = np.tan(arm.unit_angle / 2)
    far = arm.guide_before[1:] + np.column_stack([arm.unit_length[:-1], np.zeros(arm.units - 1)])
    slope = (far[-1] - arm.guide_after[-2])[1] / (far[-1] - arm.guide_after[-2])[0]
    x = arm.unit_length[-1] - arm.guide_after[-1, 0]  # the last one's lies as far from its end
    last = [x, arm.guide_after[-1, 1] + slope * (x - arm.guide_after[-1, 0])]
    sizes = [arm.unit_length, 2 * arm.half_width, arm.unit_length - 2 * slant * arm.half_width]
    cells = 1e3 * np.column_stack([*sizes, arm.guide_after, np.vstack([far, last])])
    mount = [0, None, None, None, None, None, *(1e3 * arm.guide_before[0]).tolist()]
    return [mount, *([k, *row] for k, row in enumerate(cells.tolist(), start=1))]


def written(rows, columns=COLUMNS):
    """The table's text."""
    lines = [",".join("" if cell is None else str(cell) for cell in row) for row in rows]
    return "\n".join([",".join(columns), *lines]) + "\n"
