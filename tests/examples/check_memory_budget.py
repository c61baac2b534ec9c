#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_memory_budget.py PROGRAM DOCUMENT: the table in the document is what the program prints, to
five per cent: a stage may grow a little without the document, but not out of it."""
import subprocess
import sys

TOLERANCE = 0.05


def rows_of(text):
    rows = {}
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|\n ").split("|")]
        if len(cells) == 4 and cells[2].isdigit():
            rows[cells[0], cells[1]] = int(cells[2])
    return rows


def main():
    program, document = sys.argv[1:]
    printed_text = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    printed = rows_of(printed_text)
    with open(document, encoding="utf-8") as file:
        written = rows_of(file.read())
    wrong = [row for row in printed.keys() | written.keys()
             if abs(printed.get(row, 0) - written.get(row, 0)) > TOLERANCE * printed.get(row, 0)]
    for row in wrong:
        print(f"{row}: printed {printed.get(row)}, written {written.get(row)}")
    if wrong or not printed:
        print(f"{document} should hold:\n{printed_text}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
