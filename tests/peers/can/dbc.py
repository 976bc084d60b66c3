"""cantools decodes a candump log with a DBC file: python dbc.py DBC LOG

Prints one line for each frame that the file describes: identifier, message, and its numbers in the order
of their names.
"""

import sys

import can
import cantools

database = cantools.database.load_file(sys.argv[1])
with can.CanutilsLogReader(sys.argv[2]) as reader:
    for frame in reader:
        try:
            message = database.get_message_by_frame_id(frame.arbitration_id)
        except KeyError:
            continue
        numbers = message.decode(bytes(frame.data), decode_choices=False)
        text = " ".join(f"{name}={numbers[name]:.17g}" for name in sorted(numbers))
        print(f"{frame.arbitration_id:03x} {message.name} {text}")
