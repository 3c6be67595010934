"""The worksheets as notebooks, from doc/sheets/sheets.texi.

    python3 sheets.py SHEETS.texi FOLDER

writes FOLDER/sheet-N.ipynb; the commands of a sheet become calls of the package.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import os
import sys

from nevh import _classroom


def main(sheets, folder):
    os.makedirs(folder, exist_ok=True)
    for sheet in _classroom.read_sheets(sheets):
        _classroom.write_notebook(sheet, os.path.join(folder, "sheet-%d.ipynb" % sheet.number))


if __name__ == "__main__":
    main(*sys.argv[1:])
