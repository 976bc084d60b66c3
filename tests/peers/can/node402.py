"""A CiA 402 node made of Python's canopen: python node402.py SERIAL_PORT [NODE_ID]

The other end of the port is an slcan adapter with a master behind it. SDO, NMT, heartbeat and PDOs are
canopen's LocalNode; states follow State402's transition table and statusword masks. Torque that comes
after SYNC k acts, and is reported, at SYNC k + 1. Runs until standard input is closed, then prints the
states that were gone through and the largest torque, per mille.
"""

import pathlib
import struct
import sys

import canopen
from canopen.profiles.p402 import State402

EDS = str(pathlib.Path(__file__).with_name("drive.eds"))
INVALID = 1 << 31


class Drive:
    def __init__(self, network, number):
        self.node = network.create_node(number, EDS)
        self.network = network
        self.state = "SWITCH ON DISABLED"
        self.history = [self.state]
        self.position = 0
        self.largest = 0
        self.waiting = {}
        self.defaults(number)
        network.subscribe(0x080, self.on_sync)
        network.subscribe(0, self.on_nmt)
        self.node.nmt.send_command(0)
        self.node.nmt.state = "PRE-OPERATIONAL"

    def defaults(self, number):
        values = {0x1000: 0x00020192, 0x1008: "canopen node", 0x6502: 1 << 9, 0x6060: 0, 0x6061: 0}
        for index in (0x6040, 0x6064, 0x606C, 0x6071, 0x6077, 0x603F, 0x1001, 0x607E, 0x6087, 0x1006):
            values[index] = 0
        values |= {0x6072: 1000, 0x6076: 1000, 0x1005: 0x80, 0x1014: 0x80 + number, 0x1017: 0}
        for index in (0x605A, 0x605B, 0x605C, 0x605D, 0x605E, 0x6007):
            values[index] = 0
        for index, value in values.items():
            self.node.sdo[index].raw = value
        for sub, value in enumerate((0, 0x53420001, 0x00010000, number), 1):
            self.node.sdo[0x1018][sub].raw = value
        for sub in range(1, 5):
            self.node.sdo[0x1016][sub].raw = 0
        self.node.sdo[0x60C2][1].raw, self.node.sdo[0x60C2][2].raw = 1, -3
        for pdo in range(4):
            for base, first in ((0x1400, 0x200), (0x1800, 0x180)):
                parameters = self.node.sdo[base + pdo]
                parameters[1].raw = INVALID | (first + 0x100 * pdo + number)
                parameters[2].raw, parameters[3].raw, parameters[5].raw = 255, 0, 0
                mapping = self.node.sdo[base + 0x200 + pdo]
                mapping[0].raw = 0
                for sub in range(1, 9):
                    mapping[sub].raw = 0
        self.publish()

    def publish(self):
        mask, bits = State402.SW_MASK[self.state]
        self.node.sdo[0x6041].raw = bits | 0x0210
        self.node.sdo[0x6061].raw = self.node.sdo[0x6060].raw

    def on_nmt(self, _id, data, _time):
        if data[0] == 1 and data[1] in (0, self.node.id):
            self.node.rpdo.read()
            self.node.tpdo.read()
            for pdo in self.node.rpdo.values():
                if pdo.enabled:
                    self.network.subscribe(pdo.cob_id, self.on_rpdo)

    def on_rpdo(self, cob_id, data, _time):
        self.waiting[cob_id] = bytes(data)

    def on_sync(self, _id, _data, _time):
        if self.node.nmt.state != "OPERATIONAL":
            return
        for pdo in self.node.tpdo.values():
            if pdo.enabled:
                for variable in pdo:
                    if variable.index >= 0x20:
                        variable.data = self.node.get_data(variable.index, variable.subindex)
                pdo.transmit()
        for pdo in self.node.rpdo.values():
            data = self.waiting.pop(pdo.cob_id, None) if pdo.enabled else None
            if data is not None and len(data) == len(pdo.data):
                pdo.data[:] = data
                for variable in pdo:
                    if variable.index >= 0x20:
                        self.node.set_data(variable.index, variable.subindex, variable.data)
        self.step()

    def step(self):
        command = self.node.sdo[0x6040].raw
        for (start, end), value in State402.TRANSITIONTABLE.items():
            if start == self.state and value == command and end != start:
                self.state = end
                self.history.append(end)
                break
        enabled = self.state == "OPERATION ENABLED" and self.node.sdo[0x6060].raw == 10
        torque = self.node.sdo[0x6071].raw if enabled else 0
        most = self.node.sdo[0x6072].raw
        torque = max(-most, min(most, torque))
        self.largest = max(self.largest, abs(torque))
        self.node.sdo[0x6077].raw = torque
        self.position += torque // 10
        self.node.set_data(0x6064, 0, struct.pack("<i", self.position))
        self.publish()


def main(port, number):
    network = canopen.Network()
    network.connect(interface="slcan", channel=port, bitrate=1000000, sleep_after_open=0.05)
    drive = Drive(network, number)
    print("ready", flush=True)
    sys.stdin.read()
    network.disconnect()
    print("states:", ", ".join(drive.history))
    print("torque:", drive.largest, flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1)
