# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""PNG files and contact sheets with the standard library alone. A picture is (width, height, rows of RGB bytes)."""
import struct, zlib

# Glyphs of 5 x 7 pixels: for each character 5 columns from the left, bit 0 at the top.
_LETTERS = "-./_0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
_COLUMNS = bytes.fromhex(
    "08080808080060600000201008040240404040403e5149453e00427f400042615149462141454b311814127f1027454545393c4a494930"
    "01710905033649494936064949291e7e1111117e7f494949363e414141227f4141221c7f494949417f090909013e4149497a7f0808087f"
    "00417f41002040413f017f081422417f404040407f020c027f7f0408107f3e4141413e7f090909063e4151215e7f091929464649494931"
    "01017f01013f4040403f1f2040201f3f4038403f631408146307087008076151494543"
    "20545454787f484444383844444420384444487f3854545418087e0901020c5252523e7f0804047800447d4000204044"
    "3d007f1028440000417f40007c041804787c0804047838444444387c14141408081414187c7c080404084854545420"
    "043f4440203c4040207c1c2040201c3c4030403c44281028440c5050503c4464544c44")
_GLYPHS = {letter: _COLUMNS[5 * i:5 * i + 5] for i, letter in enumerate(_LETTERS)}
_ADVANCE, _LINE = 6, 11  # pixels from letter to letter, and of a line of text with its margins


def read_png(path):
    """An 8-bit RGB or RGBA PNG; alpha is dropped."""
    data, pos, idat = open(path, "rb").read(), 8, b""
    while pos < len(data):
        size, kind = struct.unpack(">I4s", data[pos:pos + 8])
        if kind == b"IHDR":
            width, height, _, color = struct.unpack(">IIBB", data[pos + 8:pos + 18])
        idat += data[pos + 8:pos + 8 + size] if kind == b"IDAT" else b""
        pos += 12 + size
    raw, n = zlib.decompress(idat), 4 if color == 6 else 3
    rows, previous, stride = [], bytearray(width * n), width * n + 1
    for y in range(height):
        kind, line = raw[y * stride], bytearray(raw[y * stride + 1:(y + 1) * stride])
        for i in range(len(line)):
            a, b, c = line[i - n] if i >= n else 0, previous[i], previous[i - n] if i >= n else 0
            p = a + b - c
            paeth = a if abs(p - a) <= min(abs(p - b), abs(p - c)) else b if abs(p - b) <= abs(p - c) else c
            line[i] = line[i] + (0, a, b, (a + b) // 2, paeth)[kind] & 255
        rows.append(bytes(line) if n == 3 else b"".join(bytes(line[i:i + 3]) for i in range(0, len(line), 4)))
        previous = line
    return width, height, rows


def png_bytes(width, height, rows, level=6):
    """An RGB PNG without row filters; `rows` may be any iterable of rows of bytes."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    packed = zlib.compressobj(level)
    data = b"".join(packed.compress(b"\0" + row) for row in rows) + packed.flush()
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) + chunk(b"IDAT", data) +
            chunk(b"IEND", b""))


def write_png(path, width, height, rows):
    with open(path, "wb") as file:
        file.write(png_bytes(width, height, rows))


def _text_rows(text, width):
    """One line of black text on white; of a text that is too long the end, which tells names apart."""
    text = text[-(width // _ADVANCE):]
    rows = [bytearray(b"\xff" * 3 * width) for _ in range(_LINE)]
    for at, letter in enumerate(text):
        for x, column in enumerate(_GLYPHS.get(letter, b"\x7f\x41\x41\x41\x7f")):
            for y in range(7):
                if column >> y & 1:
                    rows[2 + y][3 * (_ADVANCE * at + x):3 * (_ADVANCE * at + x + 1)] = b"\0\0\0"
    return [bytes(row) for row in rows]


def captioned(picture, text):
    width, height, rows = picture
    return width, height + _LINE, rows + _text_rows(text, width)


def write_sheet(path, pictures, columns):
    """Pictures of one size, in rows, on white."""
    width, height, gap = pictures[0][0], pictures[0][1], 4
    rows = []
    for first in range(0, len(pictures), columns):
        band = pictures[first:first + columns]
        for y in range(height):
            line = b"".join(p[2][y] + b"\xff" * 3 * gap for p in band)
            rows.append(line + b"\xff" * (3 * columns * (width + gap) - len(line)))
        rows += [b"\xff" * (3 * columns * (width + gap))] * gap
    write_png(path, columns * (width + gap), len(rows), rows)
