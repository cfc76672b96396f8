"""Just enough of PNG and OpenEXR to look into what the program writes, and of Radiance HDR to give it something to read."""
import struct
import zlib


def read_png(path):
    """(width, height, rows): 8-bit RGB, a row is a list of (r, g, b)."""
    with open(path, "rb") as f:
        data = f.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0], path
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
            assert (depth, color) == (8, 2), "8-bit RGB expected"
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    raw, stride, rows = zlib.decompress(packed), 3 * width, []
    above = bytes(stride)
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, up, corner = (line[i - 3] if i >= 3 else 0), above[i], (above[i - 3] if i >= 3 else 0)
            line[i] = (line[i] + [0, left, up, (left + up) // 2, paeth(left, up, corner)][kind]) & 255
        rows.append([tuple(line[3 * x:3 * x + 3]) for x in range(width)])
        above = bytes(line)
    return width, height, rows


def paeth(a, b, c):
    p = a + b - c
    return min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]


def read_exr(path):
    """(width, height, channels, attributes): scan lines, zip or none, 32-bit floats; a channel is a list of rows of 4-byte strings."""
    with open(path, "rb") as f:
        data = f.read()
    assert data[:4] == b"\x76\x2f\x31\x01", path
    at, attributes = 8, {}
    while data[at]:
        name, at = c_string(data, at)
        _, at = c_string(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    names, c = [], 0
    while attributes["channels"][c]:
        name, c = c_string(attributes["channels"], c)
        assert struct.unpack_from("<i", attributes["channels"], c)[0] == 2, "32-bit floats expected"
        names.append(name)
        c += 16
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    lines_a_block = {0: 1, 2: 1, 3: 16}[attributes["compression"][0]]
    channels = {name: [None] * height for name in names}
    for block in range((height + lines_a_block - 1) // lines_a_block):
        offset = struct.unpack_from("<Q", data, at + 1 + 8 * block)[0]
        y, size = struct.unpack_from("<2i", data, offset)
        lines = min(lines_a_block, y1 + 1 - y)
        raw_size = lines * width * 4 * len(names)
        raw = data[offset + 8:offset + 8 + size]
        if size < raw_size:
            raw = unpredicted(zlib.decompress(raw))
        for line in range(lines):
            for i, name in enumerate(names):
                begin = (line * len(names) + i) * width * 4
                channels[name][y - y0 + line] = [raw[begin + 4 * x:begin + 4 * x + 4] for x in range(width)]
    return width, height, channels, attributes


def unpredicted(packed):
    values, total = bytearray(len(packed)), 128
    for i, byte in enumerate(packed):
        total = (total + byte - 128) & 255
        values[i] = total
    raw, half = bytearray(len(packed)), (len(packed) + 1) // 2
    raw[0::2], raw[1::2] = values[:half], values[half:]
    return bytes(raw)


def c_string(data, at):
    end = data.index(0, at)
    return data[at:end].decode(), end + 1


def write_hdr(path, rows):
    """Radiance RGBE without compression; a row is a list of four bytes each, fewer than 8 of them."""
    with open(path, "wb") as f:
        f.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (len(rows), len(rows[0])))
        for row in rows:
            for texel in row:
                f.write(bytes(texel))
