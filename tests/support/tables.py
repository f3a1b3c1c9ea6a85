# SPDX-License-Identifier: Apache-2.0
"""Tables of `stillhand export --csv` and of the emulators, by the names of their columns."""
import csv


def columns(path, *names):
    """Rows of some columns; a title also has the unit: "tick [-]"."""
    with open(path, encoding="utf-8", newline="") as file:
        rows = csv.reader(file)
        titles = [title.split(" [")[0] for title in next(rows)]
        places = [titles.index(name) for name in names]
        return [[row[place] for place in places] for row in rows]
