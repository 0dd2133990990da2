#!/usr/bin/env python3
"""Formats and checksums of controller text, by Python.

    python3 validation/golden/controller_reference.py

needs nothing but Python 3.11 or later, takes no arguments, and writes into
crates/jointplay-interop/golden, so that the archive of the crate has them,

    controller-formats.csv     kind of the value, format, value, text
    controller-checksums.csv   checksum, bytes in hexadecimal, value

Formats are those of Python's own `format`; a number with decimals has the type
`f` where the format has none, 6 digits where it has no precision, and the
option `z`, by which zero has no minus sign. CRC-32 and the first two of CRC-16
are those of `zlib` and `binascii`, the others are computed bit by bit.
"""

import binascii
import csv
import functools
import itertools
import operator
import pathlib
import zlib

FOLDER = pathlib.Path(__file__).parents[2] / "crates/jointplay-interop/golden"

ALIGNS = ["", "<", ">", "^", "=", "*<", "0>", "_^", "x="]
SIGNS = ["", "+", "-", " "]
ZEROS = ["", "0"]
WIDTHS = ["", "2", "9"]


def formats():
    # A part of all combinations, so that each pair of parts occurs.
    numbers = list(itertools.product(ALIGNS, SIGNS, ZEROS, WIDTHS))[::5]
    integers = [0, 7, -3, 25, 255, -4096, 10**15]
    for k, (align, sign, zero, width) in enumerate(numbers):
        kind = ["", "d", "x", "X", "o", "b"][k % 6]
        spec = align + sign + zero + width + kind
        yield "integer", spec, integers[k % 7], format(integers[k % 7], spec)
    reals = [0.0, -0.0, 0.5, 1.5, 2.5, -0.0004, 12.3456789, -359.99999951, 1e-7, -6.02214076e23, 0.1]
    for k, (align, sign, zero, width) in enumerate(numbers):
        kind = ["", "f", "e", "E"][k % 4]
        precision = ["", ".0", ".3", ".17"][k // 4 % 4]
        value = reals[k % 11]
        text = format(value, align + sign + "z" + zero + width + precision + (kind or "f"))
        yield "real", align + sign + zero + width + precision + kind, repr(value), text
    for k, (align, width, precision) in enumerate(
        itertools.product(["", "<", ">", "^", "*^"], WIDTHS, ["", ".0", ".3"])
    ):
        value = ["LP1", "a", "Prozess-Kammer", "Höhe"][k % 4]
        spec = align + width + precision + ["", "s"][k % 2]
        yield "text", spec, value, format(value, spec)


def crc(data, polynomial, initial):
    """A reflected CRC-16."""
    value = initial
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value >> 1) ^ polynomial if value & 1 else value >> 1
    return value


CHECKSUMS = {
    "xor": lambda data: functools.reduce(operator.xor, data, 0),
    "sum": lambda data: sum(data) % 256,
    "lrc": lambda data: -sum(data) % 256,
    "crc-16/xmodem": lambda data: binascii.crc_hqx(data, 0),
    "crc-16/ccitt-false": lambda data: binascii.crc_hqx(data, 0xFFFF),
    "crc-16/kermit": lambda data: crc(data, 0x8408, 0),
    "crc-16/modbus": lambda data: crc(data, 0xA001, 0xFFFF),
    "crc-32": zlib.crc32,
}

TEXTS = ["", "123456789", "N3 T0", "GPGGA,123519,4807.038,N", "1GET,P1,S03,A\r\n", "Höhe 3 µm", "\x00\xff" * 40]


def write(name, header, rows):
    with open(FOLDER / name, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


write("controller-formats.csv", ["kind", "format", "value", "text"], formats())
checksums = (
    [name, text.encode().hex(), of(text.encode())] for name, of in CHECKSUMS.items() for text in TEXTS
)
write("controller-checksums.csv", ["checksum", "bytes", "value"], checksums)
