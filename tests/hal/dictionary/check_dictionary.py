# SPDX-License-Identifier: Apache-2.0
"""Compares the C++ codec with weld-link.dbc, and reads can.log with the tools people have.

check_dictionary.py DBC LINK_VECTORS: needs python3-canmatrix, python3-can and tshark (Debian).
The protection is computed here a second time, from the data ids in the dictionary.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import can
import canmatrix.formats

SCALED_TOLERANCE = 0.51  # of one count: half, and what a double adds


def crc16(data, crc=0xFFFF):
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ (0x1021 if crc & 0x8000 else 0)
            crc &= 0xFFFF
    return crc


def crc8(data, crc=0xFF):
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = ((crc << 1) ^ (0x2F if crc & 0x80 else 0)) & 0xFF
    return crc ^ 0xFF


def protected(frame, data):
    """Whether the end-to-end protection of `data` holds."""
    data_id = int(frame.attributes["E2E_DataID"])
    if frame.is_fd:
        wanted = crc16(data[2:] + bytes([data_id & 0xFF, data_id >> 8]))
        return data[0] | data[1] << 8 == wanted
    return data[0] == crc8(data[1:] + bytes([data_id]))


def check_message(matrix, line):
    """One message of the codec: decoded as it was meant, and encoded to the same bytes."""
    data = bytes.fromhex(line["data"])
    frame = matrix.frame_by_id(canmatrix.ArbitrationId(line["id"]))
    assert frame.size == len(data), f"{frame.name}: length {len(data)}"
    assert protected(frame, data), f"{frame.name}: protection"
    decoded = frame.decode(data)
    named = {s.name for s in frame.signals if not s.name.endswith(("_Crc", "_Cnt"))}
    assert named == set(line["signals"]), f"{frame.name}: {named ^ set(line['signals'])}"
    for name, meant in line["signals"].items():
        signal = frame.signal_by_name(name)
        got = float(decoded[name].phys_value)
        factor = float(signal.factor)
        tolerance = SCALED_TOLERANCE * factor if factor != 1 else 0
        assert abs(got - meant) <= tolerance, f"{name}: {got} for {meant}"
    raw = {name: value.raw_value for name, value in decoded.items()}
    assert bytes(frame.encode(raw)) == data, f"{frame.name}: does not encode back"


def check_codec(matrix, vectors, folder):
    path = folder / "messages.jsonl"
    subprocess.run([vectors, "messages", path], check=True)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    for line in lines:
        check_message(matrix, line)
    seen = {line["id"] for line in lines}
    assert seen == {f.arbitration_id.id for f in matrix.frames}, "a message was not tried"
    return len(lines)


def check_log(matrix, vectors, folder, classic):
    """python-can and tshark read every frame of a weld's log; FD frames decode and are protected."""
    path = folder / ("classic.log" if classic else "fd.log")
    subprocess.run([vectors, "weld", path] + (["classic"] if classic else []), check=True)
    lines = path.read_text().splitlines()
    messages = list(can.CanutilsLogReader(path))
    assert len(messages) == len(lines), "python-can read another number of frames"
    names = set()
    for message in messages:
        frame = matrix.frame_by_id(canmatrix.ArbitrationId(message.arbitration_id))
        assert message.is_fd == (frame.is_fd and not classic)
        names.add(frame.name)
        if message.is_fd or frame.name == "WT_ABORT":
            assert protected(frame, bytes(message.data)), f"{frame.name}: protection"
            frame.decode(bytes(message.data))
    assert names == {f.name for f in matrix.frames} - {"WT_NACK"}, names
    told = subprocess.run(["tshark", "-r", path, "-T", "fields", "-e", "can.id", "-e", "can.len"],
                          check=True, capture_output=True, text=True).stdout.splitlines()
    told = [tuple(int(n) for n in line.split("\t")) for line in told]
    assert told == [(m.arbitration_id, len(m.data)) for m in messages], "tshark read it otherwise"
    return len(lines)


def main():
    dbc, vectors = sys.argv[1:]
    matrix = canmatrix.formats.loadp_flat(dbc)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        print(check_codec(matrix, vectors, folder), "messages agree with the dictionary")
        print(check_log(matrix, vectors, folder, classic=False), "FD frames of a weld read back")
        print(check_log(matrix, vectors, folder, classic=True), "classic frames read back")


if __name__ == "__main__":
    main()
