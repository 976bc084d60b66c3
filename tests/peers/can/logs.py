"""python-can reads a candump log and writes it again: python logs.py IN OUT"""

import sys

import can

with can.CanutilsLogReader(sys.argv[1]) as reader, can.CanutilsLogWriter(sys.argv[2]) as writer:
    for message in reader:
        writer.on_message_received(message)
        kind = "error" if message.is_error_frame else "remote" if message.is_remote_frame else "data"
        wide = "extended" if message.is_extended_id else "standard"
        data = bytes(message.data).hex()
        time = f"{message.timestamp:.6f}"
        print(time, message.channel, kind, wide, f"{message.arbitration_id:x}", message.dlc, data)
